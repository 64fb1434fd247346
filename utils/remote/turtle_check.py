#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the network for turtle_remote.sh; operators do not call it.

turtle_check.py host HOST PORT OWN NAME     checks the master, both ways, and that NAME is free
turtle_check.py claim HOST PORT NAME TOKEN  notes there that NAME runs from here
turtle_check.py watch HOST PORT NAME TOKEN  ends when the host has a new master, which does not know
                                            the note; where turtle_remote.sh is killed, it sees that
                                            nothing of its run is left
turtle_check.py release HOST PORT NAME TOKEN  takes back the note, and all parameters of NAME since
turtle_check.py hold PID COMMAND...         becomes COMMAND; the kernel ends it with its parent PID
turtle_check.py end TOKEN                   kills what a run of turtle_remote.sh has left running

Exit status 1 if something is wrong, and one line that says what, and the remedy. Needs only the
standard library; runs under the Python 2.7 of older robots, too.
"""
import ctypes
import errno
import os
import signal
import socket
import sys
import threading
import time
import uuid
from xml.parsers.expat import ExpatError

try:
    from http.client import HTTPException
    from urllib.parse import urlsplit
    from xmlrpc.client import Error as XmlRpcError, ServerProxy
    from xmlrpc.server import SimpleXMLRPCServer
except ImportError:
    from httplib import HTTPException
    from SimpleXMLRPCServer import SimpleXMLRPCServer
    from urlparse import urlsplit
    from xmlrpclib import Error as XmlRpcError, ServerProxy

TIMEOUT_S = 3.0
# From Linux's prctl.h.
PR_SET_PDEATHSIG = 1
CALLER = '/mhri_remote'
# The host's own nodes, which show what address it gives them.
HOST_NODES = ('/rosout', '/mux', '/mhri_panel')
WATCH_EVERY_S = 2.0
RUN_ID_TIMEOUT_S = 3.0
# Of a line for the operator; a master may say anything.
LONGEST = 500
RUN_ID_TRIES = 15
# What a run of turtle_remote.sh starts has this and its token in the environment.
MARK = 'MHRI_REMOTE_ID='
# roslaunch waits up to 17 s for its nodes before it kills them.
END_S = 25.0
# Ways in which a call to a master fails; half an answer is one of them.
FAILURES = (XmlRpcError, HTTPException, ExpatError, OSError, socket.error)
# On the host: which program has a port.
WHO = "sudo ss -ltnp 'sport = :{0}'"


class Problem(Exception):
    """Something is wrong; the text says what, and the remedy."""


def say(text):
    """Print a line for the operator; ignore a closed terminal."""
    text = ''.join(char if ' ' <= char <= '~' else '?' for char in str(text))
    if len(text) > LONGEST:
        text = '{0} ... {1}'.format(text[:LONGEST - 200], text[-190:])
    try:
        sys.stderr.write('mhri: {0}\n'.format(text))
        sys.stderr.flush()
    except (OSError, IOError):
        return


def address(text):
    """Return a text that is an IPv4 address.

    :raises Problem: it is none
    """
    try:
        socket.inet_pton(socket.AF_INET, text)
    except (OSError, socket.error, ValueError):
        raise Problem('{0:.40} is not an IPv4 address such as 192.168.0.103'.format(repr(text)))
    return text


def number(text):
    """Return the port that a text says.

    :raises Problem: it is none
    """
    if not (text.isdigit() and len(text) <= 5 and 0 < int(text) < 65536):
        raise Problem('there is no port {0:.40}'.format(repr(text)))
    return int(text)


def connect(host, port):
    """Return if the port accepts a connection.

    :raises Problem: it does not, with the reason
    """
    try:
        socket.create_connection((host, port), TIMEOUT_S).close()
    except socket.timeout:
        raise Problem('no answer from {0} within {1:.0f} s: is it on, on the same network as this '
                      'robot, and does its firewall let port {2} in? Try: ping {0}'.format(
                          host, TIMEOUT_S, port))
    except (OSError, socket.error) as error:
        if error.errno == errno.ECONNREFUSED:
            raise Problem('{0} answers, but no ROS master runs on its port {1}: start mhri on the '
                          'host first (mhri_run.sh --ip {0})'.format(host, port))
        raise Problem('no route leads from here to {0} ({1}): is this robot on its network? '
                      'Try: ping {0}'.format(host, error.strerror))


def master_at(host, port):
    """Return a proxy of the master there.

    :raises Problem: there is none
    """
    connect(host, port)
    proxy = ServerProxy('http://{0}:{1}'.format(host, port))
    try:
        is_master = proxy.getPid(CALLER)[0] == 1
    except (OSError, socket.error):
        # It may be the master of driven robots: the message must not ask to end it.
        raise Problem('{0} takes the connection at its port {1} but does not answer within '
                      '{2:.0f} s: the ROS master there is overloaded or hangs, or something else '
                      'has the port. Other robots may depend on it: see on the host what it is, '
                      'with {3} and top, and try again'.format(
                          host, port, TIMEOUT_S, WHO.format(port)))
    except Exception:  # whatever it answers, it is not a master's answer
        is_master = False
    if not is_master:
        raise Problem('what has port {0} of {1} is not a ROS master: see on the host what it is, '
                      "with {2}, or give the master's port with --port".format(
                          port, host, WHO.format(port)))
    return proxy


def answer(call, *arguments):
    """Return the value of a master's call, or None if it refuses or does not answer."""
    try:
        code, _, value = call(CALLER, *arguments)
    except FAILURES:
        return None
    return value if code == 1 else None


