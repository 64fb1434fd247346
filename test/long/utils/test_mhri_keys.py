# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_keys.sh for real: the keys it makes let each other in, and nobody else."""
import os
import re
import shutil
import ssl
import subprocess

from support.checkout import REPO
import pytest
from test_remote_deploy import SSH

from mhri.link.keys import read_lists

SCRIPT = str(REPO / 'utils' / 'host' / 'mhri_keys.sh')
AUTHORITY, PLACE = '.config/mhri/authority', '.config/mhri/keys'
FILES = {'authority.pem', 'own.key', 'own.pem', 'peers', 'withdrawn', 'withdrawn.pem'}
# Another time than now, for what the script asks about it. The real clock goes on.
DATE = '#!/bin/bash\nexec /bin/date "${{@/#now/now {}}}"\n'


class Operator:
    """A home folder, and programs that stand before the real ones."""

    def __init__(self, folder):
        self.home, self._bin = folder, folder / 'bin'
        self._bin.mkdir()
        self.authority, self.place = folder / AUTHORITY, folder / PLACE

    def program(self, name, text):
        path = self._bin / name
        path.write_text(text)
        path.chmod(0o755)

    def at(self, shift):
        """Let the script take the time for another one, such as ``- 10 days``; None: it is now."""
        if shift is None:
            (self._bin / 'date').unlink()
        else:
            self.program('date', DATE.format(shift))

    def start(self, *words):
        return subprocess.Popen(
            [SCRIPT, *words], cwd=str(self.home), stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
            env={'PATH': '{}:/usr/bin:/bin'.format(self._bin), 'HOME': str(self.home)})

    def run(self, *words):
        """Return (exit status, output)."""
        process = self.start(*words)
        output = process.communicate(timeout=120)[0]
        return process.returncode, output

    def does(self, *words):
        """Return the output of what has to go well."""
        status, output = self.run(*words)
        assert status == 0, output
        return output

    def key(self, name):
        return self.authority / 'keys' / name

    def peers(self):
        """Return the names that have a key, once for each certificate."""
        return [line.split()[0] for line in (self.authority / 'peers').read_text().splitlines()]


@pytest.fixture
def operator(tmp_path):
    return Operator(tmp_path)


@pytest.fixture(scope='module')
def made(tmp_path_factory):
    """Return a home with an authority, a computer and a robot."""
    operator = Operator(tmp_path_factory.mktemp('made'))
    operator.does('new')
    operator.does('host', 'lab')
    operator.does('robot', 'bot1', '--ip', '192.0.2.7')
    return operator.home


@pytest.fixture
def lab(made, operator):
    """Return an operator who has a copy of it."""
    shutil.copytree(str(made / '.config'), str(operator.home / '.config'))
    return operator


def context(side, key, lists):
    """Return the TLS of one side: who has a key, who asks the other for one."""
    made = ssl.SSLContext(side)
    made.verify_mode = ssl.CERT_REQUIRED
    made.load_verify_locations(str(lists / 'authority.pem'))
    made.load_verify_locations(str(lists / 'withdrawn.pem'))
    made.verify_flags |= ssl.VERIFY_CRL_CHECK_LEAF
    if key:
        made.load_cert_chain(str(key / 'own.pem'), str(key / 'own.key'))
    return made


def shake_hands(server_key, client_key, server_lists, client_lists, name='bot1'):
    """Return the common name that the server saw.

    :raises ssl.SSLError: one of them refused
    """
    one, other = ssl.MemoryBIO(), ssl.MemoryBIO()
    server = context(ssl.PROTOCOL_TLS_SERVER, server_key, server_lists).wrap_bio(
        one, other, server_side=True)
    client = context(ssl.PROTOCOL_TLS_CLIENT, client_key, client_lists).wrap_bio(
        other, one, server_hostname=name)
    for _ in range(20):
        for end in (client, server):
            try:
                end.do_handshake()
            except ssl.SSLWantReadError:
                pass
    server.write(b'come in')
    assert client.read(100) == b'come in'
    return dict(part[0] for part in server.getpeercert()['subject'])['commonName']


