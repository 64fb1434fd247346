# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's scripts: wrong and hostile arguments are refused by name, before anything runs."""
import re
import signal
import subprocess

from support.checkout import REPO
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
# One text of each kind: for a shell, an option, another folder, with a line end, for a terminal, in
# another alphabet, empty, too long.
NAMES = ['bot1; reboot', '$(touch hacked)', '../x', '-oProxyCommand=touch hacked', 'bot1\n',
         '1bot', 'böt', '', 'x' * 33, 'x' * 100000, 'mux']
ADDRESSES = ['300.1.1.1', '1.2.3', 'fe80::1', '$(touch hacked)', '-oProxyCommand=touch hacked', '',
             '1.2.3.4\n', '1.2.3.4 5.6.7.8', '0x7f.1.1.1']
USERS = ['-oProxyCommand=touch hacked', '$(touch hacked)', '../x', 'turtle\n', '\x1b[31ma',
         'a@b', '', "a'b", 'x' * 33]
FOLDERS = ['/etc', 'a/../b', '-x', '$(touch hacked)', '', '~', 'a//b', 'a\n', '.ssh']
PORTS = ['0', '65536', 'ssh', '22; touch hacked', '', '22\n']


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


def is_refused(run, script, arguments, said=''):
    """Assert that a command line is refused by one message with this in it, and nothing ran."""
    status, output = run(script, *arguments)
    assert status == 2, output
    assert output.startswith('mhri: ') and '--help' in output
    assert output[:-1].isprintable() and len(output) <= 600
    assert said in output
    assert run.calls() == []
    assert sorted(path.name for path in run.folder.iterdir()) == ['bin', 'calls']


def with_one(script, index, text):
    """Return the right arguments of a script but for one."""
    arguments = list(RIGHT[script])
    arguments[index] = text
    return arguments


@pytest.mark.parametrize('name', NAMES, ids=short)
def test_wrong_names_are_refused(run, name):
    is_refused(run, 'connect', with_one('connect', 2, name))
    is_refused(run, 'remote', with_one('remote', 1, name))


@pytest.mark.parametrize('address', ADDRESSES, ids=short)
def test_wrong_addresses_are_refused(run, address):
    is_refused(run, 'connect', with_one('connect', 1, address))
    is_refused(run, 'remote', with_one('remote', 0, address))
    is_refused(run, 'deploy', ['turtle@' + address])
    is_refused(run, 'connect', RIGHT['connect'] + ['--host-ip', address])
    is_refused(run, 'remote', RIGHT['remote'] + ['--ip', address])
    is_refused(run, 'connect', RIGHT['connect'] + ['--ip', address])


def test_addresses_with_leading_zeros_are_refused_with_the_right_ones(run):
    """To one program 010.1.1.1 is 10.1.1.1, to another it is 8.1.1.1."""
    address, right = '192.168.000.007', '192.168.0.7'
    is_refused(run, 'remote', with_one('remote', 0, address), right)
    is_refused(run, 'connect', RIGHT['connect'] + ['--host-ip', address], right)
    is_refused(run, 'deploy', ['turtle@' + address], right)


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


@pytest.mark.parametrize('option', ['--type', '--model', '--launch', '--setup', '--ip', '--port'])
def test_nothing_strange_is_passed_on_to_the_robot(run, option):
    for text in ('$(touch hacked)', 'a b', '', '-x', "a'b", 'a\n', '\x1b[2Ja', 'x' * 100000,
                 '\u202ea'):
        is_refused(run, 'connect', RIGHT['connect'] + [option, text])
        is_refused(run, 'remote', RIGHT['remote'] + [option, text])


@pytest.mark.parametrize('script', sorted(SCRIPTS))
@pytest.mark.parametrize('text', ['\x1b[2J', '--' + 'x' * 100000], ids=short)
def test_what_is_no_option_is_shown_safely(run, script, text):
    is_refused(run, script, RIGHT[script] + [text])


@pytest.mark.parametrize('script, arguments, named', [
    ('connect', ['turtle', '192.0.2.7'], 'USER IP NAME'),
    ('connect', RIGHT['connect'] + ['more'], 'USER IP NAME'),
    ('connect', RIGHT['connect'] + ['--frobnicate'], '--frobnicate'),
    ('connect', RIGHT['connect'] + ['--type'], '--type'),
    ('connect', RIGHT['connect'] + ['--host-ip', '--no-guard'], '--host-ip'),
    ('deploy', ['192.0.2.7'], 'USER@IP'),
    ('deploy', ['@192.0.2.7'], 'USER'),
    ('deploy', ['turtle@'], 'IP'),
    ('deploy', ['turtle@192.0.2.7', 'turtle@192.0.2.8'], 'USER@IP'),
    ('deploy', RIGHT['deploy'] + ['--frobnicate'], '--frobnicate'),
    ('remote', ['192.0.2.1'], 'HOST_IP NAME'),
    ('remote', RIGHT['remote'] + ['more'], 'HOST_IP NAME'),
    ('remote', RIGHT['remote'] + ['-x'], '-x'),
    ('remote', RIGHT['remote'] + ['--setup', '/nowhere/setup.bash'], "'/nowhere/setup.bash'"),
    ('remote', RIGHT['remote'] + ['--link'], 'alone'),
])
def test_wrong_command_lines_are_refused_by_name(run, script, arguments, named):
    is_refused(run, script, arguments, named)


