# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A pad by its name, driving, and calibrated while nothing drives: real nodes, one robot."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.devices.presenters import pad_host  # noqa: E402
from mhri.screen.presenters.demo import Grip  # noqa: E402
from support.kernel_pads import F710, plug  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402
from support.virtual_pad import missing, pad_command, PadClient, PadProcess  # noqa: E402

NO_PADS = missing()
PS3 = 'Sony PLAYSTATION(R)3 Controller'
# The dead-man button of resource/pads/ps3.yaml.
L1 = 4

pytestmark = [pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS)),
              pytest.mark.filterwarnings('ignore::DeprecationWarning')]


@pytest.fixture(scope='module')
def socket(tmp_path_factory):
    """The place at which the process that reads the pad for the page hears the test."""
    return str(tmp_path_factory.mktemp('page') / 'socket')


@pytest.fixture(scope='module')
def session(socket):
    plain = pad_host.command
    pad_host.command = lambda module: pad_command(socket, module)
    running = PanelSession((('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2'),), ('bot1',))
    yield running
    running.close()
    pad_host.command = plain


@pytest.fixture
def joy(session, tmp_path):
    """The pad's node, with no pad as far as the kernel says."""
    process = PadProcess(env=session.system.env, paused=True)
    process.do('shown_in', folder=str(tmp_path))
    process.do('go_on')
    yield process
    process.end()


def shown(session, text):
    """Wait until the mode list has an entry."""
    combo = session.host.screen.mode_combo
    session.until(lambda: text in [combo.itemText(row) for row in range(combo.count())],
                  what='{!r} in the mode list'.format(text))


def choose(session, text):
    """Click an entry of the mode list."""
    from python_qt_binding.QtCore import Qt
    from python_qt_binding.QtTest import QTest
    combo = session.host.screen.mode_combo
    combo.showPopup()
    session.until(combo.view().isVisible, what='the list')
    row = next(row for row in range(combo.count()) if combo.itemText(row) == text)
    place = combo.view().visualRect(combo.model().index(row, 0)).center()
    # The list lets clicks pass for a moment after it was opened.
    session.until(lambda: QTest.mouseClick(combo.view().viewport(), Qt.LeftButton,
                                           Qt.NoModifier, place) or not combo.view().isVisible(),
                  what='the click')
    session.until(lambda: combo.shown_text == text, what='{!r} to be the mode'.format(text))


@pytest.mark.parametrize('name, first_is, other_is', [
    (F710[0], PS3, F710[0]), (PS3, PS3 + ', number 1', PS3 + ', number 2')])
def test_with_two_pads_plugged_in_the_operator_chooses(session, joy, name, first_is, other_is):
    import rospy
    operator = session.operator
    first = joy.do('attach', name=PS3)
    joy.do('attach', name=name)
    session.host._request_mode('ps3joy')
    shown(session, first_is)
    shown(session, other_is)
    choose(session, other_is)
    assert operator.view().mode == 'ps3joy'
    shown(session, first_is)
    joy.do('set', number=first, axes={1: -1.0}, buttons={L1: 1})
    session.until(lambda: operator.view().status, what='the status')
    assert not operator.robot_view('bot1').moving, 'the pad that was not chosen is pushed'
    if name == PS3:
        joy.do('detach', number=first)
        session.until(lambda: session.host.screen.mode_combo.shown_text == PS3, what='one name')
    rospy.set_param('/mhri_joy/device', '')


def test_a_pad_by_its_name_from_the_list_to_the_robot_and_the_page(session, joy, socket, tmp_path):
    operator = session.operator
    shown(session, 'PS3 Controller (not connected)')
    plug(tmp_path, 3, F710)
    shown(session, 'Logitech Gamepad F710')
    session.hands.click('check_bot1')
    session.host._request_mode('ps3joy')
    # SDL sees no pad: whatever the kernel's list said, the node is the one to believe.
    session.until(lambda: 'plug one in' in operator.view().status, what='the remedy')
    pad = joy.do('attach', name=PS3)
    shown(session, PS3)
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 0})
    session.until(lambda: 'hold the dead-man button' in operator.view().status, what='the pad')
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 1})
    session.until(lambda: operator.view().status.endswith('ready'), what='the pad to be centred')
    says = session.host.windows['bot1'].hud
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 0})
    session.until(lambda: 'hold the dead-man button' in operator.view().status, what='the line')
    assert 'dead-man' not in says.sentence, 'nobody has pushed the stick'
    hold = 'hold the dead-man button to drive'
    # A busy machine may take the pad for lost: then it has to be centred and pushed again.
    session.until(Grip(lambda: joy.do('set', number=pad, axes={1: -1.0}),
                       lambda: joy.do('set', number=pad, axes={1: 0.0}),
                       lambda: operator.view().status.replace(hold, 'ready'),
                       lambda: says.sentence == hold), what='the tile')
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 1})
    session.until(lambda: operator.view().status.endswith('ready'), what='the pad to be centred')
    session.until(Grip(lambda: joy.do('set', number=pad, axes={1: -1.0}),
                       lambda: joy.do('set', number=pad, axes={1: 0.0}),
                       lambda: operator.view().status,
                       lambda: operator.robot_view('bot1').moving), what='bot1 to drive')
    calibrate(session, socket)
    session.until(lambda: not operator.robot_view('bot1').moving, what='bot1 to stand')
    assert operator.view().stop_all and operator.view().mode == 'joy'
    page = session.host.parts['pad'].page
    operator.release()
    session.until(lambda: 'released' in page.problem.text() or not operator.view().stop_all,
                  what='the release')
    session.until(lambda: 'released' in page.problem.text(), what='the end of the calibration')
    assert not operator.robot_view('bot1').moving, 'the pad is still pushed, and not the mode'


def calibrate(session, socket):
    """Open the page, plug a pad into its process, and begin."""
    page = session.host.parts['pad'].page
    session.host.screen.arrangement.show_page(page)
    session.until(lambda: os.path.exists(socket), what='the process of the page')
    client = PadClient(socket)
    client.do('attach', name='Lab rat pad', vendor=0x1209)
    session.until(lambda: page.title.text() == 'Lab rat pad', what='the pad on the page')
    session.until(lambda: page.action_button.text() == 'Stop all and calibrate', what='the button')
    session.hands.click('pad_action')
    session.until(lambda: 'let go of everything' in page.prompt.text(), what='the first question')
    client.close()
