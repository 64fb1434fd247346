# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_run.sh: every wrong argument is refused by name, before anything is started."""
import re

import pytest


@pytest.mark.parametrize('arguments, said', [
    (['--frobnicate'], '--frobnicate'),
    (['-x'], '-x'),
    (['--sim'], '--sim needs a value'),
    (['--sim', ''], '--sim needs a value'),
    (['--sim', '--demo'], '--sim needs a value'),
    (['--sim', '0'], "'0' is not a number of robots from 1 to 12"),
    (['--sim', '13'], "'13'"),
    (['--sim', '-1'], '--sim needs a value'),
    (['--sim', '3.5'], "'3.5'"),
    (['--sim', '99999999999999999999'], "'99999999999999999999'"),
    (['--sim', '3; touch hacked'], "'3; touch hacked'"),
    (['--sim', '$(touch hacked)'], "'$(touch hacked)'"),
    (['--sim', '3', 'turtlebot2;touch hacked'], 'is not a list of robot types'),
    (['--sim', '3', '--sim-types', '$(touch hacked)'], 'is not a list of robot types'),
    (['--sim-types', 'turtlebot2'], 'give --sim as well'),
    (['--ip'], '--ip needs a value'),
    (['--ip', '300.1.1.1'], "'300.1.1.1' is not an IPv4 address"),
    (['--ip', '1.2.3'], "'1.2.3'"),
    (['--ip', '1.2.3.4.5'], "'1.2.3.4.5'"),
    (['--ip', '010.1.1.1'], 'has leading zeros, which not every program reads alike: write 10.1'),
    (['--ip', 'fe80::1'], "'fe80::1'"),
    (['--ip', '1.2.3.4\n5'], 'is not an IPv4 address'),
    (['--ip', '`touch hacked`'], "'`touch hacked`'"),
    (['--master'], '--master needs a value'),
    (['--master', 'localhost'], "'localhost' is not an address"),
    (['--master', 'http://host'], "'http://host'"),
    (['--master', 'http://host:99999'], 'there is no port 99999'),
    (['--master', 'http://host:11311/$(touch hacked)'], 'is not an address'),
    (['--master', 'https://host:11311'], "'https://host:11311'"),
    (['--demo', '--ip', '127.0.0.1'], 'leave out --ip and --master'),
    (['--demo', '--master', 'http://127.0.0.1:11311'], 'leave out --ip and --master'),
    (['--screenshot', 'x.png'], '--screenshot goes with --demo'),
    (['--demo', '--screenshot', '/nowhere/at/all.png'], 'there is no folder /nowhere/at'),
    (['--demo', '--screenshot', '/tmp'], '/tmp is a folder'),
    (['start'], "'start' is neither an option nor ARG:=VALUE"),
    (['3'], "'3'"),
    ([''], "''"),
    (['X Y:=3'], "'X Y:=3' is not ARG:=VALUE"),
    ([':=3'], "':=3' is not ARG:=VALUE"),
])
def test_wrong_arguments_are_refused(checkout, arguments, said):
    status, output = checkout.run(*arguments)
    assert status == 2, output
    assert said in output and '--help' in output
    assert len(output.strip().splitlines()) <= 2, 'one line that says what is wrong'
    assert checkout.calls == []
    assert not (checkout.root / 'build').exists()
    assert not list(checkout.root.parent.rglob('hacked'))


@pytest.mark.parametrize('script', ['mhri_run.sh', 'mrhi_run.sh'])
@pytest.mark.parametrize('flag', ['-h', '--help'])
def test_help_is_the_manual(checkout, script, flag):
    path = checkout.script.with_name(script)
    status, output = checkout.run(flag, script=path)
    assert status == 0 and checkout.calls == []
    source = checkout.script.read_text()
    options = set(re.findall(r'^ +(--[a-z-]+)\)', source, re.M))
    assert len(options) >= 6
    assert [option for option in options if option not in output] == []


@pytest.mark.parametrize('arguments, launched', [
    ([], ['sim:=0']),
    (['--sim', '3'], ['sim:=3']),
    (['--sim', '12'], ['sim:=12']),
    (['--sim', '2', 'turtlebot2 turtlebot3_burger'],
     ['sim:=2', 'sim_types:=turtlebot2 turtlebot3_burger']),
    (['--sim', '2', '--sim-types', 'turtlebot2'], ['sim:=2', 'sim_types:=turtlebot2']),
    (['--sim', '2', 'gui:=none'], ['sim:=2', 'gui:=none']),
    (['robots:=bot1 bot2', 'gui:=standalone'], ['sim:=0', 'robots:=bot1 bot2', 'gui:=standalone']),
])
def test_right_arguments_reach_the_launch_file(checkout, arguments, launched):
    status, output = checkout.run('--master', 'http://127.0.0.1:1', *arguments)
    assert status == 0, output
    assert checkout.called('roslaunch') == ['roslaunch mhri mhri.launch ' + ' '.join(launched)]
