# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Several computers on one: network namespaces with addresses and cables of their own, and sshd.

The process that builds a :class:`Lan` becomes the host (10.77.0.1); each :class:`Robot` is another
machine with its own network, processes, host name, users and log folder. All of it ends with this
process, whatever ends it: the kernel takes it down.
"""
import ctypes
import os
from pathlib import Path
import shutil
import subprocess

import psutil

from support.ros_system import wait_for
from support.stand_ins import workspace

CLONE_NEWNET = 0x40000000
HOST_IP = '10.77.0.1'
ROBOT_IP = '10.77.0.{}'
PASSWORD = 'turtles all the way'
USER = 'turtle'
PACKAGES = Path(__file__).resolve().parent / 'robot_packages'
# What a robot's setup.bash says; the rest of the environment is that of a fresh login.
SETUP_VARIABLES = ('PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH', 'ROS_DISTRO',
                   'ROS_ETC_DIR', 'ROS_ROOT', 'ROS_VERSION', 'ROS_PYTHON_VERSION')


def why_not():
    """Return why there can be no machines here, or None."""
    if os.geteuid() != 0:
        return 'machines of our own need root: network namespaces and sshd'
    for program in ('unshare', 'nsenter', 'setpriv', 'ip', 'ssh', 'ssh-keygen', 'openssl', 'ps'):
        if shutil.which(program) is None:
            return 'there is no {} here (packages util-linux, iproute2, openssh-client, openssl, ' \
                'procps)'.format(program)
    if not Path('/usr/sbin/sshd').exists():
        return 'there is no sshd here (package openssh-server)'
    probe = subprocess.run(
        ['unshare', '--net', '--mount', '--pid', '--uts', '--fork', '--mount-proc', 'sh', '-c',
         'ip link add cable1 type veth peer name cable2 && ip link add lan type bridge'],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    if probe.returncode:
        return 'no network namespaces for us here: ' + probe.stdout.strip()
    return None


def run(*command):
    """Run a command that has to go well; return what it said."""
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, '{}: {}'.format(' '.join(command), done.stdout)
    return done.stdout


class Lan:
    """The network, and this process as its host; use it as a context manager.

    Build it before any thread is started: a thread stays in the network it was started in.
    """

    def __init__(self, folder):
        self.folder = folder
        self.robots = []
        self._before = os.open('/proc/self/ns/net', os.O_RDONLY)
        self._libc = ctypes.CDLL(None, use_errno=True)
        if self._libc.unshare(CLONE_NEWNET):
            raise OSError(ctypes.get_errno(), 'unshare')
        run('ip', 'link', 'set', 'lo', 'up')
        run('ip', 'link', 'add', 'lan', 'type', 'bridge')
        run('ip', 'addr', 'add', HOST_IP + '/24', 'dev', 'lan')
        run('ip', 'link', 'set', 'lan', 'up')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for robot in self.robots:
            robot.close()
        run('ip', 'link', 'del', 'lan')
        self._libc.setns(self._before, CLONE_NEWNET)
        os.close(self._before)

    def robot(self, name):
        """Add a robot's computer to the network."""
        self.robots.append(Robot(self, name, len(self.robots) + 11))
        return self.robots[-1]


class Computer:
    """A network namespace with a cable to the host, which can be cut."""

    HOLD = ('unshare', '--net', 'sleep', 'infinity')
    SPACES = ('--net',)

    def __init__(self, number):
        self.ip = ROBOT_IP.format(number)
        self.cable = 'cable{}'.format(number)
        self._holder = subprocess.Popen(('setpriv', '--pdeathsig', 'KILL') + self.HOLD,
                                        stdin=subprocess.DEVNULL)
        self.pid = wait_for(self._first_process, 20, 'the computer', poll_s=0.02)
        run('ip', 'link', 'add', self.cable, 'type', 'veth', 'peer', 'name', 'eth0', 'netns',
            str(self.pid))
        run('ip', 'link', 'set', self.cable, 'master', 'lan', 'up')
        for words in ('link set lo up', 'addr add {}/24 dev eth0'.format(self.ip),
                      'link set eth0 up'):
            self.run('ip', *words.split())

    def _first_process(self):
        """Return the id of the computer's first process once it is what it shall be."""
        there = os.readlink('/proc/{}/ns/net'.format(self._holder.pid))
        return self._holder.pid if there != os.readlink('/proc/self/ns/net') else None

    def command(self, *words):
        """Return a command line that runs another on this computer."""
        return ['nsenter', '--target', str(self.pid), *self.SPACES, '--', *words]

    def run(self, *words):
        """Run a command on this computer that has to go well; return what it said."""
        return run(*self.command(*words))

    def unplug(self):
        """Cut the link."""
        run('ip', 'link', 'set', self.cable, 'down')

    def plug(self):
        """Mend the link."""
        run('ip', 'link', 'set', self.cable, 'up')

    def close(self):
        """End the computer and everything on it."""
        self._holder.kill()
        self._holder.wait(20)


