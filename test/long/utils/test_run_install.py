# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What mhri_run.sh installs: what is missing, only that, saying so, with sudo only where needed."""
import pytest

CHANGING = ('sudo', 'apt-get', 'rosdep')
HERE = ('--master', 'http://127.0.0.1:1')


def test_nothing_missing_touches_nothing(checkout):
    status, output = checkout.run(*HERE, FAKE_UID='1000')
    assert status == 0, output
    assert checkout.called(*CHANGING) == []
    assert checkout.called('roslaunch')


def test_missing_packages_as_root(checkout):
    status, output = checkout.run(*HERE, FAKE_MISSING='xvfb python3-rospy')
    assert status == 0, output
    assert 'python3-rospy xvfb' in output
    assert checkout.called('sudo') == []
    assert checkout.called('apt-get') == [
        'apt-get update',
        'apt-get install -y --no-install-recommends python3-rospy xvfb']


def test_missing_packages_as_a_user_ask_for_sudo_and_say_so(checkout):
    status, output = checkout.run(*HERE, FAKE_MISSING='xvfb', FAKE_UID='1000')
    assert status == 0, output
    assert output.index('xvfb') < output.index('sudo')
    assert [call.split()[:2] for call in checkout.called('sudo')] == [
        ['sudo', 'apt-get'], ['sudo', 'env']]
    assert checkout.called('roslaunch')


def test_failed_installation_starts_nothing(checkout):
    status, output = checkout.run(*HERE, FAKE_MISSING='xvfb', FAKE_APT_STATUS='100')
    assert status == 1
    assert 'xvfb' in output
    assert checkout.called('catkin_make', 'roslaunch') == []


@pytest.mark.parametrize('name, version, named', [
    ('debian', '11', 'debian 11'), ('ubuntu', '24.04', 'ubuntu 24.04'),
    ('ubuntu', '20.04', 'ros-noetic-ros-base')])
def test_other_systems_are_refused(checkout, tmp_path, name, version, named):
    checkout.os_release(tmp_path / 'os-release', name, version)
    status, output = checkout.run(*HERE)
    assert status == 1 and named in output
    assert checkout.called('apt-get', 'sudo', 'catkin_make', 'roslaunch') == []


def test_ubuntu_22_04_has_debians_packages(checkout, tmp_path):
    checkout.os_release(tmp_path / 'os-release', 'ubuntu', '22.04')
    status, output = checkout.run(*HERE, FAKE_MISSING='python3-rospy')
    assert status == 0, output
    assert checkout.called(*CHANGING)[-1].endswith(' python3-rospy')


def test_no_os_release_at_all(checkout):
    status, output = checkout.run(*HERE, MHRI_OS_RELEASE='/nowhere')
    assert status == 1 and 'unknown' in output


@pytest.fixture
def noetic(checkout, tmp_path):
    """Return the checkout as it finds itself on Ubuntu 20.04 with ROS Noetic."""
    checkout.os_release(tmp_path / 'os-release', 'ubuntu', '20.04')
    (tmp_path / 'noetic').mkdir()
    (tmp_path / 'noetic' / 'setup.bash').write_text('unset NOT_SET; true "$NOT_SET"\n')
    return checkout


def test_noetic_with_everything(noetic):
    status, output = noetic.run(*HERE, FAKE_UID='1000')
    assert status == 0, output
    assert [call.split()[1] for call in noetic.called(*CHANGING)] == ['check']


def test_noetic_with_something_missing(noetic):
    status, output = noetic.run(*HERE, FAKE_UID='1000', FAKE_ROSDEP_CHECK='1')
    assert status == 0, output
    calls = noetic.called('rosdep')
    assert 'rosdep update --rosdistro noetic' in calls
    assert any(call.startswith('rosdep install --from-paths ' + str(noetic.root))
               and call.endswith('--ignore-src --rosdistro noetic -r -y') for call in calls)
    assert noetic.called('apt-get') == []