def check_way_back(master, host, own, name):
    """Make the master call us back, at the address that our nodes will have.

    :raises Problem: it does not get through, or the address is not ours
    """
    called = threading.Event()
    try:
        server = SimpleXMLRPCServer((own, 0), logRequests=False)
    except (OSError, socket.error) as error:
        raise Problem('{0} is not an address of this robot ({1}): see hostname -I'.format(
            own, error.strerror))
    server.register_function(lambda *_: called.set() or [1, '', 0], 'paramUpdate')
    thread = threading.Thread(target=server.serve_forever)
    thread.daemon = True
    thread.start()
    port = server.server_address[1]
    api, caller = 'http://{0}:{1}/'.format(own, port), '{0}_{1}_{2}'.format(CALLER, name, port)
    key = '{0}/{1}_{2}'.format(CALLER, name, port)
    try:
        master.subscribeParam(caller, api, key)
        master.setParam(CALLER, key, 1)
        if not called.wait(TIMEOUT_S):
            # A master that has ended meanwhile does not call back; this call shows it.
            master.getPid(CALLER)
            raise Problem('{0} does not reach this robot at {1}: does a firewall here stop it '
                          '(sudo ufw status), or is another address meant (--ip ADDR)?'.format(
                              host, own))
    finally:
        answer(lambda _: master.unsubscribeParam(caller, api, key))
        answer(master.deleteParam, key)
        server.shutdown()
        server.server_close()


def place(master, node):
    """Return the (host name, port) of a node's registration, or None."""
    uri = answer(master.lookupNode, node)
    parts = urlsplit(uri) if uri else None
    return (parts.hostname, parts.port) if parts and parts.hostname and parts.port else None


def check_names_of_host(master, host, own):
    """Check that this robot can reach the host's nodes by the name they are registered with.

    :raises Problem: it cannot
    """
    for node in HOST_NODES:
        where = place(master, node)
        if where is None:
            continue
        if (where[0] == 'localhost' or where[0].startswith('127.')) and host != own:
            raise Problem('only the host itself can reach its nodes ({0} is at {1}): end mhri '
                          'there and start it with mhri_run.sh --ip {2}'.format(
                              node, where[0], host))
        try:
            socket.getaddrinfo(where[0], where[1])
        except (OSError, socket.error):
            raise Problem('the host calls itself {0!s} ({1}), and this robot does not know that '
                          'name: start mhri there with mhri_run.sh --ip {2}'.format(
                              where[0], node, host))


