# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_run.sh from start to end: what it builds, where it may be called from, how it ends."""
import shutil
import signal
import time

from conftest import Checkout, children_with
import pytest

HERE = ('--master', 'http://127.0.0.1:1')
# A roslaunch that ends on the first signal and counts them all.
PATIENT = ('trap \'echo signalled >>"$MHRI_CALLS"; kill $!; exit 0\' TERM INT; '
           'echo up >>"$MHRI_CALLS"; sleep 60 & wait')


def wait_for_call(checkout, text, limit_s=60.0):
    """Wait until a stand-in has written a line."""
    end = time.monotonic() + limit_s
    while text not in checkout.calls:
        assert time.monotonic() < end, (text, checkout.calls)
        time.sleep(0.02)


def test_second_start_builds_nothing(checkout):
    assert checkout.run(*HERE)[0] == 0
    assert checkout.run(*HERE)[0] == 0
    assert len(checkout.called('catkin_make')) == 1
    assert len(checkout.called('roslaunch')) == 2


@pytest.mark.parametrize('change', [
    lambda root: (root / 'msg' / 'New.msg').write_text('bool x\n'),
    lambda root: (root / 'msg' / 'ControlMode.msg').unlink(),
    lambda root: (root / 'scripts' / 'mux').write_text('#\n'),
    lambda root: (root / 'package.xml').write_text('#\n'),
], ids=['new message', 'removed message', 'changed script', 'changed manifest'])
def test_change_is_built(checkout, change):
    checkout.run(*HERE)
    change(checkout.root)
    checkout.run(*HERE)
    assert len(checkout.called('catkin_make')) == 2


def test_failed_build_shows_its_log_and_starts_nothing(checkout):
    checkout.stand_in('catkin_make', 'echo "the reason"; exit 1')
    status, output = checkout.run(*HERE)
    assert status == 1
    assert 'the reason' in output and 'the build failed' in output and 'build.log' in output
    assert checkout.called('roslaunch') == []
    assert checkout.run(*HERE)[0] == 1, 'a failed build does not count as a build'


def test_install_space(tmp_path):
    checkout = Checkout(tmp_path, 'mhri')
    assert checkout.run('--install-space', *HERE)[0] == 0
    assert [call.split()[-1] for call in checkout.called('catkin_make')] == ['install']


def test_install_space_in_a_path_with_a_space_is_refused(checkout):
    status, output = checkout.run('--install-space', *HERE)
    assert status == 1 and 'path with a space' in output and str(checkout.root) in output
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


def test_workspace_with_a_link_to_the_checkout_is_built_anew(checkout):
    """As older versions made it: find, and with it rosrun, complained of the loop."""
    checkout.run(*HERE)
    workspace = checkout.root / 'build' / '.ws'
    (workspace / 'src').mkdir()
    (workspace / 'src' / 'mhri').symlink_to('../../..')
    (workspace / 'build' / 'old').touch()
    assert checkout.run(*HERE)[0] == 0
    assert len(checkout.called('catkin_make')) == 2
    assert not (workspace / 'src').exists() and not (workspace / 'build' / 'old').exists()
    assert (checkout.root / 'utils').is_dir(), 'the link is gone, not what it led to'


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
    assert status == 1 and 'cannot write to' in output
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
    assert status == 1 and 'make it writable, or copy the checkout' in output
    assert len(checkout.called('catkin_make')) == 1 and 'Is a directory' not in output


@pytest.mark.parametrize('name', ["Ann's", 'a$HOME', 'say "hi"', 'back\\slash', 'a;b', 'a`b'])
def test_a_path_that_catkin_or_roslaunch_would_misread_is_refused(tmp_path, name):
    checkout = Checkout(tmp_path, name)
    status, output = checkout.run(*HERE)
    assert status == 1 and 'move the checkout' in output
    assert checkout.called('catkin_make', 'roslaunch') == []


@pytest.mark.parametrize('name', ['mhri_run.sh', 'mrhi_run.sh'])
def test_from_anywhere_and_through_a_link(checkout, tmp_path, name):
    link = tmp_path / 'my link'
    link.symlink_to(checkout.script.with_name(name))
    elsewhere = tmp_path / 'else where'
    elsewhere.mkdir()
    status, output = checkout.run(*HERE, script=link, cwd=elsewhere)
    assert status == 0, output
    assert checkout.called('roslaunch') == ['roslaunch mhri mhri.launch sim:=0']
    assert (checkout.root / 'build').is_dir()
    assert list(elsewhere.iterdir()) == []


def test_roslaunchs_failure_is_the_scripts(checkout):
    assert checkout.run(*HERE, FAKE_ROSLAUNCH='exit 1')[0] == 1


@pytest.mark.parametrize('sent, status', [
    (signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 143)])
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
    end = time.monotonic() + 60.0
    while children_with(str(checkout.calls_file)):
        assert time.monotonic() < end
        time.sleep(0.02)


def test_what_roslaunch_leaves_behind_is_ended(checkout):
    status, output = checkout.run(
        *HERE, FAKE_ROSLAUNCH='setsid sleep 60 >/dev/null 2>&1 & disown; exit 0')
    assert status == 0
    assert 'ending a leftover process' in output and 'sleep 60' in output
    assert children_with(str(checkout.calls_file)) == []


@pytest.mark.parametrize('display, wayland, own', [
    ('', '', True), (':987', '', False), ('', 'wayland-0', False)])
def test_without_a_display_there_is_xvfb(checkout, display, wayland, own):
    status, output = checkout.run(
        *HERE, DISPLAY=display, WAYLAND_DISPLAY=wayland,
        FAKE_ROSLAUNCH='xdpyinfo >>"$MHRI_CALLS" 2>&1; env -u XAUTHORITY xdpyinfo >/dev/null 2>&1'
                       ' || echo "no key, no entry" >>"$MHRI_CALLS"')
    assert status == 0, output
    assert ('there is no display: the panel runs under Xvfb' in output) == own
    calls = '\n'.join(checkout.calls)
    if own:
        assert '1920x1080 pixels' in calls and 'no key, no entry' in calls
        assert 'DISPLAY=:987\n' not in calls
    assert children_with(str(checkout.calls_file)) == [], 'Xvfb has ended'


def test_no_panel_needs_no_display(checkout):
    status, output = checkout.run('gui:=none', *HERE, DISPLAY='')
    assert status == 0 and 'Xvfb' not in output


@pytest.mark.parametrize('result, status, said', [
    ('ok', 0, 'the demo succeeded'),
    ('bot1 did not stop', 1, 'the demo failed: bot1 did not stop'),
    (None, 1, 'the demo failed: it ended without a result'),
])
def test_demo_has_an_exit_status(checkout, tmp_path, result, status, said):
    # roslaunch's last argument is demo_result:=FILE.
    write = 'last="${{@: -1}}"; printf %s {!r} >"${{last#*:=}}"'.format(result) if result else ''
    got, output = checkout.run('--demo', '--screenshot', 'a picture.png', FAKE_ROSLAUNCH=write)
    assert (got, said in output) == (status, True), output
    [call] = checkout.called('roslaunch')
    assert 'sim:=4' in call and 'demo:=true' in call
    assert 'screenshot:={} demo_result:='.format(tmp_path / 'a picture.png') in call


def test_demo_takes_the_number_of_robots(checkout):
    checkout.run('--demo', '--sim', '5')
    assert 'sim:=5' in checkout.called('roslaunch')[0]
