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
    assert 'installing missing packages with apt: python3-rospy xvfb' in output
    assert checkout.called('sudo') == []
    assert checkout.called('apt-get') == [
        'apt-get update',
        'apt-get install -y --no-install-recommends python3-rospy xvfb']


def test_missing_packages_as_a_user_ask_for_sudo_and_say_so(checkout):
    status, output = checkout.run(*HERE, FAKE_MISSING='xvfb', FAKE_UID='1000')
    assert status == 0, output
    assert output.index('installing missing packages') < output.index('asking for administrator')
    assert [call.split()[:2] for call in checkout.called('sudo')] == [
        ['sudo', 'apt-get'], ['sudo', 'env']]
    assert checkout.called('roslaunch')


def test_failed_installation_starts_nothing(checkout):
    status, output = checkout.run(*HERE, FAKE_MISSING='xvfb', FAKE_APT_STATUS='100')
    assert status == 1
    assert 'could not update the package lists' in output
    assert 'apt could not install what is missing' in output
    assert checkout.called('catkin_make', 'roslaunch') == []


@pytest.mark.parametrize('name, version, said', [
    ('fedora', '40', 'this system (fedora 40) is not supported'),
    ('debian', '11', 'this system (debian 11) is not supported'),
    ('ubuntu', '24.04', 'this system (ubuntu 24.04) is not supported'),
    ('ubuntu', '20.04', 'Ubuntu 20.04 without ROS Noetic'),
])
def test_other_systems_are_refused(checkout, tmp_path, name, version, said):
    checkout.os_release(tmp_path / 'os-release', name, version)
    status, output = checkout.run(*HERE)
    assert status == 1 and said in output
    assert 'Debian 12' in output or 'ros-noetic-ros-base' in output
    assert checkout.called('apt-get', 'sudo', 'catkin_make', 'roslaunch') == []


def test_no_os_release_at_all(checkout):
    status, output = checkout.run(*HERE, MHRI_OS_RELEASE='/nowhere')
    assert status == 1 and 'this system (unknown) is not supported' in output


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


def test_every_package_of_the_manifest_is_in_debians_list(checkout):
    """Rosdep reads package.xml on Ubuntu; Debian's list, written by hand, has to have the same."""
    manifest = (checkout.root / 'package.xml').read_text()
    listed = (checkout.root / 'utils' / 'host' / 'common.sh').read_text()
    listed = listed[listed.index('DEBIAN_RUN=('):listed.index('UBUNTU_RUN=(')].split()
    needed = [line.split('>')[1].split('<')[0] for line in manifest.splitlines()
              if line.strip().startswith(('<exec_depend', '<depend', '<test_depend'))]
    # Not in Debian (rqt), for a robot alone, or there under another name.
    renamed = {'nodelet': None, 'rqt_gui': None, 'rqt_gui_py': None,
               'libturbojpeg': 'libturbojpeg0',
               'message_runtime': 'ros-message-runtime',
               'topic_tools': 'topic-tools'}

    def names(key):
        if key in renamed:
            return [renamed[key]]
        dashed = key.replace('_', '-')
        return [dashed, 'python3-' + dashed]
    assert needed
    assert [key for key in needed
            if names(key) != [None] and not set(names(key)) & set(listed)] == []
