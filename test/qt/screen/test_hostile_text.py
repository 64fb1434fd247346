# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts of others are shown as text, everywhere: no widget takes them for HTML, or takes long."""
import os

import pytest
from python_qt_binding.QtCore import QEvent, QPoint
from python_qt_binding.QtGui import QHelpEvent, QTextDocument
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base import views
from mhri.base.geometry import Pose
from mhri.base.gui.labels import plain_tip
from mhri.base.mocap import Drift
from mhri.camera.images import StreamStatus
from mhri.doctor.facts import FAULT, Finding
from mhri.doctor.gui.doctor_page import DoctorPage
from mhri.recording.recording import FAILED, RecordingStatus
from mhri.screen.gui.windows import TurtleBotWindow

from support.rich_text import takes_for_html


def hostile_robot(text):
    return views.RobotView(
        text, text, link=views.SILENT, age_s=3.2, note=text, linear_mps=1e300, angular_rad_s=-1e30,
        heading_rad=1e300, x_m=1e308, y_m=-1e308, selected=True, slow=True, battery=1e30,
        figures=views.LinkFigures(1e30, 1e30, 1e30),
        proof=views.ProofView(views.PROOF_NOT_CONFIRMED, text))


def hostile_view(text, mode='voice'):
    return views.ScreenView(
        ros=views.ROS_CONNECTED, sources=((text, text), ('voice', text)), mode=mode, stop_all=True,
        stop_note=text, pace=text, together=True, status=text, camera_bits_per_s=1e300,
        robots=(hostile_robot(text),), heard=views.HeardView(text, text, False, text))


def furnish(panel, ui_dir, text, operator):
    """Show a text in every place there is for one; return the three windows."""
    window, doctor = TurtleBotWindow(ui_dir, text, text), DoctorPage()
    window.offer({'imu', 'rgb', 'depth', 'scan', 'record'})
    for view in (hostile_view(text), views.ScreenView(
            sources=((text, text),), mode=text, status=text, robots=(
                views.RobotView(text, text, link=views.LIVE, note=text),))):
        panel.show_view(view)
        panel.show_name_problem(text)
        panel.show_look_result(text, shorter=(text,))
        for robot in view.robots:
            window.show_view(robot, view.stop_all)
    window.view('rgb').show_placeholder(text)
    window.view('rgb').show_transports((text,))
    window.view('rgb').show_status(StreamStatus(transport=text, bad=3, age_s=2.0, problem=text))
    window.view('scan').clear(text)
    window.recording.show_recording(RecordingStatus(FAILED, path=text, note=text))
    window.recording.set_default_path(text)
    window.state_line.show_state(views.StateView(
        ((text, 9.0),), views.LinkFigures(1e30, 1e30, 1e30), Pose(1e300, -1e300, 1e300),
        Drift(1e300, 1e300)))
    doctor.show_findings([Finding(FAULT, text, text, text, text, text)], 0.1)
    made = (panel, window, doctor)
    for shown in made:
        operator.show(shown)
        operator.settle()
        shown.grab()
    return made


def test_no_widget_takes_a_text_for_html(panel, operator, ui_dir):
    for window in furnish(panel, ui_dir, '<b>x</b><img src=file:///tmp/x> &lt;', operator):
        widgets = [window, *window.findChildren(QWidget)]
        assert len(widgets) > 3
        found = [(widget.objectName(), problem) for widget in widgets
                 for problem in takes_for_html(widget)]
        assert not found


def test_a_tool_tip_opens_no_file(panel, operator, tmp_path):
    """A named pipe: whoever opened it would wait for a writer for ever."""
    pipe = str(tmp_path / 'pipe.png')
    os.mkfifo(pipe)
    panel.show_view(hostile_view('<img src="{}"> and more than there is room for'.format(pipe) * 2))
    operator.settle()
    tips = [widget for widget in panel.findChildren(QWidget) if pipe in widget.toolTip()]
    assert tips
    for widget in tips:
        place = widget.mapToGlobal(QPoint(2, 2))
        QApplication.sendEvent(widget, QHelpEvent(QEvent.ToolTip, QPoint(2, 2), place))
        operator.settle()


@pytest.mark.parametrize('text, whole', [
    ('12 ms', True), ('a < b', True), ('<img src=x>', False), ('5 > 3 & <b>', False)])
def test_a_tool_tip_says_what_the_text_says(text, whole):
    tip = plain_tip(text)
    assert (tip == text) == whole
    document = QTextDocument()
    if not whole:
        document.setHtml(tip)
        assert document.toPlainText() == text