def meet(operator, server='bot1', client='lab', **options):
    """Return the common name that a server of the operator's saw of a client."""
    return shake_hands(operator.key(server), client and operator.key(client), operator.authority,
                       operator.authority, **options)


@pytest.mark.parametrize('name', ['bot1', '192.0.2.7'])
def test_right_keys_let_each_other_in(lab, name):
    assert meet(lab, name=name) == 'host:lab'


def test_robot_may_ask_the_host(lab):
    assert meet(lab, server='lab', client='bot1', name='lab') == 'robot:bot1'


def test_another_name_is_refused(lab):
    with pytest.raises(ssl.SSLError, match='[Hh]ostname mismatch'):
        meet(lab, name='bot2')


def test_no_key_is_refused(lab):
    with pytest.raises(ssl.SSLError, match='PEER_DID_NOT_RETURN|peer did not return'):
        meet(lab, client=None)


def test_key_of_another_authority_is_refused_by_both(lab):
    other = ('--folder', str(lab.home / 'other'))
    lab.does('new', *other)
    lab.does('host', 'lab', *other)
    there = lab.home / 'other'
    for lists in (lab.authority, there):
        with pytest.raises(ssl.SSLError, match='CERTIFICATE_VERIFY_FAILED'):
            shake_hands(lab.key('bot1'), there / 'keys' / 'lab', lists, lists)


@pytest.mark.parametrize('shift, refusal, said', [
    ('- 400 days', 'expired', 'renew'), ('+ 10 days', 'not yet valid', 'clock')])
def test_key_of_another_time_is_refused(operator, shift, refusal, said):
    operator.at('- 500 days')
    operator.does('new')
    operator.at(None)
    operator.does('robot', 'bot1')
    operator.at(shift)
    operator.does('host', 'lab')
    operator.at(None)
    with pytest.raises(ssl.SSLError, match=refusal):
        meet(operator)
    status, output = operator.run('check')
    assert status == 1 and said in output
    status, output = operator.run('put', 'lab')
    assert status == 1 and said in output and not operator.place.exists()
    operator.does('renew', 'lab')
    assert meet(operator) == 'host:lab'


def test_withdrawn_key_is_refused_and_its_name_is_not_used_again(lab):
    lab.does('renew', 'lab')
    stolen = lab.home / 'stolen'
    shutil.copytree(str(lab.key('lab')), str(stolen))
    output = lab.does('withdraw', 'lab')
    assert ': bot1\n' in output
    with pytest.raises(ssl.SSLError, match='revoked'):
        shake_hands(lab.key('bot1'), stolen, lab.authority, lab.authority)
    withdrawn = (lab.authority / 'withdrawn').read_text().splitlines()
    assert [line.split()[1] for line in withdrawn] == ['host:lab'] * 2
    lab.does('host', 'lab')
    assert meet(lab) == 'host:lab.2'
    assert lab.peers() == ['host:lab.2', 'robot:bot1']
    lab.does('withdraw', 'lab')
    lab.does('host', 'lab', '--watch')
    assert meet(lab) == 'watch:lab.3'
    assert lab.does('list').count('withdrawn, serial number') == 3


def test_roles_are_in_the_common_name(lab):
    lab.does('host', 'gallery', '--watch')
    lab.does('robot', 'bot2', '--watch')
    assert lab.peers() == ['host:lab', 'robot:bot1', 'watch:gallery', 'watched:bot2']


