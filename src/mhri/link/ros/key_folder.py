# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder with the keys of this computer, as ``utils/host/mhri_keys.sh put`` fills it."""
import os
import subprocess
import threading
import time

import rospy

from mhri.link.keys import (
    access, access_of_router, check_own, EARLY, EXPIRED, KeysError, MISSING, read_lists, routers,
    WRONG)
from mhri.link.ros.carrier import CarrierError

OFF, AUTO = 'off', 'auto'
FILES = ('own.key', 'own.pem', 'authority.pem', 'peers', 'withdrawn', 'withdrawn.pem')
# Folders into which the script installs them on a host, and on a robot.
PLACES = ('~/.config/mhri/keys', '~/mhri/keys')
_MAX_BYTES = 1 << 20
# Period of checking the files [s].
_LOOK_S = 1.0
# Margin after which TLS has closed the connection of an expired certificate [s].
_SURE_S = 1.0
# Number of file descriptors for openssl, its pipes, and the files.
_RESERVED = 24
_TLS = 'transport/link/tls/'


def find_folder(text):
    """Return the folder of an option ``--keys``, None for a link without keys."""
    if text == AUTO:
        config = os.environ.get('XDG_CONFIG_HOME')
        places = PLACES + ((os.path.join(config, 'mhri', 'keys'),) if config else ())
        return next((path for path in map(os.path.expanduser, places)
                     if os.path.exists(os.path.join(path, 'own.pem'))), None)
    return None if text == OFF else os.path.abspath(os.path.expanduser(text))


class KeyFolder:
    """Reads the keys of one end of a robot's link, and detects changes.

    :param side: ``robot``, ``host`` or ``router``
    :param routed: whether it connects to a router
    """

    def __init__(self, folder, side, robot, routed=False):
        self.folder, self._side, self._robot, self._routed = folder, side, robot, routed
        self._seen = None
        self.keys = None

    def changed(self):
        """Return whether the files have changed since they were read."""
        return self._look() != self._seen

    def read(self):
        """Return zenoh's settings for the keys, and update :attr:`keys`.

        :raises KeysError: the keys are unusable; :attr:`keys` is unchanged
        """
        seen = self._look()
        missing = [name for name, found in zip(FILES, seen) if found is None]
        if missing:
            raise KeysError('there is no {} in {}: put a key in place with mhri_keys.sh put'.format(
                missing[0], self.folder), MISSING)
        if os.stat(self._path('own.key')).st_mode & 0o077:
            raise KeysError('others may read {}: make a new key (mhri_keys.sh renew), and withdraw '
                            'this one if somebody did'.format(self._path('own.key')))
        self._openssl('verify', '-CAfile', self._path('authority.pem'), '-CRLfile',
                      self._path('withdrawn.pem'), '-crl_check', self._path('own.pem'))
        signed = self._openssl('crl', '-in', self._path('withdrawn.pem'), '-noout', '-text')
        subject = self._openssl('x509', '-in', self._path('own.pem'), '-noout', '-subject',
                                '-nameopt', 'multiline')
        own = next((line.partition('=')[2].strip() for line in subject.splitlines()
                    if line.strip().startswith('commonName')), '')
        keys = read_lists(own, self._text('peers'), self._text('withdrawn'), signed)
        check_own(keys, self._side, self._robot)
        if self._routed and not routers(keys):
            raise KeysError('no router has a key: make one with "mhri_keys.sh router NAME", and '
                            'put all keys in place again')
        self.keys, self._seen = keys, seen
        return self._settings(keys)

    def _settings(self, keys):
        key, certificate = self._path('own.key'), self._path('own.pem')
        return {
            _TLS + 'root_ca_certificate': self._path('authority.pem'), _TLS + 'enable_mtls': True,
            _TLS + 'listen_private_key': key, _TLS + 'listen_certificate': certificate,
            _TLS + 'connect_private_key': key, _TLS + 'connect_certificate': certificate,
            # access_control checks the name, which identifies the robot, not its address; a
            # certificate of a public authority does not help.
            _TLS + 'verify_name_on_connect': False, _TLS + 'close_link_on_expiration': True,
            'access_control': access_of_router(keys) if self._side == 'router' else access(
                keys, self._side, self._robot, self._routed)}

    def _path(self, name):
        return os.path.join(self.folder, name)

    def _text(self, name):
        with open(self._path(name), encoding='ascii', errors='replace') as file:
            return file.read(_MAX_BYTES)

    def _look(self):
        """Return properties that change with the files, None for a missing file."""
        found = []
        for name in FILES:
            try:
                facts = os.stat(self._path(name))
                found.append((facts.st_mtime_ns, facts.st_ino, facts.st_size))
            except OSError:
                found.append(None)
        return found

    def _openssl(self, *words):
        """Return the output of openssl.

        :raises KeysError: openssl rejects the files
        """
        try:
            done = subprocess.run(
                ['openssl', *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, universal_newlines=True, timeout=20.0)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise KeysError('cannot check the keys: {}'.format(error)) from None
        if done.returncode:
            reason, cause = _reason(done.stdout)
            raise KeysError('{} ({})'.format(reason, self.folder), cause)
        return done.stdout


def _reason(said):
    """Return (the reason why openssl rejects a key with the remedy, the cause)."""
    for words, reason, cause in (
            ('has expired', 'the key has run out: renew it with mhri_keys.sh and put it in place',
             EXPIRED),
            ('not yet valid', 'the time of the key has not begun: set the clock of this computer',
             EARLY),
            ('revoked', 'the key is withdrawn: make another one', WRONG),
            ('unable to get', 'the key is of another authority: put its own authority in place',
             WRONG),
            ('signature failure', 'the key is of another authority: put its own in place', WRONG)):
        if words in said:
            return reason, cause
    return 'openssl refuses the key: {}'.format(said.strip()[-200:]), WRONG


class Reserve:
    """File descriptors in reserve, to read keys while a flood of connections uses up all others."""

    def __init__(self):
        self._held = []
        self.take()

    def take(self):
        """Fill the reserve, as far as possible."""
        try:
            while len(self._held) < _RESERVED:
                self._held.append(os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC))
        except OSError:
            pass  # retried at the next call

    def give(self):
        """Release the reserve."""
        while self._held:
            os.close(self._held.pop())


