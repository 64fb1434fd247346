# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Answers what mhri_run.sh asks before it starts anything.

Usage: before_start.py master URI             prints master, silent, other or nothing
       before_start.py running URI            prints the mux and the panel that run on a master
       before_start.py reaches ADDRESS        prints yes if this computer reaches itself there
       before_start.py arguments FILE [ARG:=VALUE]...
                                              prints what is wrong with a launch file's arguments

Works without ROS; skips what needs YAML if that is not installed.
"""
import difflib
import os
import re
import socket
import sys
import threading
import time
import urllib.parse
import uuid
import xml.etree.ElementTree as ElementTree
import xmlrpc.client

CALLER = '/mhri_run'
TIMEOUT_S = 3.0
# A node that serves or publishes all of these is one. What it publishes tells it from a node that
# has taken its port.
MUX_SERVICE, MUX_TOPIC = '/mux/set_stop_all', '/robot_controller/twist'
PANEL_TOPICS = ('/mux_in/mode_select', '/robot_controller/robot_select')
CHOICES = {'gui': ('auto', 'rqt', 'standalone', 'none')}
MAX_ROBOTS = 12
ROBOT = re.compile(r'[A-Za-z0-9_/]+\Z')
# The launch file quotes these, and a quote in them could add options.
QUOTED = ('screenshot', 'demo_result', 'links')


def what_is_at(uri):
    """Return 'master', 'silent', 'other' or 'nothing': what answers at a master's address."""
    place = urllib.parse.urlsplit(uri)
    try:
        socket.create_connection((place.hostname, place.port)).close()
    except OSError:
        return 'nothing'
    try:
        xmlrpc.client.ServerProxy(uri).getPid(CALLER)
        return 'master'
    except OSError:
        return 'silent'
    except Exception:  # whatever it answers, it is not a master's answer
        return 'other'


def candidates(state):
    """Return {name: topic} of the nodes that a master knows as muxes and panels.

    :param state: the value of getSystemState: publishers, subscribers, services
    """
    published, _, services = (dict(part) for part in state)
    panels = set.intersection(*(set(published.get(topic, ())) for topic in PANEL_TOPICS))
    return {**{name: MUX_TOPIC for name in services.get(MUX_SERVICE, ())},
            **{name: PANEL_TOPICS[-1] for name in panels}}


def is_here(host):
    """Return whether a host is this computer."""
    try:
        with socket.socket() as sock:
            sock.bind((host, 0))
        return True
    except OSError:
        return False


def running(uri):
    """Return which muxes and panels run on a master, and where, as text; '' if none answers.

    A killed node stays registered: a node counts only if it says itself that it publishes what a
    mux or a panel does. All are asked at once, for at most three seconds.
    """
    try:
        master = xmlrpc.client.ServerProxy(uri)
        known = candidates(master.getSystemState(CALLER)[2])
    except Exception:  # roslaunch will complain about a master that does not answer
        return ''
    places = {}

    def ask(name, topic):
        try:
            place = xmlrpc.client.ServerProxy(uri).lookupNode(CALLER, name)[2]
            publications = xmlrpc.client.ServerProxy(place).getPublications(CALLER)[2]
            if topic in [publication[0] for publication in publications]:
                host = urllib.parse.urlsplit(place).hostname
                places[name] = 'this computer' if is_here(host) else host
        except Exception:  # it has ended, or its computer is gone
            pass

    threads = [threading.Thread(target=ask, args=item, daemon=True) for item in known.items()]
    deadline = time.monotonic() + TIMEOUT_S
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))
    found = sorted(places.items())
    return '; '.join('{} on {}'.format(' and '.join(
        name for name, place in found if place == host), host)
        for host in sorted(set(dict(found).values())))


def reaches(address):
    """Return whether this computer reaches itself at an address (e.g. behind a router's NAT)."""
    token = uuid.uuid4().bytes
    with socket.create_server(('', 0)) as server:
        try:
            with socket.create_connection((address, server.getsockname()[1])) as sending:
                sending.sendall(token)
                return server.accept()[0].recv(len(token)) == token
        except OSError:
            return False


