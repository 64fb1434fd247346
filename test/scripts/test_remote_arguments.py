# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's scripts: wrong and hostile arguments are refused by name, before anything runs."""
import re
import signal
import subprocess

from conftest import REPO
import pytest

SCRIPTS = {'connect': REPO / 'utils/host/connect_turtlebot.sh',
           'deploy': REPO / 'utils/host/turtlebot_deploy.sh',
           'remote': REPO / 'utils/remote/turtle_remote.sh'}
# Programs that would reach out, or show that a text was run. (Without python3: the scripts put
# /usr/bin first where that is another than the system's.)
WATCHED = ('ssh', 'scp', 'sftp', 'tar', 'roslaunch', 'rospack', 'hostname', 'reboot', 'touch', 'id',
           'ip', 'nc')
RIGHT = {'connect': ['turtle', '192.0.2.7', 'bot1'], 'deploy': ['turtle@192.0.2.7'],
         'remote': ['192.0.2.1', 'bot1']}
NAMES = ['bot1; reboot', '../x', '$(id)', '`id`', 'my bot', '-oProxyCommand=touch hacked', '1bot',
         'bot1\nreboot', 'bot1|touch hacked', 'bot1&', 'bot/1', "bot'1", 'bot"1', 'bot*', 'böt', '',
         '/bot1', '~bot', 'x' * 33, 'bot1\n', '\x1b[2Jx', 'x' * 100000,
         'bot1:=2', '--', '-', 'mux', 'robot_controller']
ADDRESSES = ['300.1.1.1', '1.2.3', '1.2.3.4.5', 'robot', 'fe80::1', '1.2.3.4; touch hacked',
             '$(touch hacked)', '`touch hacked`', '1.2.3.4\n5', '-oProxyCommand=touch hacked', '',
             '1.2.3.4\n', '\n1.2.3.4', '1.2.3.4\r', '1.2.3.4\t', '08.1.1.300',
             '1.2.3.4 5.6.7.8', '1.2.3.4/24', '0x7f.1.1.1', '--', '1.2.3.4,1.2.3.5']
USERS = ['-oProxyCommand=touch hacked', 'root; touch hacked', '$(touch hacked)', 'a b', '../x',
         'turtle\n', '\x1b[31ma', 'a' * 100000, 'a@b', '', 'a\nb', "a'b", '-l', 'a:b', '`id`',
         'x' * 33]
FOLDERS = ['/etc', '../x', 'a/../b', '..', '.', '-x', 'a b', '$(touch hacked)', 'a;b', '', '~',
           'a//b', 'a/', 'a\n', '.ssh', "a'b", 'a\nb']
PORTS = ['0', '65536', '-1', 'ssh', '22; touch hacked', '1e3', '', '123456', '2 2',
         '22\n', '\n22', '22\t']


def short(text):
    """Return the id of a parameter."""
    return repr(text)[1:30]


