# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor on mhri's own nodes: panel, mux, topics that one node alone may publish."""
from mhri.core.doctor.facts import FAULT, FINE, Finding, listed, SYSTEM
from mhri.core.doctor.host import use_other

TWIST, SELECT, MODE = ('/robot_controller/twist', '/robot_controller/robot_select', '/mux/mode')
STOP_ALL = '/robot_controller/stop_all'


def find_on_system(facts):
    """Return the findings about the nodes on the host."""
    found = _mux(facts) + _panels(facts) + _sim_time(facts)
    if all(item.severity == FINE for item in found):
        panels = _publishers(facts, SELECT)
        found.append(Finding(FINE, 'system', SYSTEM, 'one mux ({}), {}'.format(
            listed(muxes(facts)),
            'one panel ({})'.format(panels[0]) if panels else 'no panel runs now')))
    return found


def _publishers(facts, topic):
    """Return the nodes that publish a topic, but for those that do not answer."""
    return [node for node in facts.graph.publishers.get(topic, ())
            if node not in facts.nodes or facts.answering(node)]


def muxes(facts):
    """Return the names of the muxes that run."""
    return _publishers(facts, MODE)


def _mux_missing(facts):
    """Say that no mux runs; where another master has one, this may be the wrong master."""
    nothing = 'robots are selected, the stick is moved, and nothing happens'
    if facts.master.elsewhere:
        return Finding(
            FAULT, 'mux_missing', SYSTEM, 'no mux runs at the master {}, but one does at {}: is '
            'this the right master?'.format(facts.master.uri, listed(facts.master.elsewhere)),
            nothing + '; or robots of the other master are not found',
            '{}   # or, if this one is right: rosrun mhri mux'.format(use_other(facts.master)))
    return Finding(
        FAULT, 'mux_missing', SYSTEM, 'no mux runs: nothing turns the stick into a velocity',
        nothing, 'rosrun mhri mux   # or everything: roslaunch mhri mhri.launch')


def _mux(facts):
    """Judge how many muxes there are, and who else speaks in their place."""
    running = muxes(facts)
    found = [] if running else [_mux_missing(facts)]
    if len(running) > 1:
        found.append(Finding(
            FAULT, 'mux_several', SYSTEM, '{} muxes run: {}'.format(len(running), listed(running)),
            'robots twitch: each mux sends velocities of its own, and stop all of one does not '
            'hold the other', 'rosnode kill {}'.format(' '.join(
                sorted(running, key=lambda name: name != '/mux')[1:]))))
    for topic, words in ((TWIST, 'the one velocity command'), (STOP_ALL, 'stop all')):
        foreign = [node for node in _publishers(facts, topic) if node not in running]
        if foreign:
            found.append(Finding(
                FAULT, 'mux_bypassed', SYSTEM, '{} publishes {} ({}), which is the mux\'s '
                'alone'.format(listed(foreign), topic, words),
                'selected robots move without the stick, or a stop is taken back',
                'rosnode kill {}'.format(' '.join(foreign))))
    return found


def _panels(facts):
    """Judge how many panels select robots."""
    panels = _publishers(facts, SELECT)
    if len(panels) < 2:
        return []
    return [Finding(
        FAULT, 'panel_several', SYSTEM, '{} panels select robots: {}'.format(
            len(panels), listed(panels)),
        'robots are selected and deselected by themselves',
        'close all but one, or: rosnode kill {}'.format(' '.join(panels[1:])))]


def _sim_time(facts):
    """Judge simulated time without anybody who tells it."""
    if facts.graph.parameters.get('use_sim_time') is not True or _publishers(facts, '/clock'):
        return []
    return [Finding(
        FAULT, 'sim_time', SYSTEM, 'use_sim_time is set, but nobody publishes /clock',
        'time stands still: nodes hang at their start, stamps are zero, nothing is sent at a rate',
        'rosparam delete /use_sim_time   # then start all nodes again; or play the bag with '
        '--clock')]