def read_yaml(path):
    """Return the content of a YAML file; None if unreadable, which its real reader will report."""
    try:
        import yaml
        with open(path, encoding='utf-8') as stream:
            return yaml.safe_load(stream)
    except Exception:
        return None


def simulated_types(resource):
    """Return the type names that --sim takes, or None if unknown."""
    try:
        bodies = sorted(read_yaml(os.path.join(resource, 'sim', 'bodies.yaml'))['bodies'])
    except (TypeError, KeyError):
        return None
    # turtlebot.launch takes this one for a Burger.
    return sorted(bodies + ['turtlebot3']) if 'turtlebot3_burger' in bodies else bodies


def source_names(path):
    """Return the names of the sources in a mux file, or None if unknown."""
    try:
        return [source['name'] for source in read_yaml(path)['sources']]
    except (TypeError, KeyError):
        return None


def one_of(words):
    """Return words as a phrase: 'a, b or c'."""
    return ' or '.join(filter(None, [', '.join(words[:-1]), words[-1]]))


def wrong_value(name, value, default, resource, mux_config):
    """Return the problem of an argument's value, or None."""
    allowed, given = CHOICES.get(name), [value]
    if name == 'robots':
        odd = [word for word in value.split() if not ROBOT.match(word)]
        return odd and "robots: '{}' is not a robot's name".format(odd[0])
    if name in QUOTED and "'" in value:
        return '{}: a quote is in {}'.format(name, value)
    if default in ('true', 'false'):
        allowed = ('true', 'false')
    elif name == 'inputs':
        rows = read_yaml(os.path.join(resource, 'inputs.yaml'))
        allowed, given = rows and list(rows) + ['none'], value.split()
    elif name == 'sim':
        allowed = [str(number) for number in range(MAX_ROBOTS + 1)]
    elif name == 'enabling' and value:
        allowed = source_names(mux_config)
    elif name == 'sim_types':
        allowed, given = simulated_types(resource), value.split() or ['']
        wrong = [word for word in given if word not in (allowed or given)]
        return wrong and "cannot simulate '{}'; the types to simulate are {}".format(
            "', '".join(wrong), ', '.join(allowed))
    wrong = [word for word in given if word not in (allowed or given)]
    return wrong and "{}: '{}' is not {}".format(
        name, wrong[0], 'a number from 0 to 12' if name == 'sim' else one_of(allowed))


def wrong_argument(path, words):
    """Return the problem of the first invalid ARG:=VALUE, or None.

    :param path: of the launch file; the files it reads are in ``resource`` beside its folder
    """
    known = {arg.get('name'): arg.get('default') for arg in ElementTree.parse(path).findall('arg')
             if arg.get('value') is None}
    resource = os.path.join(os.path.dirname(path), '..', 'resource')
    values = dict(word.split(':=', 1) for word in words)
    mux_config = values.get('mux_config', os.path.join(resource, 'mux.yaml'))
    for name, value in values.items():
        if name not in known:
            near = difflib.get_close_matches(name, known)
            return "there is no argument '{}' in {}: {}".format(
                name, os.path.basename(path), 'did you mean {}?'.format(one_of(near)) if near
                else 'it has ' + ', '.join(known))
        problem = wrong_value(name, value, known[name], resource, mux_config)
        if problem:
            return problem
    return None


def main(what, *args):
    """Answer one question on the standard output."""
    socket.setdefaulttimeout(TIMEOUT_S)
    if what == 'arguments':
        answer = wrong_argument(args[0], args[1:])
    elif what == 'reaches':
        answer = 'yes' if reaches(*args) else 'no'
    else:
        answer = {'master': what_is_at, 'running': running}[what](*args)
    print(answer or '')


if __name__ == '__main__':
    main(*sys.argv[1:])