@pytest.fixture
def run(tmp_path):
    """Return a function that runs a script where every program that matters is watched."""
    calls = tmp_path / 'calls'
    calls.touch()
    folder = tmp_path / 'bin'
    folder.mkdir()
    for name in WATCHED:
        path = folder / name
        path.write_text('#!/bin/bash\nprintf "%s\\n" "${0##*/} $*" >>"' + str(calls) + '"\n')
        path.chmod(0o755)

    def runner(script, *arguments, **environment):
        done = subprocess.run(
            [str(SCRIPTS[script])] + list(arguments), cwd=str(tmp_path), timeout=300,
            env=dict({'PATH': '{}:/usr/bin:/bin'.format(folder), 'HOME': str(tmp_path)},
                     **environment),
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            universal_newlines=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        return done.returncode, done.stdout
    runner.calls = lambda: calls.read_text().splitlines()
    runner.folder = tmp_path
    return runner


def is_refused(run, script, arguments, said=None):
    """Assert that a command line is refused, with one message, and that nothing was run."""
    status, output = run(script, *arguments)
    assert status == 2, output
    assert output.startswith('mhri: ') and output.endswith('(--help lists every option)\n')
    assert output[:-1].isprintable() and len(output) <= 600, 'safe for a terminal, and short'
    if said is not None:
        assert said in output
    assert run.calls() == []
    assert sorted(path.name for path in run.folder.iterdir()) == ['bin', 'calls']


def with_one(script, index, text):
    """Return the right arguments of a script but for one."""
    arguments = list(RIGHT[script])
    arguments[index] = text
    return arguments


@pytest.mark.parametrize('name', NAMES, ids=short)
@pytest.mark.parametrize('script, index', [('connect', 2), ('remote', 1)])
def test_wrong_names_are_refused(run, script, index, name):
    is_refused(run, script, with_one(script, index, name))


@pytest.mark.parametrize('address', ADDRESSES, ids=short)
def test_wrong_addresses_are_refused(run, address):
    is_refused(run, 'connect', with_one('connect', 1, address))
    is_refused(run, 'remote', with_one('remote', 0, address))
    is_refused(run, 'deploy', ['turtle@' + address])
    is_refused(run, 'connect', RIGHT['connect'] + ['--host-ip', address])
    is_refused(run, 'remote', RIGHT['remote'] + ['--ip', address])
    is_refused(run, 'connect', RIGHT['connect'] + ['--ip', address])


@pytest.mark.parametrize('address, right', [
    ('08.1.1.1', '8.1.1.1'), ('010.1.1.1', '10.1.1.1'), ('192.168.000.007', '192.168.0.7'),
    ('0010.0.00.1', '10.0.0.1'), ('192.168.0.0103', '192.168.0.103')])
def test_addresses_with_leading_zeros_are_refused_with_the_right_ones(run, address, right):
    """To one program 010.1.1.1 is 10.1.1.1, to another it is 8.1.1.1."""
    said = "'{}' has leading zeros, which programs read differently: write {} ".format(
        address, right)
    is_refused(run, 'remote', with_one('remote', 0, address), 'HOST_IP: ' + said)
    is_refused(run, 'remote', RIGHT['remote'] + ['--ip', address], '--ip: ' + said)
    is_refused(run, 'connect', with_one('connect', 1, address), 'IP: ' + said)
    is_refused(run, 'connect', RIGHT['connect'] + ['--host-ip', address], '--host-ip: ' + said)
    is_refused(run, 'connect', RIGHT['connect'] + ['--ip', address], '--ip: ' + said)
    is_refused(run, 'deploy', ['turtle@' + address], 'IP: ' + said)


@pytest.mark.parametrize('user', USERS, ids=short)
def test_wrong_users_are_refused(run, user):
    is_refused(run, 'connect', with_one('connect', 0, user))
    is_refused(run, 'deploy', [user + '@192.0.2.7'])


@pytest.mark.parametrize('folder', FOLDERS, ids=short)
def test_folders_outside_the_home_are_refused(run, folder):
    is_refused(run, 'connect', RIGHT['connect'] + ['--to', folder])
    is_refused(run, 'deploy', RIGHT['deploy'] + ['--to', folder])


@pytest.mark.parametrize('port', PORTS, ids=short)
def test_wrong_ports_are_refused(run, port):
    is_refused(run, 'connect', RIGHT['connect'] + ['--ssh-port', port])
    is_refused(run, 'deploy', RIGHT['deploy'] + ['--ssh-port', port])
    is_refused(run, 'remote', RIGHT['remote'] + ['--port', port])


@pytest.mark.parametrize('text', ['$(touch hacked)', 'a b', 'x;touch hacked', '', '-x', '`id`',
                                  "a'b", 'a\nb', 'a*', 'a&b', 'a|b', 'a>b', 'a\\b', 'a"b', 'a\n',
                                  'burger\n', '\x1b[2Ja', '\x1b]0;a\x07', 'x' * 100000,
                                  '0.' * 50000, '\x9b2J', '\u202ea'], ids=short)
@pytest.mark.parametrize('option', ['--type', '--model', '--launch', '--setup', '--ip', '--port'])
def test_nothing_strange_is_passed_on_to_the_robot(run, option, text):
    is_refused(run, 'connect', RIGHT['connect'] + [option, text])
    is_refused(run, 'remote', RIGHT['remote'] + [option, text])


@pytest.mark.parametrize('script', sorted(SCRIPTS))
@pytest.mark.parametrize('text', ['\x1b[2J', '-\x1b[2J', '--\x1b]0;hacked\x07',
                                  '--' + 'x' * 100000], ids=short)
def test_what_is_no_option_is_shown_safely(run, script, text):
    is_refused(run, script, RIGHT[script] + [text])


@pytest.mark.parametrize('script, arguments, said', [
    ('connect', [], 'connect_turtlebot.sh USER IP NAME'),
    ('connect', ['turtle', '192.0.2.7'], 'connect_turtlebot.sh USER IP NAME'),
    ('connect', RIGHT['connect'] + ['more'], 'connect_turtlebot.sh USER IP NAME'),
    ('connect', RIGHT['connect'] + ['--frobnicate'], 'there is no option --frobnicate'),
    ('connect', RIGHT['connect'] + ['--type'], '--type needs a value'),
    ('connect', RIGHT['connect'] + ['--host-ip', '--no-guard'], '--host-ip needs a value'),
    ('deploy', [], 'turtlebot_deploy.sh USER@IP'),
    ('deploy', ['192.0.2.7'], 'turtlebot_deploy.sh USER@IP'),
    ('deploy', ['@192.0.2.7'], "USER: ''"),
    ('deploy', ['turtle@'], "IP: ''"),
    ('deploy', ['turtle@192.0.2.7', 'turtle@192.0.2.8'], 'turtlebot_deploy.sh USER@IP'),
    ('deploy', RIGHT['deploy'] + ['--frobnicate'], 'there is no option --frobnicate'),
    ('remote', [], 'turtle_remote.sh HOST_IP NAME'),
    ('remote', ['192.0.2.1'], 'turtle_remote.sh HOST_IP NAME'),
    ('remote', RIGHT['remote'] + ['more'], 'turtle_remote.sh HOST_IP NAME'),
    ('remote', RIGHT['remote'] + ['-x'], 'there is no option -x'),
    ('remote', RIGHT['remote'] + ['--type', 'generic'], '--launch'),
    ('remote', RIGHT['remote'] + ['--type', 'turtlebot2', '--launch', 'a/b.launch'], '--launch'),
    ('remote', RIGHT['remote'] + ['--type', 'turtlebot2', '--model', 'burger'], '--model'),
    ('remote', RIGHT['remote'] + ['--type', 'turtlebot3_burger', '--model', 'waffle'], 'burger'),
    ('remote', RIGHT['remote'] + ['--model', 'tank'], "'tank' is none of burger, waffle"),
    ('remote', RIGHT['remote'] + ['--setup', '/nowhere/setup.bash'], "'/nowhere/setup.bash'"),
])
def test_wrong_command_lines_say_what_is_wrong(run, script, arguments, said):
    is_refused(run, script, arguments, said)


@pytest.mark.parametrize('arguments, said', [
    (['--port', '99999'], "--port: there is no port '99999'"),
    (['--port', '0'], "--port: there is no port '0'"),
    (['--type', 'Burger'], "--type: 'Burger' is not a robot type such as turtlebot2"),
    (['--type', 'x' * 33], 'is not a robot type'),
    (['--type', 'crawler'], "--type crawler: name the robot's own launch file with --launch"),
    (['--type', 'turtlebot2', '--launch', 'a/b.launch'], '--launch is for other robots than'),
    (['--type', 'turtlebot2', '--model', 'burger'], '--model goes with --type turtlebot3'),
    (['--type', 'turtlebot3_burger', '--model', 'waffle'], 'does not go with'),
    (['--model', 'tank'], "--model: 'tank' is none of burger, waffle, waffle_pi"),
    (['--model', 'burger', '--launch', 'a/b.launch'], '--model goes with --type turtlebot3'),
    (['--launch', 'a b.launch'], "--launch: 'a b.launch' is neither a path nor"),
    (['--ip', 'here'], "--ip: 'here' is not an IPv4 address such as 192.168.0.7"),
    (['--back-after', '0'], "--back-after: '0' is no whole number of seconds from 1 to 3600"),
    (['--back-after', '010'], "--back-after: '010' is no whole number"),
    (['--back-after', '3601'], "--back-after: '3601' is no whole number"),
    (['--brake', '--no-guard'], 'leave out --no-guard'),
    (['--no-guard', '--back-after', '10'], 'leave out --no-guard'),
    (['--listen', '0.0.0.0:7447'], '--listen, --router, --keys and --keep-mb go with --link'),
    (['--keep-mb', '700'], '--listen, --router, --keys and --keep-mb go with --link'),
    (['--keys', 'off'], '--listen, --router, --keys and --keep-mb go with --link'),
    (['--router', 'somewhere'], "--router: 'somewhere' is not an endpoint such as"),
    (['--listen', 'http/0.0.0.0:7447'], "--listen: 'http/0.0.0.0:7447' is not an endpoint"),
])
def test_what_the_robot_would_refuse_is_refused_before_the_login(run, arguments, said):
    is_refused(run, 'connect', RIGHT['connect'] + arguments, said)
    assert (run('connect', *RIGHT['connect'], *arguments)
            == run('remote', *RIGHT['remote'], *arguments)), 'in the same words'


@pytest.mark.parametrize('arguments, said', [
    (['--link', '--no-guard'], 'a linked robot is driven through its guard alone'),
    (['--link', '--ip', '192.168.0.7'], '--ip does not go with --link'),
    (['--link', '--keys', '/tmp/keys'], "--keys: '/tmp/keys' is not off"),
    (['--link', '--keep-mb', '5'], "--keep-mb: '5' is not a number of MB from 10 to"),
    (['--link', '--listen', '0.0.0.0:1', '--router', '192.0.2.1:1'], 'in place of --listen'),
])
def test_what_does_not_go_with_a_link(run, arguments, said):
    is_refused(run, 'connect', RIGHT['connect'] + arguments, said)
    is_refused(run, 'remote', ['bot1'] + arguments, said)


def test_a_linked_robot_needs_no_address_of_the_host(run):
    is_refused(run, 'remote', RIGHT['remote'] + ['--link'], "give the robot's name alone")


@pytest.mark.parametrize('script', sorted(SCRIPTS))
@pytest.mark.parametrize('flag', ['-h', '--help'])
def test_help_is_the_manual(run, script, flag):
    status, output = run(script, flag)
    assert status == 0 and run.calls() == []
    options = set(re.findall(r'(--[a-z][a-z-]+)(?= \||\))', SCRIPTS[script].read_text()))
    assert len(options) >= 3
    assert [option for option in options if option not in output] == []
    assert 'Exit status: ' in output and 'Example' in output
    assert max(map(len, output.splitlines())) <= 100


def test_what_goes_to_ssh(run):
    status, output = run('connect', *RIGHT['connect'], '--host-ip', '192.0.2.1', '--ssh-port',
                         '222', '--type', 'crawler', '--launch', 'a/b.launch', '--no-camera',
                         '--brake', '--back-after', '10')
    assert status == 0, output
    call = '\n'.join(run.calls())
    assert call.startswith('ssh -tt ') and ' -p 222 -l turtle -- 192.0.2.7 exec sh -c ' in call
    assert call.endswith(' turtle@192.0.2.7 mhri 192.0.2.1 bot1 --type crawler '
                         '--launch a/b.launch --no-camera --brake --back-after 10')
    assert 'StrictHostKeyChecking' not in call and 'UserKnownHostsFile' not in call


@pytest.mark.parametrize('addresses, said', [
    ('', 'this computer has no IPv4 address'),
    ('198.51.100.2 203.0.113.9', 'which of the addresses of this computer'),
])
def test_option_that_is_named_is_the_scripts_own(run, addresses, said):
    """The robot's --ip is another thing: with it, the question would come again."""
    (run.folder / 'bin' / 'hostname').write_text('#!/bin/sh\necho "{} "\n'.format(addresses))
    status, output = run('connect', *RIGHT['connect'])
    assert status == 1 and said in output
    assert 'with --host-ip ADDR' in output and ' --ip ' not in output
    assert not [call for call in run.calls() if call.startswith('ssh')]


def test_host_keys_are_left_to_ssh():
    """No script tells ssh to trust what it does not know."""
    for script in SCRIPTS.values():
        assert not re.search('StrictHostKey|KnownHosts|keyscan', script.read_text())
