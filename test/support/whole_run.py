# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A run of the one command, for real, in this checkout or in a new one."""
import os
import shutil
import signal
import subprocess
import uuid
import xmlrpc.client

from support.checkout import children_with, REPO
from support.ros_system import free_port

SCRIPT = REPO / 'utils' / 'host' / 'mhri_run.sh'
START_S = 180.0


class Run:
    """One run of the script, without a display, as the operator of a bare machine has it.

    It ends with the block that it is used in.
    """

    def __init__(self, folder, arguments, before=(), script=SCRIPT):
        self.mark = 'MHRI_E2E={}'.format(uuid.uuid4())
        name, value = self.mark.split('=')
        # What roslaunch says comes at its end otherwise: its output is no terminal here.
        environment = dict(os.environ, ROS_HOME=str(folder / 'ros'), PYTHONUNBUFFERED='1',
                           XDG_CONFIG_HOME=str(folder / 'config'), **{name: value})
        for name in ('DISPLAY', 'WAYLAND_DISPLAY', 'XAUTHORITY', 'ROS_MASTER_URI', 'ROS_IP'):
            environment.pop(name, None)
        self._log = folder / 'log-{}'.format(value)
        with self._log.open('w') as log:
            self.process = subprocess.Popen(
                list(before) + [str(script)] + list(arguments), cwd=str(folder), env=environment,
                stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))

    @property
    def output(self):
        return self._log.read_text()

    def wait(self, limit_s):
        """Return the exit status; nothing of the run is left then."""
        status = self.process.wait(timeout=limit_s)
        assert children_with(self.mark) == []
        return status

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(timeout=120)


def new_master():
    """Return (address, proxy) of a master that the script will start."""
    uri = 'http://127.0.0.1:{}'.format(free_port())
    return uri, xmlrpc.client.ServerProxy(uri)


def node_uri(proxy, node):
    """Return the address of a registered node, or None."""
    try:
        code, _, uri = proxy.lookupNode('/test', node)
    except OSError:
        return None
    return uri if code == 1 else None


def publishers(proxy, topic):
    """Return the names of the nodes that publish a topic; none while there is no master."""
    try:
        return dict(proxy.getSystemState('/test')[2][0]).get(topic, [])
    except OSError:
        return []


def new_checkout(folder):
    """Copy what is in this one, as a clone would, to a folder; return its script."""
    shutil.copytree(str(REPO), str(folder),
                    ignore=shutil.ignore_patterns('build', '.git', '__pycache__'))
    return folder / 'utils' / 'host' / 'mhri_run.sh'


def in_new_terminal(command, space):
    """Return what a command prints in a terminal in which the setup file was sourced, as told."""
    done = subprocess.run(
        ['bash', '-c', 'source "$0/setup.bash"; ' + command, str(space)], env={
            'PATH': '/usr/bin:/bin', 'HOME': str(space)}, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, done.stdout
    return done.stdout
