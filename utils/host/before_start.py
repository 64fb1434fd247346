# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What mhri_run.sh asks before it starts anything.

Usage: before_start.py master URI             prints master, silent, other or nothing
       before_start.py running URI            prints the mux and the panel that run on a master
"""
import socket
import sys
import threading
import time
import urllib.parse
import xmlrpc.client

CALLER = '/mhri_run'
PATIENCE_S = 3.0
# Who serves or publishes all of these is one; the last is a topic that it publishes itself, by which
# it is told from whoever has its port by now.
MUX_SERVICE, MUX_TOPIC = '/mux/set_stop_all', '/robot_controller/twist'
PANEL_TOPICS = ('/mux_in/mode_select', '/robot_controller/robot_select')


def what_is_at(uri):
    """Return 'master', 'silent', 'other' or 'nothing': what is at the address of a master."""
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

    :param state: what getSystemState tells: publishers, subscribers, services
    """
    published, _, services = (dict(part) for part in state)
    panels = set.intersection(*(set(published.get(topic, ())) for topic in PANEL_TOPICS))
    return {**{name: MUX_TOPIC for name in services.get(MUX_SERVICE, ())},
            **{name: PANEL_TOPICS[-1] for name in panels}}


def is_here(host):
    """Tell whether a host is this computer."""
    try:
        with socket.socket() as sock:
            sock.bind((host, 0))
        return True
    except OSError:
        return False


def running(uri):
    """Return which muxes and panels run on a master, and where, as text; '' where none answers.

    What was killed stays registered: a node counts only where it says itself that it publishes what
    such a node does. All are asked at once, for three seconds at most.
    """
    try:
        master = xmlrpc.client.ServerProxy(uri)
        known = candidates(master.getSystemState(CALLER)[2])
    except Exception:  # a master that cannot be asked is roslaunch's to complain of
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
    deadline = time.monotonic() + PATIENCE_S
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))
    found = sorted(places.items())
    return '; '.join('{} on {}'.format(' and '.join(
        name for name, place in found if place == host), host)
        for host in sorted(set(dict(found).values())))


def main(what, *args):
    """Answer one question on the standard output."""
    socket.setdefaulttimeout(PATIENCE_S)
    answer = {'master': what_is_at, 'running': running}[what](*args)
    print(answer)


if __name__ == '__main__':
    main(*sys.argv[1:])
