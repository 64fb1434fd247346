# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of mhri's own nodes: the mux, operators, topics reserved to one node."""
from typing import Iterable, List

from mhri.base.text import listed
from mhri.doctor.facts import (
    Facts, FAULT, Finding, FINE, LISTENED_S, SILENT, Stream, SYSTEM, WARNING)
from mhri.doctor.host import use_other

MODE, STATE, SELECT = '/mux/mode', '/mux/state', '/robot_controller/robot_select'
STICK = '/mux_in/joy'
# The mux publishes its state at 2 Hz; with an older stamp it hangs [s].
STATE_OLD_S = 1.5
_MUX_ALONE = ((STATE, 'its decisions'), ('/robot_controller/stop_all', 'stop all'),
              ('/robot_controller/twist', 'the operator\'s velocity'))
_NOTHING = 'robots are selected, the stick is moved, and nothing happens'
_START = 'rosrun mhri mux'


def find_on_system(facts: Facts) -> List[Finding]:
    """Return the findings about the nodes on the host."""
    found = _mux(facts) + _said(facts) + _operators(facts) + _sim_time(facts)
    if all(item.severity == FINE for item in found):
        operators = _publishers(facts, SELECT)
        found.append(Finding(FINE, 'system', SYSTEM, 'one mux ({}), {}'.format(
            listed(muxes(facts)), 'one operator ({})'.format(operators[0]) if operators
            else 'no operator now')))
    return found


def _publishers(facts: Facts, topic: str) -> List[str]:
    """Return the nodes that publish a topic, without those that do not respond."""
    return [node for node in facts.graph.publishers.get(topic, ())
            if node not in facts.nodes or facts.answering(node)]


def muxes(facts: Facts) -> List[str]:
    """Return the names of the running muxes."""
    return _publishers(facts, MODE)


def hung(facts: Facts) -> List[str]:
    """Return the names of the muxes that do not respond, sorted."""
    return sorted(node for node in facts.graph.publishers.get(MODE, ())
                  if node in facts.nodes and facts.nodes[node].state == SILENT)


def _silent(facts: Facts) -> List[Finding]:
    """Report muxes that hang."""
    words = '{} hangs: it is listed, but does not answer, so nothing reaches the robots'
    remedy = "on {}: pkill -KILL -f '^[^ ]*python[^ ]* .*__name:={}( |$)'   # its launch file " \
        'starts it again; if none does: ' + _START
    return [Finding(FAULT, 'mux_silent', SYSTEM, words.format(name), _NOTHING + '; robots stand',
                    remedy.format(facts.nodes[name].host, name.rpartition('/')[2]))
            for name in hung(facts)]


def _mux_missing(facts: Facts) -> Finding:
    """Report that no mux runs; if another master has one, this may be the wrong master."""
    if facts.master.elsewhere:
        return Finding(
            FAULT, 'mux_missing', SYSTEM, 'no mux runs at the master {}, but one does at {}: is '
            'this the right master?'.format(facts.master.uri, listed(facts.master.elsewhere)),
            _NOTHING + '; or robots of the other master are not found',
            '{}   # or, if this one is right: {}'.format(use_other(facts.master), _START))
    return Finding(
        FAULT, 'mux_missing', SYSTEM, 'no mux runs: nothing drives robots', _NOTHING,
        _START + '   # or everything: roslaunch mhri mhri.launch')


def _end_all_but(kept: str, names: Iterable[str]) -> str:
    """Return the command that ends all but one of several nodes; the usual name stays."""
    return 'rosnode kill {}'.format(' '.join(sorted(names, key=lambda name: name != kept)[1:]))


def _mux(facts: Facts) -> List[Finding]:
    """Check the number of muxes, and report other publishers of their topics."""
    running = muxes(facts)
    found = _silent(facts)
    if facts.mux_error:
        found.append(Finding(
            WARNING if running else FAULT, 'mux_config_bad', SYSTEM, 'the mux cannot start{}: '
            '{}'.format(' again' if running else '', facts.mux_error), _NOTHING,
            'fix the file named above, then: ' + _START))
    if not running and not found:
        found.append(_mux_missing(facts))
    if len(running) > 1:
        found.append(Finding(
            FAULT, 'mux_several', SYSTEM, '{} muxes run: {}'.format(len(running), listed(running)),
            'robots twitch: each contradicts what the other sends; stop all reaches one of them',
            _end_all_but('/mux', running)))
    for topic, words in _MUX_ALONE:
        foreign = [node for node in _publishers(facts, topic) if node not in running]
        if foreign:
            found.append(Finding(
                FAULT, 'mux_bypassed', SYSTEM, '{} publishes {} ({}), which is the mux\'s '
                'alone'.format(listed(foreign), topic, words),
                'no robot moves by it; a program that accepts it shows or does the wrong thing',
                'rosnode kill {}   # unknown program? see "Security" in the guide'.format(
                    ' '.join(foreign))))
    return found


def _said(facts: Facts) -> List[Finding]:
    """Check the state that each mux publishes."""
    running = muxes(facts)
    return [item for stream in facts.streams if stream.topic == STATE and stream.node in running
            for item in _heard(facts, stream)]


def _heard(facts: Facts, stream: Stream) -> List[Finding]:
    """Check the state of one mux."""
    found = []
    # The clock of another computer may be off; complete silence is detected without it.
    comparable = not facts.is_remote(facts.nodes[stream.node]) \
        and facts.graph.parameters.get('use_sim_time') is not True
    old = comparable and any(received - stamp > STATE_OLD_S
                             for received, stamp in stream.samples[-1:])
    if stream.listened_s > LISTENED_S and (old or not stream.messages):
        found.append(Finding(
            FAULT, 'mux_silent', SYSTEM, '{} answers, but does not publish its state any '
            'more'.format(stream.node), _NOTHING + '; robots stand',
            'rosnode kill {}   # its launch file starts it again; if none does: {}'.format(
                stream.node, _START)))
    there = set(facts.graph.nodes())
    refused = [line for line in stream.refused if line.partition(':')[0] in there]
    if refused:
        found.append(Finding(
            WARNING, 'mux_refused', SYSTEM, 'the mux refuses {}'.format(
                listed(refused)), 'that program does not drive, though it may seem to',
            'rosnode info {}   # a second panel: close it, or take control there; unknown program: '
            'see "Security" in the guide'.format(refused[0].partition(':')[0])))
    return found


def _operators(facts: Facts) -> List[Finding]:
    """Check the number of programs that select robots, or publish the virtual joystick."""
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
                len(sticks), STICK, listed(sticks)), 'one drives, the others are refused',
            'rosnode kill {}'.format(' '.join(
                [node for node in sticks if node not in panels] or sticks[1:]))))
    return found


def _sim_time(facts: Facts) -> List[Finding]:
    """Report simulated time without a publisher."""
    if facts.graph.parameters.get('use_sim_time') is not True or _publishers(facts, '/clock'):
        return []
    return [Finding(
        FAULT, 'sim_time', SYSTEM, 'use_sim_time is set, but nothing publishes /clock',
        'time stands still: nodes hang at their start, stamps are zero, nothing is sent at a rate',
        'rosparam delete /use_sim_time   # then start all nodes again; or play the bag with '
        '--clock')]
