# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keys as the guide makes them, word by word: read, refused where they are wrong, and linked by."""
import pathlib
import re
import shutil
import subprocess
from types import SimpleNamespace

import pytest

from mhri.link.carried import COMMAND
from mhri.link.keys import KeysError
from mhri.link.ros.carrier import Carrier, CarrierError
from mhri.link.ros.datagrams import PASS
from mhri.link.ros.key_folder import AUTO, find_folder, KeyFolder, OFF
from mhri.link.ros.refused_peers import EVERY_S, RefusalLog, meaning
from support.ros_system import free_port, wait_for

REPO = pathlib.Path(__file__).resolve().parents[3]
# The robot is a folder; the first call only opens the connection.
SSH = '''#!/bin/bash
[ "${{*: -1}}" != true ] || exit 0
[ "$1" != -S ] || [ "$3" != -O ] || exit 0
cd {robot} && HOME={robot} exec /bin/sh -c "${{*: -1}}"
'''


class Guide:
    """The commands of the chapter, run one after another in a home of their own."""

    def __init__(self, home):
        self.home, self.robot = home, home / 'robot'
        for folder in (self.robot, home / 'bin'):
            folder.mkdir()
        (home / 'bin' / 'ssh').write_text(SSH.format(robot=self.robot))
        (home / 'bin' / 'ssh').chmod(0o755)
        text = (REPO / 'doc' / 'guide' / 'security.md').read_text(encoding='utf-8')
        chapter = text.split('## Keys in five minutes')[1].split('\n## ')[0]
        self.commands = re.findall(r'^    (utils/host/mhri_keys.sh .*)$', chapter, re.MULTILINE)
        self.here, self.there = home / '.config/mhri/keys', self.robot / 'mhri/keys'

    def follow(self, commands):
        for command in commands:
            subprocess.run(command.split(), cwd=str(REPO), check=True, stdout=subprocess.DEVNULL,
                           env={'PATH': '{}:/usr/bin:/bin'.format(self.home / 'bin'),
                                'HOME': str(self.home)})


@pytest.fixture(scope='module')
def made(tmp_path_factory):
    guide = Guide(tmp_path_factory.mktemp('guide'))
    guide.follow(guide.commands[:5])
    return guide


@pytest.fixture
def keys(made, tmp_path):
    """Return a copy of the host's folder."""
    return pathlib.Path(shutil.copytree(str(made.here), str(tmp_path / 'keys')))


def renewed(carrier, secrets):
    """Take up keys, as the node does, once the port is free; return whether."""
    try:
        carrier.renew(secrets)
    except CarrierError:
        return False
    return True


def figures(carrier):
    """Return what the diagnostics say of a carrier."""
    said = []
    carrier.fill(SimpleNamespace(add=lambda _, value: said.append(value)))
    return said


def test_what_the_guide_makes_links_host_and_robot(made):
    host, robot = KeyFolder(made.here, 'host', 'bot1'), KeyFolder(made.there, 'robot', 'bot1')
    endpoint, heard = 'tls/127.0.0.1:{}'.format(free_port()), []
    secrets = robot.read(), host.read()
    there = Carrier(listen=[endpoint], secrets=secrets[0], own=robot.keys.own)
    here = Carrier(connect=[endpoint], secrets=secrets[1], own=host.keys.own)
    assert (host.keys.own, robot.keys.own) == ('host:lab', 'robot:bot1')
    try:
        betweens = [side.between('bot1', 'host:lab') for side in (there, here)]
        for between, way in zip(betweens, ('down', 'up')):
            between.listen(way, lambda *row: None)
        there.between('bot1', 'host:lab').listen('down', lambda *row: heard.append(row))
        sends = [here.between('bot1', name).sender('down', 'topic', COMMAND)
                 for name in ('host:lab', 'host:other')]

        def arrives():
            for send, data in zip(sends, (b'right', b'wrong')):
                send(data)
            return heard
        wait_for(arrives, 60.0, 'bytes', 0.05)
        # With other keys on both sides they meet again.
        here.renew(host.read())
        wait_for(lambda: renewed(there, robot.read()), 60.0, 'the port to be free', 0.2)
        heard.clear()
        wait_for(arrives, 60.0, 'bytes again', 0.05)
        assert {data for _, data in heard} == {b'right'}
        wait_for(lambda: PASS in figures(here) and PASS in figures(there), 60.0, 'datagrams')
    finally:
        here.close()
        there.close()


def test_the_rest_of_the_guide_is_noticed_while_running(tmp_path):
    guide = Guide(tmp_path)
    guide.follow(guide.commands[:5])
    host, robot = KeyFolder(guide.here, 'host', 'bot1'), KeyFolder(guide.there, 'robot', 'bot1')
    before = host.read()['access_control']
    robot.read()
    assert before['subjects'] and not host.changed()
    guide.follow(guide.commands[5:])
    assert host.changed() and not robot.changed()
    assert host.read()['access_control']['subjects'] == []
    assert host.keys.withdrawn == {'robot:bot1'}


@pytest.mark.parametrize('damage, says', [
    (lambda keys: (keys / 'own.key').unlink(), 'no own.key in .*mhri_keys.sh put'),
    (lambda keys: (keys / 'own.key').chmod(0o644), 'others may read .*own.key'),
    (lambda keys: (keys / 'own.pem').write_text('x'), 'openssl refuses the key'),
    (lambda keys: (keys / 'withdrawn').write_text('77 robot:bot1\n'), 'not the one that .* signed'),
    (lambda keys: (keys / 'withdrawn.pem').write_text(''), 'openssl refuses the key')])
def test_a_folder_that_is_damaged(keys, damage, says):
    damage(keys)
    with pytest.raises(KeysError, match=says):
        KeyFolder(keys, 'host', 'bot1').read()


def test_where_keys_are(made, monkeypatch, tmp_path):
    monkeypatch.delenv('XDG_CONFIG_HOME', raising=False)
    monkeypatch.setenv('HOME', str(made.home))
    assert find_folder(AUTO) == str(made.here)
    assert find_folder(OFF) is None and find_folder('~/x') == str(made.home / 'x')
    monkeypatch.setenv('HOME', str(made.robot))
    assert find_folder(AUTO) == str(made.there)
    monkeypatch.setenv('HOME', str(tmp_path))
    assert find_folder(AUTO) is None


@pytest.mark.parametrize('line, words', [
    ('WARN zenoh_link_tls::unicast: peer sent no certificates. Hint: ...', 'without a key'),
    ('INFO zenoh::net::routing: 12 did not match any configured ACL subject. ...', 'is withdrawn'),
    ('WARN zenoh_link_tls::unicast: invalid peer certificate: UnknownIssuer', 'another authority'),
    ('WARN zenoh_link_tls::unicast: invalid peer certificate: Expired', 'expired'),
    ('WARN zenoh_link_tls::unicast: received corrupt message', 'without TLS')])
def test_refusals_in_words(line, words):
    assert words in meaning(line)


def test_one_line_for_many_refusals():
    lines, now = [], [100.0]
    refusals = RefusalLog(lines.append, lambda: now[0])
    line = 'WARN zenoh_link_tls::unicast: peer sent no certificates'
    assert not refusals.on_line('[INFO] something of ours\n')
    for _ in range(50):
        assert refusals.on_line(line)
    assert len(lines) == 1
    now[0] += EVERY_S
    refusals.on_line(line)
    assert len(lines) == 2
