# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keys for links of tests and benchmarks."""
import os
import pathlib
import shutil
import ssl
import subprocess

REPO = pathlib.Path(__file__).resolve().parents[2]
DATE = '#!/bin/bash\nexec /bin/date "${{@/#now/now {:+d} seconds}}"\n'
LISTS = ('peers', 'withdrawn', 'withdrawn.pem', 'authority.pem')


class Authority:
    """Keys, made by the script as in the guide.

    :param folder: where, a ``pathlib.Path``
    """

    def __init__(self, folder):
        self.folder = folder
        self.run('new')

    def run(self, *words, shift_s=0):
        """Run the script with a command.

        :param shift_s: what the script takes for the time is so much later than it is
        """
        tools = self.folder / 'tools'
        tools.mkdir(parents=True, exist_ok=True)
        (tools / 'date').write_text(DATE.format(shift_s))
        (tools / 'date').chmod(0o755)
        subprocess.run([str(REPO / 'utils/host/mhri_keys.sh'), *words, '--folder',
                        str(self.folder / 'authority')], check=True, stdout=subprocess.DEVNULL,
                       env=dict(os.environ, HOME=str(self.folder), PATH='{}:{}'.format(
                           tools, os.environ['PATH'])))

    def end_s(self, name):
        """Return when somebody's certificate runs out [s since 1970]."""
        said = subprocess.run(
            ['openssl', 'x509', '-noout', '-enddate', '-in',
             str(self.folder / 'authority' / 'keys' / name / 'own.pem')],
            check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
        return ssl.cert_time_to_seconds(said.strip().partition('=')[2])

    def put(self, name):
        """Return a folder with the key of somebody, and the lists as they are now."""
        place, made = self.folder / 'at' / name, self.folder / 'authority'
        place.mkdir(parents=True, exist_ok=True)
        files = [made / file for file in LISTS]
        if (made / 'keys' / name).exists():
            files += [made / 'keys' / name / 'own.key', made / 'keys' / name / 'own.pem']
        for file in files:
            shutil.copy(str(file), str(place / '.new'))
            (place / '.new').rename(place / file.name)
        return place