@pytest.mark.parametrize('arguments, named', [
    (['--port', '99999'], "'99999'"),
    (['--type', 'Burger'], "'Burger'"),
    (['--type', 'crawler'], '--launch'),
    (['--type', 'turtlebot2', '--launch', 'a/b.launch'], '--launch'),
    (['--type', 'turtlebot2', '--model', 'burger'], '--model'),
    (['--type', 'turtlebot3_burger', '--model', 'waffle'], 'burger'),
    (['--model', 'tank'], 'waffle_pi'),
    (['--model', 'burger', '--launch', 'a/b.launch'], '--model'),
    (['--launch', 'a b.launch'], "'a b.launch'"),
    (['--ip', 'here'], "'here'"),
    (['--back-after', '010'], "'010'"),
    (['--back-after', '3601'], '3600'),
    (['--brake', '--no-guard'], '--no-guard'),
    (['--no-guard', '--back-after', '10'], '--no-guard'),
    (['--keep-mb', '700'], '--link'),
    (['--router', 'somewhere'], "'somewhere'"),
    (['--listen', 'http/0.0.0.0:7447'], "'http/0.0.0.0:7447'"),
    (['--listen', 'quic/0.0.0.0:7447'], "'quic/0.0.0.0:7447'"),
])
def test_what_the_robot_would_refuse_is_refused_before_the_login(run, arguments, named):
    is_refused(run, 'connect', RIGHT['connect'] + arguments, named)
    assert (run('connect', *RIGHT['connect'], *arguments)
            == run('remote', *RIGHT['remote'], *arguments))


@pytest.mark.parametrize('arguments, named', [
    (['--link', '--no-guard'], 'guard'),
    (['--link', '--ip', '192.168.0.7'], '--ip'),
    (['--link', '--keys', '/tmp/keys'], "'/tmp/keys'"),
    (['--link', '--keep-mb', '5'], "'5'"),
    (['--link', '--listen', '0.0.0.0:1', '--router', '192.0.2.1:1'], '--router'),
])
def test_what_does_not_go_with_a_link(run, arguments, named):
    is_refused(run, 'connect', RIGHT['connect'] + arguments, named)
    is_refused(run, 'remote', ['bot1'] + arguments, named)


@pytest.mark.parametrize('script, flag', [
    ('connect', '-h'), ('deploy', '--help'), ('remote', '--help')])
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


@pytest.mark.parametrize('addresses', ['', '198.51.100.2 203.0.113.9'])
def test_option_that_is_named_is_the_scripts_own(run, addresses):
    """The robot's --ip is another thing: with it, the question would come again."""
    (run.folder / 'bin' / 'hostname').write_text('#!/bin/sh\necho "{} "\n'.format(addresses))
    status, output = run('connect', *RIGHT['connect'])
    assert status == 1 and '--host-ip' in output and ' --ip ' not in output
    assert not [call for call in run.calls() if call.startswith('ssh')]


def test_host_keys_are_left_to_ssh():
    """No script tells ssh to trust what it does not know."""
    for script in SCRIPTS.values():
        assert not re.search('StrictHostKey|KnownHosts|keyscan', script.read_text())


@pytest.fixture(scope='module', params=['LANG', 'LC_ALL'])
def german(request, tmp_path_factory):
    """The environment of a computer that speaks German: decimal commas, umlauts from a to z."""
    place = tmp_path_factory.mktemp('locales')
    subprocess.run(['localedef', '-i', 'de_DE', '-f', 'UTF-8', str(place / 'de_DE.UTF-8')],
                   check=True)
    return {'LOCPATH': str(place), request.param: 'de_DE.UTF-8'}


@pytest.mark.parametrize('script, arguments', [
    ('remote', ['192.0.2.1', 'b\u00f6t']), ('connect', ['t\u00fcrtle', '192.0.2.7', 'bot1']),
    ('remote', ['192.0.2.1', 'bot\u00b2'])])
def test_letters_and_digits_are_the_same_in_every_language(run, german, script, arguments):
    status, output = run(script, *arguments, **german)
    assert status == 2 and '--help' in output and run.calls() == []


def test_numbers_and_order_are_the_same_in_every_language(german):
    env = dict(german, PATH='/usr/bin:/bin')
    assert subprocess.check_output(['seq', '0.5', '1'], env=env) == b'0,5\n', 'it is in force'
    done = subprocess.run(
        ['bash', '-c', '. "$0"; printf "%.1f " 1.5; seq 0.5 1; echo 1.5 | awk "{print 2 * \\$1}"; '
         'printf "b\\nB\\na\\n" | sort; ls /nowhere 2>&1; echo \u00e4 | tr -d "\\n" | wc -m',
         str(REPO / 'utils/remote/turtle_arguments.sh')], env=env,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    *numbers, failed, characters = done.stdout.splitlines()
    assert numbers == ['1.5 0.5', '3', 'B', 'a', 'b'] and 'No such file' in failed
    assert characters == '1', 'an umlaut is still one character'
