# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor on mhri's own nodes: mux, gates, operators, topics that belong to one node alone."""
from typing import Dict, Iterable, List

from mhri.doctor.facts import (
    Facts, FAULT, Finding, FINE, listed, LISTENED_S, SILENT, Stream, SYSTEM, WARNING)
from mhri.doctor.host import use_other

TWIST, SELECT, MODE = ('/robot_controller/twist', '/robot_controller/robot_select', '/mux/mode')
STOP_ALL, TASK_TWIST = '/robot_controller/stop_all', '/robot_controller/task_twist'
STICK, GATES_STATE = '/mux_in/joy', '/gates/state'
# The gates publish their state at 2 Hz; a stamp older than this means that they hang [s].
STATE_OLD_S = 1.5
_MUX_ALONE = ((TWIST, 'the operator\'s velocity'), (TASK_TWIST, 'the velocities of tasks'),
              (STOP_ALL, 'stop all'))
_NOTHING = 'robots are selected, the stick is moved, and nothing happens'


def find_on_system(facts: Facts) -> List[Finding]:
    """Return the findings about the nodes on the host."""
    found = _mux(facts) + _gates(facts) + _operators(facts) + _sim_time(facts)
    if all(item.severity == FINE for item in found):
        operators = _publishers(facts, SELECT)
        found.append(Finding(FINE, 'system', SYSTEM, 'one mux ({}), one node that speaks to robots '
                             '({}), {}'.format(
                                 listed(muxes(facts)), listed(gates(facts)),
                                 'one operator ({})'.format(operators[0]) if operators
                                 else 'nobody selects robots now')))
    return found


def _publishers(facts: Facts, topic: str) -> List[str]:
    """Return the nodes that publish a topic, without those that do not answer."""
    return [node for node in facts.graph.publishers.get(topic, ())
            if node not in facts.nodes or facts.answering(node)]


def muxes(facts: Facts) -> List[str]:
    """Return the names of the running muxes."""
    return _publishers(facts, MODE)


def gates(facts: Facts) -> List[str]:
    """Return the names of the running gates: they publish their state, and hear the mux."""
    return [node for node in _publishers(facts, GATES_STATE)
            if node in facts.graph.subscribers.get(TWIST, ())]


def hung(facts: Facts) -> Dict[str, str]:
    """Return {name: the topic that identifies it} of mux and gates that do not answer."""
    return {node: topic for topic in (MODE, GATES_STATE)
            for node in facts.graph.publishers.get(topic, ())
            if node in facts.nodes and facts.nodes[node].state == SILENT}


def _silent(facts: Facts, topic: str, check: str, words: str, start: str) -> List[Finding]:
    """Say which publishers of a topic hang."""
    found = []
    for name in sorted(name for name, known_by in hung(facts).items() if known_by == topic):
        found.append(Finding(
            FAULT, check, SYSTEM, '{} hangs: it is listed, but does not answer{}'.format(
                name, words), _NOTHING + '; robots stand',
            "on {}: pkill -KILL -f '^[^ ]*python[^ ]* .*__name:={}( |$)'   # its launch file "
            'starts it again; if none does: {}'.format(
                facts.nodes[name].host, name.rpartition('/')[2], start)))
    return found


def _mux_missing(facts: Facts) -> Finding:
    """Say that no mux runs; if another master has one, this may be the wrong master."""
    nor = '' if gates(facts) else ', and no gates'
    if facts.master.elsewhere:
        return Finding(
            FAULT, 'mux_missing', SYSTEM, 'no mux runs at the master {}{}, but one does at {}: is '
            'this the right master?'.format(facts.master.uri, nor, listed(facts.master.elsewhere)),
            _NOTHING + '; or robots of the other master are not found',
            '{}   # or, if this one is right: rosrun mhri mux'.format(use_other(facts.master)))
    return Finding(
        FAULT, 'mux_missing', SYSTEM, 'no mux runs{}: nothing turns the stick into a '
        'velocity'.format(nor), _NOTHING,
        'rosrun mhri mux   # or everything: roslaunch mhri mhri.launch')


def _end_all_but(wanted: str, names: Iterable[str]) -> str:
    """Return the command that ends all but one of several nodes; the usual name stays."""
    return 'rosnode kill {}'.format(' '.join(sorted(names, key=lambda name: name != wanted)[1:]))


