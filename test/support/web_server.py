#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The server of the page without ROS, in a process of its own.

It prints a line of JSON: its port, and a token to watch, one that may also stop, and one to drive;
for each line that it reads, another: what it was told to do since the last. A line ``pictures N``
offers N new pictures of three robots first.
"""
import json
import secrets
import sys

from mhri.web.io.hub import Outputs
from mhri.web.io.server import WebServer
from mhri.web.links import DRIVE, LinkBook, WATCH

ROBOTS = 'bot1', 'bot2', 'bot3'
SIZE = 30000


class Counting(Outputs):
    """Counts what is asked for."""

    def __init__(self):
        self.sticks, self.stops, self.heads, self.lines, self.viewers = [], 0, 0, 0, []

    def stick(self, turn, ahead, sideways):
        self.sticks.append([turn, ahead, sideways])

    def stop(self, who):
        self.stops += 1

    def head(self, robot, pan, tilt):
        self.heads += 1

    def show(self, links, viewers, pictures_hz, looked_at):
        self.viewers = [[viewer.link.label, viewer.pacing.thinned(), holds]
                        for viewer, holds in viewers]

    def log(self, text):
        self.lines += 1

    def take(self):
        """Return what was counted, and begin anew."""
        sticks, self.sticks = self.sticks, []
        return {'sticks': sticks, 'stops': self.stops, 'heads': self.heads, 'lines': self.lines,
                'viewers': self.viewers}


def main():
    outputs = Counting()
    files = {'index.html': b'page', 'page.js': b'//'}
    server = WebServer(LinkBook(lambda: secrets.token_urlsafe(16)), files, outputs,
                       [('127.0.0.1', 0, None)]).start()
    hub = server.hub
    tokens = [hub.do(hub.give, *words, False, 1.0)[1] for words in (
        ('watch', WATCH, False), ('stop', WATCH, True), ('drive', DRIVE, False))]
    hub.put('state', {'robots': [{'name': name, 'picture': '/{}/camera'.format(name),
                                  'placed': False} for name in ROBOTS]})
    hub.allow('')
    print(json.dumps({'port': server.ports[0], 'tokens': tokens}), flush=True)
    for line in sys.stdin:
        word, _, count = line.strip().partition(' ')
        for _ in range(int(count or 0) if word == 'pictures' else 0):
            for name in ROBOTS:
                hub.show_picture('/{}/camera'.format(name), 'jpeg', b'\xff\xd8' + bytes(SIZE))
        print(json.dumps(outputs.take()), flush=True)


if __name__ == '__main__':
    main()