def test_others_know_when_each_certificate_runs_out(lab):
    """Of one that was made anew there are two, and the old one is good until its own end."""
    lab.does('renew', 'lab', '--days', '2')
    lab.does('renew', 'bot1', '--days', '500')
    assert lab.peers() == ['host:lab', 'host:lab', 'robot:bot1', 'robot:bot1']
    keys = read_lists('host:lab', (lab.authority / 'peers').read_text(), '', '')
    for name, owner in (('lab', 'host:lab'), ('bot1', 'robot:bot1')):
        said = subprocess.run(
            ['openssl', 'x509', '-in', str(lab.key(name) / 'own.pem'), '-noout', '-enddate'],
            stdout=subprocess.PIPE, check=True, universal_newlines=True).stdout
        end_s = ssl.cert_time_to_seconds(said.strip().partition('=')[2])
        assert keys.ended(end_s - 1.0, end_s) == {owner}


def test_renewed_key_keeps_name_and_address(lab):
    before = (lab.key('bot1') / 'own.key').read_bytes()
    lab.does('renew', 'bot1', '--days', '20')
    assert (lab.key('bot1') / 'own.key').read_bytes() != before
    assert meet(lab, name='192.0.2.7') == 'host:lab'
    assert 'renew' in lab.does('check')


def test_nobody_else_may_read_it(lab):
    lab.does('put', 'lab')
    for top in (lab.authority, lab.place):
        for path in [top, *top.rglob('*')]:
            assert path.stat().st_mode & 0o077 == 0, path
    lab.authority.chmod(0o750)
    status, output = lab.run('list')
    assert status == 1 and 'chmod 700' in output


def test_put_in_place_on_this_computer(lab):
    lab.does('put', 'lab')
    assert {path.name for path in lab.place.iterdir()} == FILES
    assert shake_hands(lab.key('bot1'), lab.place, lab.authority, lab.place) == 'host:lab'
    assert str(lab.place) in lab.does('check')
    lab.does('withdraw', 'bot1')
    status, output = lab.run('check')
    assert status == 1 and 'withdrawn' in output
    lab.does('put', 'lab')
    lab.does('check')


def stand_for_robot(operator):
    """Return the home of a robot that ssh leads to; its programs are in ``tools``."""
    home, tools = operator.home / 'robot', operator.home / 'tools'
    home.mkdir()
    tools.mkdir()
    operator.program('ssh', SSH.format(home=home, tools=tools))
    return home


@pytest.fixture
def robot(lab):
    return stand_for_robot(lab)


def test_put_in_place_on_a_robot(lab, robot):
    for _ in range(2):
        output = lab.does('put', 'bot1', 'turtle@192.0.2.7')
        assert '192.0.2.7, in ~/mhri/keys' in output and 'clock' not in output
    there = robot / 'mhri' / 'keys'
    assert {path.name for path in there.iterdir()} == FILES
    assert all(path.stat().st_mode & 0o077 == 0 for path in [there, *there.iterdir()])
    assert shake_hands(there, lab.key('lab'), there, lab.authority) == 'host:lab'


def stands_before(robot, name, text):
    path = robot.parent / 'tools' / name
    path.write_text('#!/bin/sh\n' + text)
    path.chmod(0o755)


def test_clock_of_the_robot_that_is_off_is_told(lab, robot):
    stands_before(robot, 'date', 'exec /bin/date -d "3 days ago" "$@"\n')
    output = lab.does('put', 'bot1', 'turtle@192.0.2.7')
    assert 'clock' in output and '192.0.2.7' in output and '43' in output


@pytest.mark.parametrize('tool, text', [
    ('mv', 'echo no >&2; exit 1\n'), ('cat', 'echo something else\n')])
def test_key_that_did_not_arrive_is_told(lab, robot, tool, text):
    stands_before(robot, tool, text)
    status, output = lab.run('put', 'bot1', 'turtle@192.0.2.7')
    assert status == 1 and '192.0.2.7' in output


def test_two_at_once(lab):
    processes = [lab.start('robot', 'bot{}'.format(number)) for number in range(2, 6)]
    assert [process.communicate(timeout=120)[0] and process.returncode
            for process in processes] == [0] * 4
    assert len(lab.peers()) == 6


@pytest.mark.parametrize('damage, said', [
    (lambda key: (key / 'own.key').chmod(0o644), 'read'),
    (lambda key: (key / 'own.key').write_text('x'), 'together'),
    (lambda key: (key / 'own.key').unlink(), 'own.key')])
