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
    (['--link'], '--link needs a value'),
    (['--link', 'bot1'], "'bot1' is not NAME=ADDRESS"),
    (['--link', 'bot1=192.168.0.7 bot2'], "'bot2' is not NAME=ADDRESS"),
    (['--link', '1bot=192.168.0.7'], "'1bot=192.168.0.7'"),
    (['--link', "bot1=tcp/x';touch hacked:1"], 'is not NAME=ADDRESS'),
    (['--link', 'bot1=http/192.168.0.7:80'], 'is not NAME=ADDRESS'),
    (['--link', 'bot1', '--router', 'somewhere'], "--router: 'somewhere' is not an endpoint"),
    (['--router', '192.0.2.1:7447'], '--router: name the robots behind it'),
    (['--keep', 'states'], '--keep goes with --link'),
    (['--link', 'bot1=192.168.0.7', '--keep', 'all'], "--keep: 'all' is none of session, states"),
    (['--ip'], '--ip needs a value'),
    (['--ip', '300.1.1.1'], "'300.1.1.1' is not an IPv4 address"),
    (['--ip', '1.2.3'], "'1.2.3'"),
    (['--ip', '1.2.3.4.5'], "'1.2.3.4.5'"),
    (['--ip', '010.1.1.1'], 'has leading zeros, which programs read differently: write 10.1'),
    (['--ip', 'fe80::1'], "'fe80::1'"),
    (['--ip', '`touch hacked`'], "'`touch hacked`'"),
    (['--ip', '127.0.0.1\n'], '--ip: a control character'),
    (['--ip', '1.2.3.4\x1b[2J'], '--ip: a control character'),
    (['--ip', '1.' * 50000], 'is too long: at most 512'),
    (['--ip', '1.' * 200], 'is not an IPv4 address'),
    (['--master', 'http://127.0.0.1:11311\n'], '--master: a control character'),
    (['--sim', '3\n'], '--sim: a control character'),
    (['--\x1b[2J'], 'there is no option --?[2J'),
    (['--' + 'x' * 100000], 'there is no option --xxx'),
    (['x' * 100000], 'is neither an option nor'),
    (['gui:=\x1b[2J'], 'gui: a control character'),
    (['robots:=bot1\nbot2'], 'robots: a control character'),
    (["robots:=bot1' --fresh --select 'bot1"], "robots: 'bot1'' is not a robot's name"),
    (['robots:=bot1 --select'], "robots: '--select' is not a robot's name"),
    (["screenshot:=x' --fresh '"], 'screenshot: a quote'),
    (["demo_result:=x' --fresh '"], 'demo_result: a quote'),
    (['--demo', '--screenshot', "x' --fresh '.png"], '--screenshot: a quote'),
    (['--master'], '--master needs a value'),
    (['--master', 'localhost'], "'localhost' is not an address"),
    (['--master', 'http://host'], "'http://host'"),
    (['--master', 'http://host:99999'], 'there is no port 99999'),
    (['--master', 'http://host:11311/$(touch hacked)'], 'is not an address'),
    (['--master', 'https://host:11311'], "'https://host:11311'"),
    (['--demo', '--ip', '127.0.0.1'], 'leave out --ip and --master'),
    (['--demo', '--master', 'http://127.0.0.1:11311'], 'leave out --ip and --master'),
    (['--demo', '--sim', '3'], '--demo plays with four robots'),
    (['--replay'], '--replay needs a value'),
    (['--replay', '/nowhere/at/all'], '--replay: there is no /nowhere/at/all'),
    (['--replay', '/tmp', '--sim', '2'], 'leave out --ip, --master, --sim'),
    (['--replay', '/tmp', '--demo'], 'leave out --ip, --master, --sim'),
    (['--replay', '/tmp\n'], '--replay: a control character'),
    (['--screenshot', 'x.png'], '--screenshot goes with --demo'),
    (['--drill'], '--drill needs a value'),
    (['--drill', 'mace'], "there is no drill 'mace'; there are figure_of_eight lost_link maze"),
    (['--drill', '../drills/maze'], "there is no drill '../drills/maze'"),
    (['--drill', 'nowhere.yaml'], 'there is no file nowhere.yaml'),
    (['--drill', 'a b'], 'a space or quote'),
    (['--drill', 'maze', '--sim', '3'], 'leave out --sim and --demo'),
    (['--drill', 'maze', '--demo'], 'leave out --sim and --demo'),
    (['--scripted'], '--scripted goes with --drill NAME'),
    (['--demo', '--screenshot', '/nowhere/at/all.png'], 'there is no folder /nowhere/at'),
    (['--demo', '--screenshot', '/tmp'], '/tmp is a folder'),
    (['start'], "'start' is neither an option nor ARG:=VALUE"),
    (['3'], "'3'"),
    ([''], "''"),
    (['X Y:=3'], "'X Y:=3' is not ARG:=VALUE"),
    ([':=3'], "':=3' is not ARG:=VALUE"),
    (['nosucharg:=1'], "no argument 'nosucharg' in mhri.launch: it has gui, required, robots"),
    (['enabeling:=pedal'], "no argument 'enabeling' in mhri.launch: did you mean enabling?"),
    (['sim_type:=turtlebot2'], 'did you mean sim_types'),
    (['restarter:=sh'], "no argument 'restarter'"),
    (['gui:=foo'], "gui: 'foo' is not auto, rqt, standalone or none"),
    (['gui:=none', 'gui:='], "gui: ''"),
    (['enabling:=pedel'], "enabling: 'pedel' is not joy, ps3joy, pedal or voice"),
    (['inputs:=joy,pedal'], "inputs: 'joy,pedal' is not joy, pedal, voice or none"),
    (['required:=yes'], "required: 'yes' is not true or false"),
    (['automatic_switching:=1'], "automatic_switching: '1' is not true or false"),
    (['sim:=13'], "sim: '13' is not a number from 0 to 12"),
    (['sim:=many'], "sim: 'many'"),
    (['--sim', '3', 'turtlebot4'], "cannot simulate 'turtlebot4'; the types to simulate are "
     'turtlebot2, turtlebot3, turtlebot3_burger, turtlebot3_waffle, turtlebot3_waffle_pi'),
    (['--sim', '3', 'turtlebot2 turtlebot4 turtlebot5'],
     "cannot simulate 'turtlebot4', 'turtlebot5'"),
    (['--sim', '3', '--sim-types', 'generic'], "cannot simulate 'generic'"),
    (['--demo', '--sim-types', ' '], "cannot simulate ''"),
    (['sim:=3', 'sim_types:=turtlebot4'], "cannot simulate 'turtlebot4'"),
])
def test_wrong_arguments_are_refused(checkout, arguments, said):
    status, output = checkout.run(*arguments)
    assert status == 2, output
    assert said in output and '--help' in output
    assert len(output.strip().splitlines()) <= 2, 'one line that says what is wrong'
    assert output.replace('\n', '').isprintable() and len(output) <= 600
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
    (['enabling:=pedal', 'inputs:=joy pedal'], ['sim:=0', 'enabling:=pedal', 'inputs:=joy pedal']),
    (['enabling:=', 'inputs:=none'], ['sim:=0', 'enabling:=', 'inputs:=none']),
    (['--sim', '1', 'turtlebot3'], ['sim:=1', 'sim_types:=turtlebot3']),
    (['--sim', '1', 'turtlebot3_waffle_pi'], ['sim:=1', 'sim_types:=turtlebot3_waffle_pi']),
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
                                  'bot1=192.168.0.7 bot2=udp/192.168.0.8:7448 bot3', '--router',
                                  'tls/192.0.2.1:7447')
    assert status == 0, output
    assert checkout.called('roslaunch') == [
        'roslaunch mhri mhri.launch sim:=0 links:=bot1=192.168.0.7:7447 '
        'bot2=udp/192.168.0.8:7448 bot3 keys:=auto keep:=session router:=tls/192.0.2.1:7447']