def check_name(master, own, name):
    """Check that no other robot has this one's name: ROS would end the nodes of one of them.

    :raises Problem: one has
    """
    state = master.getSystemState(CALLER)[2]
    nodes = set(node for kind in state for _, users in kind for node in users
                if node.startswith('/{0}/'.format(name)))
    places = {}
    for node in sorted(nodes):
        places.setdefault(place(master, node), node)
    alive = []

    def try_connect(where):
        try:
            socket.create_connection(where, TIMEOUT_S).close()
            alive.append(where)
        except (OSError, socket.error):
            pass  # a leftover of a robot that is gone: its name is free

    threads = [threading.Thread(target=try_connect, args=(where,)) for where in places if where]
    for thread in threads:
        thread.daemon = True
        thread.start()
    for thread in threads:
        thread.join(2 * TIMEOUT_S)
    for where in sorted(alive):
        if where[0] == own:
            raise Problem('{0} already runs, from this robot ({1}): end that first'.format(
                name, places[where]))
        raise Problem('the name {0} is taken: {1} runs at {2}; end that, or give this robot '
                      'another name'.format(name, places[where], where[0]))


def settle_run_id(master):
    """Give a bare rosmaster a run id, as roscore does.

    If two roslaunch start at once and find none, one fails. A roscore that has just started gets
    time to set its own.
    """
    for _ in range(RUN_ID_TRIES):
        if answer(master.getParam, '/run_id') is not None:
            return
        time.sleep(RUN_ID_TIMEOUT_S / RUN_ID_TRIES)
    master.setParam(CALLER, '/run_id', str(uuid.uuid1()))


def check_host(host, port, own, name):
    """Check everything that the robot needs from the host.

    :raises Problem: something is wrong
    """
    master = master_at(host, port)
    try:
        check_way_back(master, host, own, name)
        check_names_of_host(master, host, own)
        check_name(master, own, name)
        settle_run_id(master)
    except FAILURES:
        raise Problem('the master at {0} stopped answering during the checks: see that mhri runs '
                      'there (mhri_run.sh --ip {0}), then start this robot again'.format(host))


def outermost(name, kept):
    """Return the shortest prefix of a name with nothing to keep, None if the name is kept."""
    parts = name.split('/')
    for length in range(2, len(parts) + 1):
        whole = '/'.join(parts[:length])
        if not any((stays + '/').startswith(whole + '/') for stays in kept):
            return whole
    return None


class Claim(object):
    """The note at the master that a robot runs from here; a new master lacks it.

    :param token: says which run of turtle_remote.sh it is
    """

    def __init__(self, host, port, name, token):
        self._host = host
        self._master = ServerProxy('http://{0}:{1}'.format(host, port))
        self._name = name
        self._token = token

    def _key(self, last):
        return '/{0}/{1}'.format(self._name, last)

    def make(self):
        """Note it, and which parameters the robot already has there: those stay afterwards.

        The list of a killed run is still there, and stays valid.

        :raises Problem: the master does not answer
        """
        if answer(self._master.getParam, self._key('mhri_remote_found')) is None:
            answer(self._master.setParam, self._key('mhri_remote_found'), self._parameters())
        if answer(self._master.setParam, self._key('mhri_remote'), self._token) is None:
            raise Problem('the master at {0} stopped answering'.format(self._host))

    def _parameters(self):
        """Return the full names of the robot's parameters."""
        names = answer(self._master.getParamNames) or []
        return [name for name in names if name.startswith(self._key(''))]

    def state(self):
        """Return whether the master has our note; None where it does not answer."""
        try:
            code, _, value = self._master.getParam(CALLER, self._key('mhri_remote'))
        except FAILURES:
            return None
        return code == 1 and value == self._token

    def give_up(self):
        """Take back the note, and what the robot brought: its name is free then."""
        if not self.state():
            return
        found = answer(self._master.getParam, self._key('mhri_remote_found')) or []
        names = self._parameters()
        # Also what an operator sets for the robot while it runs.
        found += [name for name in names if name.startswith(self._key('mhri/'))]
        for name in set(outermost(name, found) for name in names) - {None}:
            answer(self._master.deleteParam, name)

    def watch(self):
        """Return when the host has a new master; say when it falls silent, and when it is back."""
        silent = lost = 0
        while lost < 2:
            time.sleep(WATCH_EVERY_S)
            state = self.state()
            lost = lost + 1 if state is False else 0
            if state is None:
                silent += 1
                if silent == 2:
                    say('{0} no longer answers; this robot waits for it'.format(self._host))
            elif silent:
                if silent > 1:
                    say('{0} answers again'.format(self._host))
                silent = 0


