# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtle_address.py: which address is taken, and what is said where none is."""
import importlib.util
import subprocess
import sys

from support.checkout import REPO
import pytest

PATH = REPO / 'utils' / 'remote' / 'turtle_address.py'
SPEC = importlib.util.spec_from_file_location('turtle_address', str(PATH))
turtle_address = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(turtle_address)


@pytest.mark.parametrize('target, own, lengths, out, chosen', [
    ('192.168.0.103', ['192.168.0.7'], {}, None, '192.168.0.7'),
    ('192.168.0.103', ['10.0.0.5', '192.168.0.7'], {}, None, '192.168.0.7'),
    ('192.168.0.103', ['192.168.0.7', '10.0.0.5'], {}, '10.0.0.5', '192.168.0.7'),
    ('10.1.2.3', ['10.200.0.5', '172.17.0.1'], {'10.200.0.5': 8}, None, '10.200.0.5'),
    ('192.168.0.103', ['192.168.0.7', '192.168.0.8'], {}, '192.168.0.8', '192.168.0.8'),
    ('192.168.0.103', ['192.168.0.7', '192.168.0.200'],
     {'192.168.0.7': 26, '192.168.0.200': 26}, None, None),
    ('192.168.0.70', ['192.168.0.7', '192.168.0.80'],
     {'192.168.0.7': 26, '192.168.0.80': 26}, None, '192.168.0.80'),
    ('203.0.113.1', ['192.168.0.7', '10.0.0.5'], {}, '10.0.0.5', '10.0.0.5'),
    ('203.0.113.1', ['192.168.0.7'], {}, None, '192.168.0.7'),
    ('203.0.113.1', ['192.168.0.7', '10.0.0.5'], {}, '172.17.0.1', None),
    ('192.168.0.7', ['10.0.0.5', '192.168.0.7'], {}, None, '192.168.0.7'),
    ('192.168.0.103', ['192.168.0.7'], {'192.168.0.7': 32}, None, '192.168.0.7'),
    ('192.168.0.103', [], {}, None, None),
    ('127.0.0.1', ['192.168.0.7', '10.0.0.5', '172.17.0.1'], {}, '127.0.0.1', '127.0.0.1'),
    ('127.0.0.1', ['192.168.0.7'], {}, '127.0.0.1', '127.0.0.1'),
    ('127.0.0.1', [], {}, '127.0.0.1', '127.0.0.1'),
])
def test_address_on_the_network_of_the_other(target, own, lengths, out, chosen):
    if chosen is None:
        with pytest.raises(turtle_address.Problem, match='with --host-ip ADDR'):
            turtle_address.choose_address(target, own, lengths, out, '--host-ip')
    else:
        assert turtle_address.choose_address(target, own, lengths, out, '--ip') == chosen


def test_no_address_is_one_line_and_status_1():
    done = subprocess.run([sys.executable, str(PATH), '--ip', '192.168.0.103'],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    assert done.returncode == 1 and done.stdout == ''
    assert done.stderr.startswith('mhri: ')
    assert done.stderr.count('\n') == 1


@pytest.mark.parametrize('arguments, said', [
    (['--ip', '', '1.2.3.4'], "'' is not an IPv4 address"),
    (['--ip', '1.2.3.4', ''], "'' is not an IPv4 address"),
    (['--ip', '1.2.3.4\n', '1.2.3.4'], 'is not an IPv4 address'),
    (['--ip', '1.2.3.4 x', '1.2.3.4'], 'is not an IPv4 address'),
    (['--ip', '\x1b[2J', '1.2.3.4'], 'is not an IPv4 address'),
    (['--ip', '1.' * 50000, '1.2.3.4'], 'is not an IPv4 address'),
    (['--ip'], 'usage: '), ([], 'usage: ')])
def test_what_is_no_address_is_one_line_and_status_1(arguments, said):
    done = subprocess.run([sys.executable, str(PATH)] + arguments, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True)
    assert done.returncode == 1 and done.stdout == '' and said in done.stderr
    assert done.stderr.startswith('mhri: ') and done.stderr[:-1].isprintable()
    assert len(done.stderr) <= 300
