# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keys for links of tests and benchmarks."""
import os
import pathlib
import shutil
import subprocess

REPO = pathlib.Path(__file__).resolve().parents[2]
LISTS = ('peers', 'withdrawn', 'withdrawn.pem', 'authority.pem')


class Authority:
    """Keys, made by the script as in the guide.

    :param folder: where, a ``pathlib.Path``
    """

    def __init__(self, folder):
        self.folder = folder
        self.run('new')

    def run(self, *words):
        """Run the script with a command."""
        subprocess.run([str(REPO / 'utils/host/mhri_keys.sh'), *words, '--folder',
                        str(self.folder / 'authority')], check=True, stdout=subprocess.DEVNULL,
                       env=dict(os.environ, HOME=str(self.folder)))

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