def watch_keys(folder, carrier):
    """Make a :class:`mhri.link.ros.carrier.Carrier` use replaced keys, on a thread.

    It disconnects while the keys are unusable, since they may be intended to lock out a linked
    peer. When a certificate expires, TLS closes the connection at once, and its datagrams are
    refused two seconds later, if the lists contain the expiry. Another name in the own key requires
    a restart, and ends the process.
    """
    threading.Thread(target=_watch, args=(folder, carrier, Reserve()), name='keys',
                     daemon=True).start()


def _watch(folder, carrier, reserve):
    failed, looked_at = False, time.time()
    # Not rospy.sleep, which depends on the clock of ROS.
    pause = threading.Event()
    while not rospy.is_shutdown():
        pause.wait(_LOOK_S)
        before, looked_at = looked_at, time.time() - _SURE_S
        ended = folder.keys.ended(before, looked_at)
        if ended:
            rospy.logwarn('a certificate has expired: %s', ', '.join(sorted(ended)))
            carrier.agree_again(ended)
        if not (failed or folder.changed()):
            reserve.take()
            continue
        own, failed = folder.keys.own, True
        try:
            # First disconnect, since connections may use up the descriptors required for reading.
            carrier.hang_up()
            reserve.give()
            secrets = folder.read()
            if folder.keys.own != own:
                rospy.signal_shutdown('the key in place now belongs to {}'.format(folder.keys.own))
                return
            reserve.take()
            carrier.renew(secrets)
            failed = False
            rospy.loginfo('the keys in %s are in use as they are now', folder.folder)
        except (CarrierError, KeysError, OSError) as error:
            rospy.logwarn_throttle(10.0, 'disconnected: the new keys are unusable: '
                                   '{}'.format(error))
