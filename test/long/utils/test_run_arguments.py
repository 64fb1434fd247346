# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_run.sh: every wrong argument is refused by name, before anything is started."""
import re

import pytest


@pytest.mark.parametrize('arguments, named', [
    (['--frobnicate'], '--frobnicate'),
    (['--sim'], '--sim'),
    (['--sim', '0'], "'0'"),
    (['--sim', '$(touch hacked)'], "'$(touch hacked)'"),
    (['--sim', '3', 'turtlebot2;touch hacked'], '--sim'),
    (['--sim', '3', '--sim-types', '$(touch hacked)'], '$(touch hacked)'),
    (['--sim-types', 'turtlebot2'], '--sim'),
    (['--link', 'bot1=192.168.0.7 bot2'], "'bot2'"),
    (['--link', "bot1=tcp/x';touch hacked:1"], '--link'),
    (['--link', 'bot1=udp/192.168.0.7:7447'], "'udp/192.168.0.7:7447'"),
    (['--link', 'bot1', '--router', 'somewhere'], "--router: 'somewhere'"),
    (['--router', '192.0.2.1:7447'], '--router'),
    (['--keep', 'states'], '--link'),
    (['--link', 'bot1=192.168.0.7', '--keep', 'all'], "'all'"),
    (['--ip', '300.1.1.1'], "'300.1.1.1'"),
    (['--ip', '010.1.1.1'], '10.1.1.1'),
    (['--ip', '`touch hacked`'], "'`touch hacked`'"),
    (['--ip', '127.0.0.1\n'], '--ip'),
    (['--ip', '1.' * 50000], '512'),
    (['--master', 'http://127.0.0.1:11311\n'], '--master'),
    (['--\x1b[2J'], '--?[2J'),
    (['x' * 100000], 'x'),
    (['gui:=\x1b[2J'], 'gui'),
    (['robots:=bot1\nbot2'], 'robots'),
    (["robots:=bot1' --fresh --select 'bot1"], "'bot1''"),
    (['robots:=bot1 --select'], "'--select'"),
    (["screenshot:=x' --fresh '"], 'screenshot'),
    (['--demo', '--screenshot', "x' --fresh '.png"], '--screenshot'),
    (['--master', 'http://host:99999'], '99999'),
    (['--master', 'http://host:11311/$(touch hacked)'], '--master'),
    (['--demo', '--ip', '127.0.0.1'], '--ip'),
    (['--demo', '--sim', '3'], '--sim'),
    (['--replay', '/nowhere/at/all'], '/nowhere/at/all'),
    (['--replay', '/tmp', '--sim', '2'], '--sim'),
    (['--replay', '/tmp', '--fresh'], '--fresh'),
    (['--screenshot', 'x.png'], '--demo'),
    (['--drill', '../drills/maze'], "'../drills/maze'"),
    (['--drill', 'nowhere.yaml'], 'nowhere.yaml'),
    (['--drill', 'a b'], "'a b'"),
    (['--drill', 'maze', '--sim', '3'], '--sim'),
    (['--scripted'], '--drill'),
    (['--demo', '--screenshot', '/nowhere/at/all.png'], '/nowhere/at'),
    (['--demo', '--screenshot', '/tmp'], '/tmp'),
    (['start'], "'start'"),
    ([''], "''"),
    (['X Y:=3'], "'X Y:=3'"),
    (['enabeling:=pedal'], 'enabling'),
    (['restarter:=sh'], "'restarter'"),
    (['gui:=foo'], 'standalone'),
    (['enabling:=pedel'], "'pedel'"),
    (['inputs:=joy,pedal'], "'joy,pedal'"),
    (['required:=yes'], "'yes'"),
    (['sim:=13'], "'13'"),
    (['--sim', '3', 'turtlebot2 turtlebot4 turtlebot5'], "'turtlebot4', 'turtlebot5'"),
    (['--demo', '--sim-types', ' '], "''"),
    (['sim:=3', 'sim_types:=turtlebot4'], "'turtlebot4'"),
])
def test_wrong_arguments_are_refused(checkout, arguments, named):
    status, output = checkout.run(*arguments)
    assert status == 2, output
    assert named in output and '--help' in output
    assert len(output.strip().splitlines()) <= 2
    assert output.replace('\n', '').isprintable() and len(output) <= 600
    assert checkout.calls == []
    assert not (checkout.root / 'build').exists()
    assert not list(checkout.root.parent.rglob('hacked'))


