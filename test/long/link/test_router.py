# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link through a router, without keys and with: both ends call it, and never each other.

Across networks that do not reach each other: test_link_network.py.
"""
import os
import subprocess
import sys

import pytest

from mhri.link.carried import COMMAND
from mhri.link.ros.carrier import Carrier
from mhri.link.ros.key_folder import KeyFolder
from mhri.nodes.mhri_link import parse, refuses
from support.authority import Authority
from support.ros_system import free_port, wait_for

LONG_S = 60.0
NODE = 'from mhri.nodes.mhri_link import main; main()'


@pytest.fixture(scope='module')
def secrets(tmp_path_factory):
    """Return a function from (name, side) to zenoh's settings for somebody."""
    made = Authority(tmp_path_factory.mktemp('authority'))
    for words in (('host', 'lab'), ('host', 'gallery', '--watch'), ('robot', 'bot1'),
                  ('router', 'hub')):
        made.run(*words)
    return lambda name, side: KeyFolder(str(made.put(name)), side, 'bot1', True).read()


def through(sender, heard):
    """Send until something arrives; return it."""
    def send():
        sender(b'x')
        return heard[-1:] or None
    return wait_for(send, LONG_S, 'a message to come through', poll_s=0.02)


def test_both_call_the_router_whoever_comes_first(secrets):
    """Without keys: test_link_network.py."""
    endpoint = 'tls/127.0.0.1:{}'.format(free_port())

    def opened(name, side, place):
        ends = ([endpoint], []) if place == 'router' else ([], [endpoint])
        return Carrier(*ends, secrets=secrets(name, side), place=place)
    host, robot = opened('lab', 'host', 'routed'), opened('bot1', 'robot', 'routed')
    up, down = [], []
    host.between('bot1', 'host:lab').listen('up', lambda *heard: up.append(heard))
    robot.between('bot1', 'host:lab').listen('down', lambda *heard: down.append(heard))
    send_up = robot.between('bot1', 'host:lab').sender('up', 'odom', COMMAND)
    send_down = host.between('bot1', 'host:lab').sender('down', 'mhri_guard/command', COMMAND)
    try:
        for _ in range(2):
            router = opened('hub', 'router', 'router')
            try:
                assert through(send_up, up) == [('odom', b'x')]
                assert through(send_down, down) == [('mhri_guard/command', b'x')]
            finally:
                router.close()
            del up[:], down[:]
    finally:
        host.close()
        robot.close()


def test_router_passes_on_no_more_than_a_key_allows(secrets):
    """Who may only watch says with what it wants to see, and not as somebody else."""
    endpoint = 'tls/127.0.0.1:{}'.format(free_port())
    # The watcher has a program of its own, which forbids it nothing.
    watching = secrets('gallery', 'host')
    del watching['access_control']
    sessions = [Carrier([endpoint], secrets=secrets('hub', 'router'), place='router')]
    for own in (secrets('bot1', 'robot'), watching):
        sessions.append(Carrier([], [endpoint], secrets=own, place='routed'))
    robot, watch = sessions[1:]
    heard = []
    robot.listen('mhri/bot1/*/down/_beat', lambda key, data: heard.append((key, data)))
    for host in ('host:lab', 'watch:gallery'):
        robot.between('bot1', host).listen('down', lambda *said: heard.append(said))
    try:
        tries = [watch.between('bot1', host).sender('down', topic, COMMAND)
                 for host, topic in (('watch:gallery', 'mhri_guard/command'),
                                     ('host:lab', 'mhri_guard/command'), ('host:lab', '_beat'))]
        beat = watch.between('bot1', 'watch:gallery').sender('down', '_beat', COMMAND)

        def said():
            for send in tries:
                send(b'no')
            beat(b'yes')
            return len([data for _, data in heard if data == b'yes']) > 20
        wait_for(said, LONG_S, 'the beats of who may only watch', poll_s=0.02)
        assert not [row for row in heard if row[1] == b'no']
    finally:
        for session in sessions:
            session.close()


@pytest.mark.parametrize('words, said', [
    ('--side router', '--listen'),
    ('--side router --listen 0.0.0.0:1 --name bot1', '--listen'),
    ('--side host --router 192.0.2.1:1', '--name'),
    ('--side host --name bot1 --router 192.0.2.1:1 --connect 192.0.2.1:1', '--router'),
    ('--side host --name bot1', 'give --listen, --connect or --router')])
def test_options_that_do_not_go_together(words, said, capsys):
    with pytest.raises(SystemExit) as ended:
        parse(words.split())
    assert ended.value.code == 2 and said in capsys.readouterr().err


@pytest.mark.parametrize('words, status', [
    ('--connect 192.0.2.7:7447', 2), ('--router 192.0.2.7:7447', 2),
    ('--connect 127.0.0.1:7447', 0), ('--connect 192.0.2.7:7447 --keys off', 0)])
def test_without_a_key_a_host_calls_others_only_where_that_is_said(words, status, monkeypatch,
                                                                   tmp_path):
    for name in ('HOME', 'XDG_CONFIG_HOME'):
        monkeypatch.setenv(name, str(tmp_path))
    assert refuses(('--side host --name bot1 ' + words).split()) == status


@pytest.mark.parametrize('more, routes', [
    (['--listen', '0.0.0.0:{}'], False), (['--listen', '127.0.0.1:{}'], True),
    (['--listen', '0.0.0.0:{}', '--keys', 'off'], True)])
def test_a_computer_without_a_key_listens_to_others_only_where_that_is_said(tmp_path, more, routes):
    words = [word.format(free_port()) for word in more]
    environment = dict(os.environ, HOME=str(tmp_path), XDG_CONFIG_HOME=str(tmp_path))
    with (tmp_path / 'log').open('w') as log:
        router = subprocess.Popen([sys.executable, '-u', '-c', NODE, '--side', 'router', *words],
                                  env=environment, stdout=log, stderr=subprocess.STDOUT)
    try:
        said = wait_for(lambda: (tmp_path / 'log').read_text().rstrip(), LONG_S, 'a word of it')
        if routes:
            assert 'routing on' in said and 'without keys' in said
        else:
            assert router.wait(LONG_S) == 1
            assert words[1] in said and 'mhri_keys.sh' in said and '--keys off' in said
    finally:
        router.kill()
        router.wait()
