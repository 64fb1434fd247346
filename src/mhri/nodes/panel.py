# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``panel``: runs in rqt if that is installed, else in a separate window."""
import argparse
import os
import shutil
import sys

from python_qt_binding.QtCore import qInstallMessageHandler, QtFatalMsg
from python_qt_binding.QtWidgets import QApplication
import rospy

from mhri.graph.ros import log
from mhri.graph.ros.master_api import master_uri, MasterError
from mhri.graph.ros.rospy_inside import name_in
from mhri.standalone import Standalone

PLUGIN = 'mhri.mhri_plugin.MhriPlugin'


def parse(argv):
    """Return the options of a command line without ROS remappings."""
    parser = argparse.ArgumentParser(prog='panel', description='The operator\'s panel of mhri.')
    parser.add_argument('--gui', choices=('auto', 'rqt', 'standalone'), default='standalone',
                        help='where to show it; auto: in rqt where that is installed')
    parser.add_argument('--robots', default='', help='names to add at start, separated by spaces')
    parser.add_argument('--select', default='', help='names to add and select at start')
    parser.add_argument('--settings', help='JSON file for the settings, instead of the user\'s own')
    parser.add_argument('--fresh', action='store_true',
                        help='begin without the saved settings but for the numbers of robots, and '
                             'keep them until robots or mode are changed')
    parser.add_argument('--simulated', action='store_true',
                        help='the robots are simulated: settings of their own, without robots')
    parser.add_argument('--replay', help='show the replay of this session or bag; it is played by '
                                         'mhri_replay, on a master of its own')
    parser.add_argument('--demo', action='store_true',
                        help='play a scripted drive without hands, then end')
    parser.add_argument('--screenshot', help='with --demo: write a picture (PNG) of the screen to '
                                             'this file, and five more beside it')
    parser.add_argument('--demo-result',
                        help='with --demo: write "ok", or the reason why not, to this file')
    return parser.parse_args(argv)


def start_qt(argv):
    """Return the application; without a display exit with the reason, where Qt would abort."""
    said = []

    def hear(kind, _, text):
        said.append(text)
        if kind == QtFatalMsg:
            where = [os.environ[key] for key in ('WAYLAND_DISPLAY', 'DISPLAY')
                     if os.environ.get(key)]
            print('the panel cannot start: it needs a screen, and {}; start it on a desktop, or '
                  'by "ssh -X"'.format('that of DISPLAY={} cannot be used: {}'.format(
                      where[-1], said[0]) if where else 'DISPLAY is not set'),
                  file=sys.stderr, flush=True)
            os._exit(1)
    before = qInstallMessageHandler(hear)
    try:
        return QApplication(argv)
    finally:
        qInstallMessageHandler(before)


def main():
    """Run the panel until it is closed; the exit status is the demo's, else 0."""
    options = parse(rospy.myargv(sys.argv)[1:])
    name_in()
    in_rqt = options.gui == 'rqt' or options.gui == 'auto' and shutil.which('rqt')
    if in_rqt and not (options.demo or options.replay):
        if not shutil.which('rqt'):
            sys.exit('the panel cannot start: rqt is not installed; leave out gui:=rqt')
        remappings = [arg for arg in sys.argv[1:] if ':=' in arg]
        extra = ['--robots', options.robots] * bool(options.robots) + [
            flag for flag in ('--fresh', '--simulated') if getattr(options, flag[2:])]
        extra = ['--args', *extra] * bool(extra)
        os.execvp('rqt', ['rqt', '--standalone', PLUGIN] + remappings + extra)
    # The screen logs on the GUI thread, and may wait for a master for hours.
    log.install(lives_on=True)
    try:
        master_uri()
    except MasterError as error:
        sys.exit('the panel cannot start: {}'.format(error))
    app = start_qt(sys.argv[:1])
    if options.replay:
        sys.exit(replay(app, options.replay))
    program = Standalone(sys.argv, options.settings, remember=not options.demo,
                         simulated=options.simulated)
    if not options.demo:
        program.restore(afresh=options.fresh)
    program.window.show()
    program.presenter.start(options.robots.split(), options.select.split())
    if options.fresh and not options.demo:
        program.begin_afresh()
    demo = start_demo(program, options) if options.demo else None
    program.run(app)
    sys.exit(demo.exit_status if demo else 0)


def replay(app, path):
    """Show a replay until its window is closed; return the exit status, or the error text."""
    from mhri.recording.folder import NotASession
    from mhri.standalone import make_replay
    try:
        program = make_replay(sys.argv, path)
    except NotASession as error:
        return 'cannot show the replay: {}'.format(error)
    program.window.showMaximized()
    program.presenter.start()
    program.run(app)
    return 0


def start_demo(program, options):
    """Start the scripted drive in a running program."""
    from mhri.screen.presenters.demo import Demo
    demo = Demo(program, options.screenshot, options.demo_result)
    demo.start()
    return demo
