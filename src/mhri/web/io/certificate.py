# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The server's own certificate, made with openssl, and its other files."""
import ipaddress
import json
import os
import ssl
import subprocess

from mhri.base.io.files import text_in, whole

# Some phones accept no longer validity.
DAYS, RENEW_S = 825, 7 * 86400
_TIMEOUT_S = 20.0
_MOST = 1 << 20


class CertificateError(RuntimeError):
    """There is no certificate; the text says why."""


def _openssl(*words):
    """Run openssl; return its output.

    :raises CertificateError: it failed
    """
    try:
        return subprocess.run(['openssl', *words], stdin=subprocess.DEVNULL, check=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=_TIMEOUT_S).stdout.decode()
    except subprocess.CalledProcessError as error:
        raise CertificateError('openssl: {}'.format(error.stderr.decode()[-300:])) from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CertificateError('openssl: {}'.format(error)) from None


def _is_of(certificate, names):
    """Return whether a certificate is valid for a while and names these hosts."""
    try:
        _openssl('x509', '-noout', '-checkend', str(RENEW_S), '-in', certificate)
        said = _openssl('x509', '-noout', '-text', '-in', certificate)
    except CertificateError:
        return False
    return set(names) <= {part.strip() for line in said.splitlines() for part in line.split(',')}


def _is_address(name):
    try:
        return bool(ipaddress.ip_address(name))
    except ValueError:
        return False


def server_context(folder, hosts):
    """Return the ``ssl.SSLContext`` of the server; make key and certificate if need be.

    :param folder: where they are kept: ``key.pem`` (mode 0600) and ``certificate.pem``
    :param hosts: names and addresses of this computer; a certificate without one is made anew
    :raises CertificateError: it cannot be made or used
    """
    key, certificate = (os.path.join(folder, name) for name in ('key.pem', 'certificate.pem'))
    names = [('IP Address:' if _is_address(host) else 'DNS:') + host for host in hosts]
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        if not (os.path.isfile(key) and _is_of(certificate, names)):
            os.makedirs(folder, mode=0o700, exist_ok=True)
            with whole(key) as new_key, whole(certificate) as new_certificate:
                os.close(os.open(new_key, os.O_CREAT | os.O_WRONLY, 0o600))
                _openssl('req', '-x509', '-newkey', 'ec', '-pkeyopt',
                         'ec_paramgen_curve:prime256v1', '-nodes', '-days', str(DAYS), '-subj',
                         '/CN=mhri', '-addext', 'subjectAltName=' + ','.join(
                             name.replace('IP Address:', 'IP:') for name in names),
                         '-keyout', new_key, '-out', new_certificate)
        os.chmod(key, 0o600)
        context.load_cert_chain(certificate, key)
    except OSError as error:  # of ssl, too
        raise CertificateError('{}: {}'.format(folder, error)) from None
    return context


def read_rows(path):
    """Return the rows of a file of links, [] if there is none or it cannot be read."""
    try:
        rows = json.loads(text_in(path, _MOST) or '[]')
    except (OSError, ValueError):
        return []
    return rows if isinstance(rows, list) else []


def keep_rows(path, rows):
    """Write a file of links, which only its owner can read.

    :raises OSError: it cannot be written
    """
    with whole(path) as part:
        with open(os.open(part, os.O_CREAT | os.O_WRONLY | os.O_TRUNC, 0o600), 'w') as stream:
            json.dump(rows, stream)


def page_files(folder, endings):
    """Return {name: bytes} of the files of the page."""
    found = {}
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name):
        if entry.is_file() and entry.name.rpartition('.')[2] in endings:
            with open(entry.path, 'rb') as stream:
                found[entry.name] = stream.read()
    return found