def ends_with(parent):
    """Have the kernel end this process (SIGTERM) with its parent; return whether that still is.

    :param parent: its process id
    """
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)
    return os.getppid() == parent


def hold(parent, command):
    """Become a command in its own session, which ends with our parent."""
    os.setsid()
    if not ends_with(int(parent)):
        sys.exit(1)
    # A shell starts background jobs with this signal ignored, and it would stay so.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.execvp(command[0], command)


def left_of(token):
    """Return what still runs of a run of turtle_remote.sh: {process id: command line}."""
    left = {}
    for entry in os.listdir('/proc'):
        try:
            with open('/proc/{0}/environ'.format(int(entry)), 'rb') as file:
                marked = (MARK + token).encode() in file.read().split(b'\0')
            if marked:
                with open('/proc/{0}/cmdline'.format(entry), 'rb') as file:
                    left[int(entry)] = file.read().replace(b'\0', b' ').decode('utf-8', 'replace')
        except (ValueError, IOError, OSError):
            continue  # no process, somebody else's, or it ended meanwhile
    return left


def end_left(token):
    """Kill what a run of turtle_remote.sh has left running, and what that starts meanwhile."""
    left = left_of(token)
    while left:
        for pid, words in left.items():
            say('ending a leftover process: {0} {1}'.format(pid, words))
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:
                continue  # it ended meanwhile
        time.sleep(0.1)
        left = left_of(token)


def watch(host, port, name, token):
    """Watch whether the host knows that the robot runs from here.

    Where turtle_remote.sh is killed, this process sees that nothing drives on: roslaunch may lose
    the signal where it comes while a node is being started.
    """
    os.setsid()
    script = int(token.split('-')[0])
    signal.signal(signal.SIGTERM, lambda *_: end_watch(script, token))
    if not ends_with(script):
        end_watch(script, token)
    Claim(host, port, name, token).watch()


def end_watch(script, token):
    """End; where turtle_remote.sh has gone, wait for what it started, and kill what stays."""
    if os.getppid() != script:
        for _ in range(int(END_S / 0.1)):
            if not left_of(token):
                break
            time.sleep(0.1)
        end_left(token)
    os._exit(1)


COMMANDS = {
    'host': check_host,
    'claim': lambda *note: Claim(*note).make(),
    'watch': watch,
    'release': lambda *note: Claim(*note).give_up(),
}


def main(arguments):
    """Do what the command line says; return the exit status."""
    socket.setdefaulttimeout(TIMEOUT_S)
    try:
        if arguments[:1] == ['hold'] and len(arguments) > 2:
            hold(arguments[1], arguments[2:])
        if arguments[:1] == ['end'] and len(arguments) == 2:
            end_left(arguments[1])
            return 0
        if len(arguments) != 5 or arguments[0] not in COMMANDS:
            raise Problem('turtle_check.py was called with {0!r:.200}: it is for turtle_remote.sh '
                          'alone'.format(arguments))
        COMMANDS[arguments[0]](address(arguments[1]), number(arguments[2]), *arguments[3:])
    except Problem as problem:
        say(problem)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
