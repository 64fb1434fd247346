# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_run.sh from start to end: what it builds, where it may be called from, how it ends."""
import shutil
import signal

from support.checkout import Checkout, children_with
from support.ros_system import wait_for
import pytest

HERE = ('--master', 'http://127.0.0.1:1')
# A roslaunch that ends on the first signal and counts them all.
PATIENT = ('trap \'echo signalled >>"$MHRI_CALLS"; kill $!; exit 0\' TERM INT; '
           'echo up >>"$MHRI_CALLS"; sleep 60 & wait')


def wait_for_call(checkout, text):
    """Wait until a stand-in has written a line."""
    wait_for(lambda: text in checkout.calls, what=lambda: '{}: {}'.format(text, checkout.calls))


def test_only_a_change_is_built(checkout):
    for _ in range(2):
        assert checkout.run(*HERE)[0] == 0
    assert len(checkout.called('catkin_make')) == 1
    assert len(checkout.called('roslaunch')) == 2
    for built, change in enumerate((
            lambda: (checkout.root / 'msg' / 'New.msg').write_text('bool x\n'),
            lambda: (checkout.root / 'msg' / 'ControlMode.msg').unlink(),
            lambda: (checkout.root / 'scripts' / 'mux').write_text('#\n'),
            lambda: (checkout.root / 'package.xml').write_text('#\n')), 2):
        change()
        checkout.run(*HERE)
        assert len(checkout.called('catkin_make')) == built


def test_failed_build_shows_its_log_and_starts_nothing(checkout):
    checkout.stand_in('catkin_make', 'echo "the reason"; exit 1')
    status, output = checkout.run(*HERE)
    assert status == 1
    assert 'the reason' in output and 'build.log' in output
    assert checkout.called('roslaunch') == []
    assert checkout.run(*HERE)[0] == 1


def test_install_space_in_a_path_with_a_space_is_refused(checkout):
    status, output = checkout.run('--install-space', *HERE)
    assert status == 1 and str(checkout.root) in output
    assert checkout.called('catkin_make', 'roslaunch') == []


def test_moved_checkout_is_built_anew(checkout, tmp_path):
    checkout.run(*HERE)
    (checkout.root / 'build' / '.ws' / 'build' / 'old').touch()
    moved = tmp_path / 'moved'
    shutil.move(str(checkout.root), str(moved))
    checkout.root = moved
    assert checkout.run(*HERE)[0] == 0
    assert len(checkout.called('catkin_make')) == 2
    assert not (moved / 'build' / '.ws' / 'build' / 'old').exists()


def test_workspace_of_the_tests_is_left_to_them(checkout):
    checkout.run(*HERE)
    (checkout.root / 'build' / '.ws' / 'build' / 'CMakeCache.txt').write_text(
        'CATKIN_ENABLE_TESTING:BOOL=ON\n')
    (checkout.root / 'msg' / 'New.msg').write_text('bool x\n')
    checkout.run(*HERE)
    first, second = checkout.called('catkin_make')
    assert '-DCATKIN_ENABLE_TESTING=OFF' in first and '-DCATKIN_ENABLE_TESTING=ON' in second


def test_workspace_that_cannot_be_written(checkout):
    (checkout.root / 'build').write_text('in the way, even of root')
    status, output = checkout.run(*HERE)
    assert status == 1 and str(checkout.root) in output
    assert checkout.called('roslaunch') == []


def test_what_is_built_runs_where_nothing_can_be_written(checkout):
    """As another user, or from a disk that is mounted for reading alone."""
    checkout.run(*HERE)
    lock = checkout.root / 'build' / '.ws' / 'lock'
    lock.unlink()
    lock.mkdir()  # in the way, even of root
    status, output = checkout.run(*HERE)
    assert status == 0, output
    assert len(checkout.called('catkin_make')) == 1 and len(checkout.called('roslaunch')) == 2
    (checkout.root / 'msg' / 'New.msg').write_text('bool x\n')
    status, output = checkout.run(*HERE)
    assert status == 1 and str(checkout.root) in output
    assert len(checkout.called('catkin_make')) == 1


