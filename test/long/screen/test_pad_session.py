# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A pad by its name, driving, and calibrated while nothing drives: real nodes, one robot."""
import os

import pytest

from mhri.devices.io import child
from mhri.screen.presenters.demo import Grip
from support.kernel_pads import F710, plug
from support.panel_session import PanelSession
from support.virtual_pad import missing, pad_command, PadClient, PadProcess

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
    plain = child.command
    child.command = lambda module, *words: (
        pad_command(socket, module, *words) if module.endswith('.pad_stream')
        else plain(module, *words))
    running = PanelSession((('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2'),), ('bot1',))
    yield running
    running.close()
    child.command = plain


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
    combo = session.presenter.screen.mode_combo
    session.until(lambda: text in [combo.itemText(row) for row in range(combo.count())],
                  what='{!r} in the mode list'.format(text))


def test_a_pad_by_its_name_from_the_list_to_the_robot_and_the_page(session, joy, socket, tmp_path):
    operator = session.operator
    shown(session, 'PS3 Controller (not connected)')
    plug(tmp_path, 3, F710)
    shown(session, 'Logitech Gamepad F710')
    session.hands.click('check_bot1')
    operator.request_mode('ps3joy')
    # SDL sees no pad: whatever the kernel's list said, the node is the one to believe.
    session.until(lambda: 'plug one in' in operator.view().status, what='the remedy')
    pad = joy.do('attach', name=PS3)
    shown(session, PS3)
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 0})
    session.until(lambda: 'hold the dead-man button' in operator.view().status, what='the pad')
    joy.do('set', number=pad, axes={0: 0.0, 1: 0.0}, buttons={L1: 1})
    session.until(lambda: operator.view().status.endswith('ready'), what='the pad to be centred')
    says = session.presenter.windows['bot1'].hud
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
    page = session.presenter.parts['pad'].page
    operator.release()
    session.until(lambda: 'released' in page.problem.text() or not operator.view().stop_all,
                  what='the release')
    session.until(lambda: 'released' in page.problem.text(), what='the end of the calibration')
    assert not operator.robot_view('bot1').moving, 'the pad is still pushed, and not the mode'


def calibrate(session, socket):
    """Open the page, plug a pad into its process, and begin."""
    page = session.presenter.parts['pad'].page
    session.presenter.screen.arrangement.show_page(page)
    session.until(lambda: os.path.exists(socket), what='the process of the page')
    client = PadClient(socket)
    client.do('attach', name='Lab rat pad', vendor=0x1209)
    session.until(lambda: page.title.text() == 'Lab rat pad', what='the pad on the page')
    session.until(lambda: page.action_button.text() == 'Stop all and calibrate', what='the button')
    session.hands.click('pad_action')
    session.until(lambda: 'let go of everything' in page.prompt.text(), what='the first question')
    client.close()