def test_help_is_the_manual(checkout):
    status, output = checkout.run('-h', script=checkout.script.with_name('mrhi_run.sh'))
    assert status == 0 and checkout.calls == []
    source = checkout.script.read_text()
    options = set(re.findall(r'^ +(--[a-z-]+)\)', source, re.M))
    assert len(options) >= 6
    assert [option for option in options if option not in output] == []


@pytest.mark.parametrize('arguments, launched', [
    ([], ['sim:=0']),
    (['--sim', '2', 'turtlebot2 turtlebot3_burger'],
     ['sim:=2', 'robots:=bot1 bot2', 'sim_types:=turtlebot2 turtlebot3_burger']),
    (['--sim', '2', '--sim-types', 'turtlebot2'],
     ['sim:=2', 'robots:=bot1 bot2', 'sim_types:=turtlebot2']),
    (['--sim', '2', 'sim_prefix:=r'], ['sim:=2', 'sim_prefix:=r']),
    (['--sim', '2', 'robots:=bot2'], ['sim:=2', 'robots:=bot2']),
    (['--fresh'], ['sim:=0', 'fresh:=true']),
    (['enabling:=pedal', 'inputs:=joy pedal'], ['sim:=0', 'enabling:=pedal', 'inputs:=joy pedal']),
])
def test_right_arguments_reach_the_launch_file(checkout, arguments, launched):
    status, output = checkout.run('--master', 'http://127.0.0.1:1', *arguments)
    assert status == 0, output
    assert checkout.called('roslaunch') == ['roslaunch mhri mhri.launch ' + ' '.join(launched)]


def test_links_become_endpoints(checkout):
    installed = checkout.root / 'build' / '.ws' / 'link' / 'installed'
    installed.parent.mkdir(parents=True)
    # As if pip had been there before.
    installed.write_text('eclipse-zenoh==' + re.search(
        r'eclipse-zenoh==([0-9.]+)', checkout.script.with_name('common.sh').read_text()).group(1))
    status, output = checkout.run('--master', 'http://127.0.0.1:1', '--link',
                                  'bot1=192.168.0.7 bot2=tcp/192.168.0.8:7448 bot3', '--router',
                                  'tls/192.0.2.1:7447')
    assert status == 0, output
    assert checkout.called('roslaunch') == [
        'roslaunch mhri mhri.launch sim:=0 links:=bot1=192.168.0.7:7447 '
        'bot2=tcp/192.168.0.8:7448 bot3 keys:=auto keep:=session router:=tls/192.0.2.1:7447']


def test_a_labs_own_source_can_be_the_enabling_one(checkout, tmp_path):
    own = tmp_path / 'lab.yaml'
    own.write_text('sources:\n- name: handle\n')
    here = ['--master', 'http://127.0.0.1:1', 'mux_config:={}'.format(own)]
    assert checkout.run('enabling:=handle', *here)[0] == 0
    status, output = checkout.run('enabling:=pedal', *here)
    assert status == 2 and "'pedal'" in output and 'handle' in output
    own.write_text('sources: [')
    assert checkout.run('enabling:=handle', *here)[0] == 0  # the mux refuses the file


@pytest.mark.parametrize('lacks', ['python3', 'yaml'])
def test_a_bare_machine_is_asked_again_when_all_is_installed(checkout, tmp_path, lacks):
    """What looks into the launch file comes with the packages."""
    missing = tmp_path / 'missing'
    missing.mkdir()
    (missing / 'yaml.py').write_text('raise ImportError\n')
    checkout.stand_in('dpkg-query', 'rm -f "{0}/yaml.py"; printf installed'.format(missing))
    if lacks == 'python3':
        script = checkout.script.read_text()
        checkout.script.write_text(script.replace(
            'command -v python3', '[ ! -e "{}/yaml.py" ]'.format(missing)))
    status, output = checkout.run('--sim', '3', 'turtlebot4', PYTHONPATH=str(missing))
    assert status == 2 and "'turtlebot4'" in output
    assert checkout.called('dpkg-query') and checkout.called('roslaunch') == []


def test_the_values_are_those_of_the_launch_file(checkout):
    launch = (checkout.root / 'launch' / 'mhri.launch').read_text()
    source = (checkout.root / 'utils' / 'host' / 'before_start.py').read_text()
    [gui] = re.findall(r"'gui': \((.*)\)", source)
    documented = re.search(r'name="gui".*?doc="(.*?)"', launch, re.S).group(1)
    for value in re.findall(r"'(\w+)'", gui):
        assert re.search(r'\b{}\b'.format(value), documented), value