@pytest.mark.parametrize('name', ["Ann's", 'a$HOME'])
def test_a_path_that_catkin_or_roslaunch_would_misread_is_refused(tmp_path, name):
    checkout = Checkout(tmp_path, name)
    status, output = checkout.run(*HERE)
    assert status == 1 and str(checkout.root) in output
    assert checkout.called('catkin_make', 'roslaunch') == []


def test_from_anywhere_and_through_a_link(checkout, tmp_path):
    link = tmp_path / 'my link'
    link.symlink_to(checkout.script.with_name('mrhi_run.sh'))
    elsewhere = tmp_path / 'else where'
    elsewhere.mkdir()
    status, output = checkout.run(*HERE, script=link, cwd=elsewhere)
    assert status == 0, output
    assert checkout.called('roslaunch') == ['roslaunch mhri mhri.launch sim:=0']
    assert (checkout.root / 'build').is_dir()
    assert list(elsewhere.iterdir()) == []


def test_panel_that_failed_is_told(checkout):
    status, output = checkout.run(*HERE, FAKE_ROSLAUNCH='echo 137 >"$MHRI_PANEL_STATUS"')
    assert (status, '137' in output) == (1, True), output


def test_roslaunchs_failure_is_the_scripts(checkout):
    assert checkout.run(*HERE, FAKE_ROSLAUNCH='exit 1')[0] == 1


@pytest.mark.parametrize('sent, status', [(signal.SIGINT, 130), (signal.SIGHUP, 143)])
def test_signal_ends_everything_once(checkout, sent, status):
    process = checkout.start(*HERE, FAKE_ROSLAUNCH=PATIENT)
    wait_for_call(checkout, 'up')
    process.send_signal(sent)
    process.send_signal(sent)
    output = process.communicate(timeout=60)[0]
    assert process.returncode == status, output
    assert checkout.calls.count('signalled') == 1
    assert children_with(str(checkout.calls_file)) == []


def test_script_that_is_killed_takes_everything_along(checkout):
    process = checkout.start(*HERE, FAKE_ROSLAUNCH=PATIENT, DISPLAY='')
    wait_for_call(checkout, 'up')
    process.kill()
    process.communicate(timeout=60)
    wait_for_call(checkout, 'signalled')
    wait_for(lambda: not children_with(str(checkout.calls_file)))


def test_what_roslaunch_leaves_behind_is_ended(checkout):
    status, output = checkout.run(
        *HERE, FAKE_ROSLAUNCH='setsid sleep 60 >/dev/null 2>&1 & disown; exit 0')
    assert status == 0
    assert 'sleep 60' in output
    assert children_with(str(checkout.calls_file)) == []


@pytest.mark.parametrize('display, wayland, own', [('', '', True), ('', 'wayland-0', False)])
def test_without_a_display_there_is_xvfb(checkout, display, wayland, own):
    status, output = checkout.run(
        *HERE, DISPLAY=display, WAYLAND_DISPLAY=wayland,
        FAKE_ROSLAUNCH='xdpyinfo >>"$MHRI_CALLS" 2>&1; env -u XAUTHORITY xdpyinfo >/dev/null 2>&1'
                       ' || echo "no key, no entry" >>"$MHRI_CALLS"')
    assert status == 0, output
    assert ('Xvfb' in output) == own
    calls = '\n'.join(checkout.calls)
    if own:
        assert '1920x1080 pixels' in calls and 'no key, no entry' in calls
    assert children_with(str(checkout.calls_file)) == []


def test_demo_that_fails_is_status_1(checkout, tmp_path):
    # roslaunch's last argument is demo_result:=FILE.
    status, output = checkout.run(
        '--demo', '--sim', '5', '--screenshot', 'a picture.png',
        FAKE_ROSLAUNCH='last="${@: -1}"; printf %s "bot1 did not stop" >"${last#*:=}"')
    assert (status, 'bot1 did not stop' in output) == (1, True), output
    [call] = checkout.called('roslaunch')
    assert 'sim:=5' in call and 'demo:=true' in call
    assert 'screenshot:={} demo_result:='.format(tmp_path / 'a picture.png') in call
    assert checkout.run('--demo')[0] == 1  # it ended without a result
