#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A headset for a browser without one: the npm package iwer, which emulates WebXR.

As a program it fetches the package into a folder, the first argument.
"""
import hashlib
import io
from pathlib import Path
import sys
import tarfile
import urllib.request

VERSION = '2.5.0'
URL = 'https://registry.npmjs.org/iwer/-/iwer-{}.tgz'.format(VERSION)
SHA256 = 'e7eb4efa736c0b52c6917a6ed093f3a287fd7eb59a6d371f6ce857d602f59263'
SCRIPT = 'package/build/iwer.min.js'
TIMEOUT_S = 60.0


def iwer_script(folder):
    """Return the text of the script; fetch it into a folder if it is not there.

    :raises OSError: it cannot be fetched, or is not what it was
    """
    path = Path(folder) / 'iwer-{}.js'.format(VERSION)
    if not path.exists():
        with urllib.request.urlopen(URL, timeout=TIMEOUT_S) as answer:
            data = answer.read()
        found = hashlib.sha256(data).hexdigest()
        if found != SHA256:
            raise OSError('{} has the SHA-256 {}'.format(URL, found))
        with tarfile.open(fileobj=io.BytesIO(data)) as package:
            script = package.extractfile(SCRIPT).read()
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix('.part')
        part.write_bytes(script)
        part.rename(path)
    return path.read_text(encoding='utf-8')


if __name__ == '__main__':
    iwer_script(sys.argv[1])