def test_damage_is_told(lab, damage, said):
    damage(lab.key('bot1'))
    status, output = lab.run('check')
    assert status == 1 and said in output
    assert 'until' in next(line for line in output.splitlines() if line.startswith('lab'))


def test_place_of_another_authority_is_told(lab):
    lab.does('put', 'lab')
    os.rename(str(lab.authority), str(lab.home / 'old'))
    lab.does('new')
    status, output = lab.run('check')
    assert status == 1 and 'another authority' in output


@pytest.mark.parametrize('words, said', [
    (('list',), 'authority'), (('robot', 'bot1'), 'mhri_keys.sh new')])
def test_without_an_authority(operator, words, said):
    status, output = operator.run(*words)
    assert status == 1 and said in output and not operator.authority.exists()


@pytest.mark.parametrize('words, said', [
    (('new',), 'authority'), (('robot', 'lab'), 'lab'), (('put', 'bot9'), 'bot1 lab'),
    (('renew', 'bot9'), 'bot9'), (('withdraw', 'bot9'), 'bot9')])
def test_what_cannot_be_done_says_why(lab, words, said):
    before = sorted(path.name for path in lab.authority.rglob('*'))
    status, output = lab.run(*words)
    assert status == 1 and said in output
    assert sorted(path.name for path in lab.authority.rglob('*')) == before


@pytest.mark.parametrize('words, said', [
    ((), ''), (('fly',), "'fly'"), (('new', 'x'), 'new'), (('host',), 'host NAME'),
    (('put',), 'put NAME'), (('--all',), '--all'), (('robot', '../x'), "'../x'"),
    (('robot', '$(touch hacked)'), 'touch'), (('robot', 'a\nb'), 'robot'),
    (('robot', 'mux'), 'mux'), (('robot', 'b', '--ip', '1.2.3'), "'1.2.3'"),
    (('robot', 'b', '--days', '0'), '--days'), (('robot', 'b', '--days', '3651'), '--days'),
    (('list', '--days', '3'), 'list'), (('renew', 'b', '--watch'), '--watch'),
    (('put', 'b', 'robot'), "'robot'"), (('put', 'b', '-l@1.2.3.4'), '-l@1.2.3.4'),
    (('put', 'b', 'a;b@1.2.3.4'), 'USER'), (('put', 'b', 'a@1.2.3.4', '--to', '../x'), '--to'),
    (('put', 'b', '--to', 'x'), 'put NAME'),
    (('put', 'b', 'a@1.2.3.4', '--ssh-port', '0'), '--ssh-port')])
def test_wrong_words_are_refused_by_name(operator, words, said):
    status, output = operator.run(*words)
    assert status == 2 and said in output and output.startswith('mhri: ')
    assert output[:-1].isprintable() and '--help' in output
    assert [path.name for path in operator.home.iterdir()] == ['bin']


def test_help_is_the_manual(operator):
    output = operator.does('--help')
    for word in ('new', 'host', 'robot', 'put', 'list', 'check', 'renew', 'withdraw', '--folder'):
        assert word in output


def test_guide_is_right(operator):
    """Its commands one after another, with a folder for the robot."""
    home = stand_for_robot(operator)
    guide = (REPO / 'doc' / 'guide' / 'security.md').read_text(encoding='utf-8')
    chapter = guide.split('## Keys in five minutes')[1].split('\n## ')[0]
    commands = re.findall(r'^    utils/host/mhri_keys.sh (.*)$', chapter, re.MULTILINE)
    assert len(commands) == 9
    for command in commands:
        operator.does(*command.split())
    for folder in (operator.place, home / 'mhri' / 'keys'):
        assert {path.name for path in folder.iterdir()} == FILES
    for name in FILES | {'host:lab', 'robot:bot1.2', '~/.config/mhri/keys', '~/mhri/keys'}:
        assert '`{}`'.format(name) in chapter