class Robot(Computer):
    """A robot's computer: stand-in packages in ``~/catkin_ws`` of the user ``turtle``, and sshd."""

    SPACES = ('--net', '--mount', '--pid', '--uts')
    HOLD = ('unshare', *SPACES, '--fork', '--kill-child', '--mount-proc', 'sleep', 'infinity')

    def __init__(self, lan, name, number):
        super().__init__(number)
        self.name = name
        self.folder = lan.folder / name
        self.home = self.folder / 'home'
        self.home.mkdir(parents=True)
        self.run('hostname', name)
        # A second address, on a network that has nothing to do with the host.
        for words in ('link add wifi type bridge', 'link set wifi up',
                      'addr add 172.30.{}.5/16 dev wifi'.format(number)):
            self.run('ip', *words.split())
        self._settle_in()

    def _first_process(self):
        for child in psutil.Process(self._holder.pid).children():
            if child.name() == 'sleep':
                return child.pid
        return None

    def _settle_in(self):
        """Give the machine a user with a password, a place for logs, and a robot's packages."""
        for name in ('passwd', 'shadow'):
            shutil.copy('/etc/' + name, str(self.folder / name))
        with (self.folder / 'passwd').open('a') as file:
            file.write('{}:x:0:0::{}:/bin/bash\n'.format(USER, self.home))
        hashed = run('openssl', 'passwd', '-6', PASSWORD).strip()
        with (self.folder / 'shadow').open('a') as file:
            file.write('{}:{}:19000:0:99999:7:::\n'.format(USER, hashed))
        for name in ('passwd', 'shadow'):
            self.run('mount', '--bind', str(self.folder / name), '/etc/' + name)
        for folder in ('/run', '/var/log'):
            self.run('mount', '-t', 'tmpfs', 'tmpfs', folder)
        self.run('mkdir', '/run/sshd')
        self._write_setup()

    def _write_setup(self):
        setup = self.home / 'catkin_ws' / 'devel' / 'setup.bash'
        setup.parent.mkdir(parents=True)
        exported = {name: os.environ[name] for name in SETUP_VARIABLES if os.environ.get(name)}
        exported.update(workspace(setup.parent, PACKAGES), ROS_HOME=str(self.home / '.ros'))
        lines = ['export {}={!r}'.format(name, value) for name, value in exported.items()]
        lines.append(
            'export TURTLEBOT_BASE=kobuki TURTLEBOT_3D_SENSOR=kinect TURTLEBOT_SIMULATION=false')
        setup.write_text('\n'.join(lines) + '\n')
        (self.home / '.bashrc').write_text(
            'case $- in *i*) ;; *) return ;; esac\nexport ROS_NAMESPACE=TurtleBot7 '
            'TURTLEBOT3_MODEL=burger LDS_MODEL=LDS-01\n')

    def start_sshd(self, keys=None):
        """Start the machine's ssh server; ``keys``: a file of public keys that may come in."""
        key = self.folder / 'host_key'
        if not key.exists():
            run('ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', str(key))
        config = self.folder / 'sshd_config'
        config.write_text('\n'.join([
            'Port 22', 'ListenAddress ' + self.ip, 'HostKey {}'.format(key), 'PidFile none',
            'PermitRootLogin yes', 'StrictModes no', 'UsePAM no', 'PrintMotd no', 'PrintLastLog no',
            'PasswordAuthentication yes', 'KbdInteractiveAuthentication no', 'UseDNS no',
            'AuthorizedKeysFile {}'.format(keys or 'none'), 'Subsystem sftp internal-sftp']) + '\n')
        self.log = self.folder / 'sshd.log'
        with self.log.open('a') as file:
            subprocess.Popen(self.command('/usr/sbin/sshd', '-D', '-e', '-f', str(config)),
                             stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT)
        wait_for(lambda: 'Server listening' in self.log.read_text(), 20, 'sshd', poll_s=0.05)

    def logins(self):
        """Return how often somebody was let in."""
        return self.log.read_text().count('Accepted ')

    def processes(self, text):
        """Return the command lines of this machine's processes that have a text in them."""
        lines = self.run('ps', '-eo', 'args').splitlines()
        return [line for line in lines if text in line]
