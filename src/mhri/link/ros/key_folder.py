# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder with the keys of this computer, as ``utils/host/mhri_keys.sh put`` fills it."""
import os
import subprocess
import threading
import time

import rospy

from mhri.link.keys import access, access_of_router, check_own, KeysError, read_lists, routers
from mhri.link.ros.carrier import CarrierError

OFF, AUTO = 'off', 'auto'
FILES = ('own.key', 'own.pem', 'authority.pem', 'peers', 'withdrawn', 'withdrawn.pem')
# Where the script puts them on a host, and on a robot.
PLACES = ('~/.config/mhri/keys', '~/mhri/keys')
_MOST_BYTES = 1 << 20
# The files are looked at this often [s].
_LOOK_S = 1.0
# TLS has hung up on whose certificate has run out for so long [s].
_SURE_S = 1.0
# For openssl, its pipes, and the files.
_RESERVED = 24
_TLS = 'transport/link/tls/'


def find_folder(text):
    """Return the folder that ``--keys`` means, None for a link without keys."""
    if text == AUTO:
        config = os.environ.get('XDG_CONFIG_HOME')
        places = PLACES + ((os.path.join(config, 'mhri', 'keys'),) if config else ())
        return next((path for path in map(os.path.expanduser, places)
                     if os.path.exists(os.path.join(path, 'own.pem'))), None)
    return None if text == OFF else os.path.abspath(os.path.expanduser(text))


class KeyFolder:
    """Reads the keys of one end of a robot's link, and notices other ones.

    :param side: ``robot``, ``host`` or ``router``
    :param routed: what is called is a router
    """

    def __init__(self, folder, side, robot, routed=False):
        self.folder, self._side, self._robot, self._routed = folder, side, robot, routed
        self._seen = None
        self.keys = None

    def changed(self):
        """Tell whether the files are others than those that were read last."""
        return self._look() != self._seen

    def read(self):
        """Return zenoh's settings for them; :attr:`keys` says whose they are.

        :raises KeysError: they cannot be used; :attr:`keys` stays as it was
        """
        seen = self._look()
        missing = [name for name, found in zip(FILES, seen) if found is None]
        if missing:
            raise KeysError('there is no {} in {}: put a key in place with mhri_keys.sh put'.format(
                missing[0], self.folder))
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
            # The name is what access_control compares: it knows the robot, not its address, and
            # lets nobody in whom a public authority has given a certificate.
            _TLS + 'verify_name_on_connect': False, _TLS + 'close_link_on_expiration': True,
            'access_control': access_of_router(keys) if self._side == 'router' else access(
                keys, self._side, self._robot, self._routed)}

    def _path(self, name):
        return os.path.join(self.folder, name)

    def _text(self, name):
        with open(self._path(name), encoding='ascii', errors='replace') as file:
            return file.read(_MOST_BYTES)

    def _look(self):
        """Return what tells the files from others, None for one that is not there."""
        found = []
        for name in FILES:
            try:
                facts = os.stat(self._path(name))
                found.append((facts.st_mtime_ns, facts.st_ino, facts.st_size))
            except OSError:
                found.append(None)
        return found

    def _openssl(self, *words):
        """Return what openssl says.

        :raises KeysError: it refuses the files
        """
        try:
            done = subprocess.run(
                ['openssl', *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, universal_newlines=True, timeout=20.0)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise KeysError('cannot look at the keys: {}'.format(error)) from None
        if done.returncode:
            raise KeysError(_reason(done.stdout) + ' ({})'.format(self.folder))
        return done.stdout


def _reason(said):
    """Return why openssl refuses a key, and the remedy."""
    for words, reason in (
            ('has expired', 'the key has run out: renew it with mhri_keys.sh and put it in place'),
            ('not yet valid', 'the time of the key has not begun: set the clock of this computer'),
            ('revoked', 'the key is withdrawn: make another one'),
            ('unable to get', 'the key is of another authority: put its own authority in place'),
            ('signature failure', 'the key is of another authority: put its own in place')):
        if words in said:
            return reason
    return 'openssl refuses the key: {}'.format(said.strip()[-200:])


class Reserve:
    """Descriptors that nobody else takes, for reading keys while a flood has all others."""

    def __init__(self):
        self._held = []
        self.take()

    def take(self):
        """Hold what is missing, as far as there is any."""
        try:
            while len(self._held) < _RESERVED:
                self._held.append(os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC))
        except OSError:
            pass  # the next time

    def give(self):
        """Let go of all."""
        while self._held:
            os.close(self._held.pop())


def watch_keys(folder, carrier):
    """Let a :class:`mhri.link.ros.carrier.Carrier` take up keys that are replaced; returns at once.

    Where they cannot be used it hangs up until they can: one of those who are linked may be whom
    they keep out. Whose certificate runs out is hung up on by TLS at once, and loses its datagrams
    two seconds later, where the lists in place tell when that is. Another name in the own key wants
    a new start, and ends the process: its keys name it.
    """
    threading.Thread(target=_watch, args=(folder, carrier, Reserve()), name='keys',
                     daemon=True).start()


def _watch(folder, carrier, reserve):
    failed, looked_at = False, time.time()
    # Not rospy.sleep: this is to go on whatever the clock of ROS does.
    pause = threading.Event()
    while not rospy.is_shutdown():
        pause.wait(_LOOK_S)
        before, looked_at = looked_at, time.time() - _SURE_S
        ended = folder.keys.ended(before, looked_at)
        if ended:
            rospy.logwarn('a certificate has run out: %s', ', '.join(sorted(ended)))
            carrier.agree_again(ended)
        if not (failed or folder.changed()):
            reserve.take()
            continue
        own, failed = folder.keys.own, True
        try:
            # First of all: those who knock have the descriptors that reading takes.
            carrier.hang_up()
            reserve.give()
            secrets = folder.read()
            if folder.keys.own != own:
                rospy.signal_shutdown('the key in place is that of {} now'.format(folder.keys.own))
                return
            reserve.take()
            carrier.renew(secrets)
            failed = False
            rospy.loginfo('the keys in %s are in use as they are now', folder.folder)
        except (CarrierError, KeysError, OSError) as error:
            rospy.logwarn_throttle(10.0, 'nobody is linked: the keys that are new cannot be used: '
                                   '{}'.format(error))
