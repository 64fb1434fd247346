#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the guide's pictures that need no running system: ``guide_pictures.py <folder>``.

``one.png`` is the screen with one robot and the drawer closed, ``doctor.png`` the doctor's page,
``faults.png`` its list of faults, ``drill_<name>.svg`` the way through each drill.
"""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.xvfb import start_xvfb  # noqa: E402

if __name__ == '__main__' and not os.environ.get('DISPLAY'):
    SERVER, os.environ['DISPLAY'] = start_xvfb('1600x1200x24')

from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.base.gui import theme  # noqa: E402
from mhri.base.io.pages import page  # noqa: E402
from mhri.doctor.facts import FINE, UNRESOLVED  # noqa: E402
from mhri.doctor.gui.doctor_page import DoctorPage  # noqa: E402
from mhri.doctor.judgement import diagnose  # noqa: E402
from mhri.drill.gui.faults_page import FaultsPage  # noqa: E402
from mhri.drill.page import TEMPLATE, values_of  # noqa: E402
from mhri.drill.rehearsal import Rehearsal  # noqa: E402
from mhri.graph.ros.resources import resource_path  # noqa: E402
from mhri.map.gui.map_pane import MapPane  # noqa: E402
from mhri.session.gui.note_bar import note_button  # noqa: E402
from mhri.session.gui.record_button import RecordButton  # noqa: E402
from support import doctor_world, layout_pictures  # noqa: E402
from support.drills import drill, NAMES  # noqa: E402

DOCTOR_SIZE, FAULTS_SIZE, ONE_SIZE = (760, 420), (440, 720), (1280, 720)


def draw_doctor(path):
    """Draw what the doctor says of a robot whose address the host does not know."""
    world = doctor_world.World()
    for spoil in (doctor_world.answer(state=UNRESOLVED, host='bot1-laptop'),
                  doctor_world.parameter(bot1={})):
        spoil(world)
    page = DoctorPage()
    theme.apply(page, theme.DARK)
    page.setContentsMargins(8, 8, 8, 8)
    page.resize(*DOCTOR_SIZE)
    # What is fine with this computer is invented, and says little.
    page.show_findings([item for item in diagnose(
        world.facts(), doctor_world.TYPES, doctor_world.IGNORE)
        if item.severity != FINE or item.about != 'this computer'], 0.4)
    page.show()
    QApplication.processEvents()
    page.grab().save(path)


def draw_faults(path):
    """Draw the list of faults, two of which a robot has."""
    page = FaultsPage()
    theme.apply(page, theme.DARK)
    page.setContentsMargins(8, 8, 8, 8)
    page.resize(*FAULTS_SIZE)
    page.show_robots(('bot1', 'bot2'))
    page.show_answer('bot1', True, 'bot1: delay each way 0.4 s, 7 s left; laser silent')
    page.show()
    QApplication.processEvents()
    page.grab().save(path)


def draw_drill(name, path):
    """Draw the way of the scripted operator through a drill, with a slow link."""
    scenario, plan, bodies = drill(name)
    result = Rehearsal(scenario, plan, bodies, delay_s=0.2).run()
    picture = re.search('<svg.*</svg>', page(resource_path('pages'), TEMPLATE, values_of(
        result, plan.walls.tolist(), scenario.targets)), re.DOTALL)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(picture.group().replace('<svg', '<svg xmlns="http://www.w3.org/2000/svg"')
                   + '\n')


def draw_one(application, path):
    """Draw the screen with one robot: a picture that is bound by its height."""
    layout_pictures.Scene.frames = layout_pictures.frames()
    scene = layout_pictures.Scene(application, resource_path(), ONE_SIZE, 1)
    scene.screen.drawer_button.setChecked(False)
    scene.screen.stage.set_map(MapPane(scene.screen.stage))
    for place, button in enumerate((RecordButton, note_button), 1):
        scene.screen.small_row.insertWidget(place, button(scene.screen.foot))
    scene.show().grab().save(path)


def main(folder):
    """Draw all of them, in the style that needs no desktop."""
    application = QApplication([sys.argv[0], '-style', 'Fusion'])
    draw_doctor(os.path.join(folder, 'doctor.png'))
    draw_faults(os.path.join(folder, 'faults.png'))
    for name in NAMES:
        draw_drill(name, os.path.join(folder, 'drill_{}.svg'.format(name)))
    draw_one(application, os.path.join(folder, 'one.png'))


if __name__ == '__main__':
    main(sys.argv[1])
    if 'SERVER' in globals():
        SERVER.terminate()