def _mux(facts: Facts) -> List[Finding]:
    """Judge how many muxes there are, and who else speaks in their place."""
    running = muxes(facts)
    found = _silent(facts, MODE, 'mux_silent', ', so no stick and no task reaches the gates',
                    'rosrun mhri mux')
    if facts.mux_error:
        found.append(Finding(
            WARNING if running else FAULT, 'mux_config_bad', SYSTEM, 'the mux cannot start{}: '
            '{}'.format(' again' if running else '', facts.mux_error), _NOTHING,
            'mend the file named above, then: rosrun mhri mux'))
    if not running and not found:
        found.append(_mux_missing(facts))
    if len(running) > 1:
        found.append(Finding(
            FAULT, 'mux_several', SYSTEM, '{} muxes run: {}'.format(len(running), listed(running)),
            'the gates obey one of them alone: the stop or the stick of the other does nothing',
            _end_all_but('/mux', running)))
    for topic, words in _MUX_ALONE:
        foreign = [node for node in _publishers(facts, topic) if node not in running]
        if foreign:
            found.append(Finding(
                FAULT, 'mux_bypassed', SYSTEM, '{} publishes {} ({}), which is the mux\'s '
                'alone'.format(listed(foreign), topic, words),
                'the gates refuse it; a program that believes it shows or does the wrong thing',
                'rosnode kill {}   # nobody knows it? see "Security" in the guide'.format(
                    ' '.join(foreign))))
    return found


def _gates(facts: Facts) -> List[Finding]:
    """Judge the node that speaks to robots: how many there are, whether it lives, what it says."""
    running = gates(facts)
    found = _silent(facts, GATES_STATE, 'gates_silent', ': nothing speaks to robots',
                    'rosrun mhri gates')
    # If nothing of mhri runs, the finding about the mux says so, once.
    if not running and not found and facts.graph.publishers.get(MODE):
        found.append(Finding(
            FAULT, 'gates_missing', SYSTEM, 'no gates run: nothing speaks to robots', _NOTHING,
            'rosrun mhri gates   # or everything: roslaunch mhri mhri.launch'))
    if len(running) > 1:
        found.append(Finding(
            FAULT, 'gates_several', SYSTEM, '{} gates run: {}'.format(
                len(running), listed(running)),
            'robots twitch: each contradicts what the other sends',
            _end_all_but('/mhri_gates', running)))
    foreign = [node for node in _publishers(facts, GATES_STATE) if node not in running]
    if foreign:
        found.append(Finding(
            FAULT, 'gates_bypassed', SYSTEM, '{} publishes {}, which is the gates\' alone'.format(
                listed(foreign), GATES_STATE), 'the screen shows things that no robot does',
            'rosnode kill {}'.format(' '.join(foreign))))
    for stream in facts.streams:
        if stream.topic == GATES_STATE and stream.node in running:
            found += _heard(facts, stream)
    return found


def _heard(facts: Facts, stream: Stream) -> List[Finding]:
    """Judge what the gates say about themselves."""
    found = []
    # The clock of another computer may be off; but complete silence shows by any clock.
    comparable = not facts.is_remote(facts.nodes[stream.node]) \
        and facts.graph.parameters.get('use_sim_time') is not True
    old = comparable and any(received - stamp > STATE_OLD_S
                             for received, stamp in stream.samples[-1:])
    if stream.listened_s > LISTENED_S and (old or not stream.messages):
        found.append(Finding(
            FAULT, 'gates_silent', SYSTEM, '{} answers, but does not publish its state any '
            'more'.format(stream.node), _NOTHING + '; robots stand',
            'rosnode kill {}   # its launch file starts it again; if none does: rosrun mhri '
            'gates'.format(stream.node)))
    there = set(facts.graph.nodes())
    refused = [line for line in stream.refused if line.partition(':')[0] in there]
    if refused:
        found.append(Finding(
            WARNING, 'gates_refused', SYSTEM, 'the gates refuse {}'.format(
                listed(refused)), 'that program does not drive, though it may seem to',
            'rosnode info {}   # a second panel: close it, or take control there; nobody knows it: '
            'see "Security" in the guide'.format(refused[0].partition(':')[0])))
    return found


def _operators(facts: Facts) -> List[Finding]:
    """Judge how many programs select robots, or send the virtual joystick."""
    found = []
    panels, sticks = _publishers(facts, SELECT), _publishers(facts, STICK)
    if len(panels) > 1:
        found.append(Finding(
            WARNING, 'panel_several', SYSTEM, '{} programs select robots: {}'.format(
                len(panels), listed(panels)),
            'one is in control; ticks and stick of the others do nothing until they take control',
            'close all but one, or: {}'.format(_end_all_but(panels[0], panels))))
    if len(sticks) > 1 and not set(sticks) <= set(panels):
        found.append(Finding(
            WARNING, 'stick_several', SYSTEM, '{} programs publish {}: {}'.format(
                len(sticks), STICK, listed(sticks)), 'one of them drives, the others are refused',
            'rosnode kill {}'.format(' '.join(
                [node for node in sticks if node not in panels] or sticks[1:]))))
    return found


def _sim_time(facts: Facts) -> List[Finding]:
    """Judge simulated time that nobody publishes."""
    if facts.graph.parameters.get('use_sim_time') is not True or _publishers(facts, '/clock'):
        return []
    return [Finding(
        FAULT, 'sim_time', SYSTEM, 'use_sim_time is set, but nobody publishes /clock',
        'time stands still: nodes hang at their start, stamps are zero, nothing is sent at a rate',
        'rosparam delete /use_sim_time   # then start all nodes again; or play the bag with '
        '--clock')]