def test_a_labs_own_source_can_be_the_enabling_one(checkout, tmp_path):
    own = tmp_path / 'lab.yaml'
    own.write_text('sources:\n- name: handle\n')
    here = ['--master', 'http://127.0.0.1:1', 'mux_config:={}'.format(own)]
    assert checkout.run('enabling:=handle', *here)[0] == 0
    status, output = checkout.run('enabling:=pedal', *here)
    assert status == 2 and "enabling: 'pedal' is not handle" in output
    own.write_text('sources: [')
    assert checkout.run('enabling:=handle', *here)[0] == 0, 'the mux says what is wrong with it'


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
    assert status == 2 and "cannot simulate 'turtlebot4'" in output
    assert checkout.called('dpkg-query') and checkout.called('roslaunch') == []


def test_the_values_are_those_of_the_launch_file(checkout):
    launch = (checkout.root / 'launch' / 'mhri.launch').read_text()
    source = (checkout.root / 'utils' / 'host' / 'before_start.py').read_text()
    [gui] = re.findall(r"'gui': \((.*)\)", source)
    [inputs] = re.findall(r'INPUTS = \((.*)\)', source)
    documented = re.search(r'name="gui".*?doc="(.*?)"', launch, re.S).group(1)
    for value in re.findall(r"'(\w+)'", gui):
        assert re.search(r'\b{}\b'.format(value), documented), value
    found = re.findall(r"'(\w+)' in inputs.split", launch)
    assert sorted(re.findall(r"'(\w+)'", inputs)) == sorted(found + ['none'])
