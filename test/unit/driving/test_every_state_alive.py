# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each property of the search over every state is alive: rules that are wrong on purpose are found.

A row is the module, its text and what stands there instead, the scene, and further events behind a
way of its own to begin with.
"""
import collections
import importlib

from play_guard import load
import pytest
from test_every_state import (
    DRIVING, FLIPPING, ON_TASK, PADDING, PROVING, recovers, RESTING, SCENES, search, SEEING,
    STOPPED)

from support.driving_world import GUARD, GUARD_PATH
from support.every_state import Violation
from support.mutated import changed, changed_module, mutated

MOST = 4000
BEHIND_B = ('wait 1', 'wish b ', 'stick b rest', 'wish a ', 'take a', 'wish a gp')
CHANGES = [
    ('accessory_rule', 'SILENT_S = 0.25', 'SILENT_S = 0.45', 'tools', FLIPPING),
    ('accessory_rule', 'self._released = at_rest or not self.waits(now)', 'self._released = True',
     'tools', FLIPPING + ('stop -',)),
    ('accessory_rule', 'self._asked_at, self._sent_at = now, -math.inf',
     'self._asked_at = self._sent_at = -math.inf', 'tools', FLIPPING + ('restart -',)),
    ('accessories', 'or self.stands(name, key, by):', 'or False:', 'tools', FLIPPING),
    ('accessories', '        if not authority.undertaken:\n            return UNDERTAKER\n', '',
     'tools', FLIPPING + ('undertaker 0',)),
    ('drive', 'if not task and caller != self.lease.operator:', 'if False:', 'tools',
     FLIPPING + ('wish b gp', 'take b', 'wait 1')),
    ('accessories', 'if held and by == OPERATOR or', 'if', 'tools', FLIPPING),
    ('arbiter', '(DRIVING, SILENT): (WAIT_NEUTRAL, ZEROS)', '(DRIVING, SILENT): (IDLE, NOTHING)',
     'stops', DRIVING),
    ('arbiter', '(READY, PRESSED): (WAIT_NEUTRAL, LATER_ZERO)',
     '(READY, PRESSED): (DRIVING, COMMAND)', 'sources', PADDING),
    ('arbiter', '(DRIVING, RESTS): (READY, ZEROS)', '(DRIVING, RESTS): (READY, NOTHING)', 'stops',
     DRIVING),
    ('arbiter', '(STOPPED, HOLD): (STOPPED, ZEROS)', '(STOPPED, HOLD): (WAIT_NEUTRAL, ZEROS)',
     'stops', DRIVING),
    ('arbiter', 'ENABLING_TIMEOUT_S = 0.25', 'ENABLING_TIMEOUT_S = 0.45', 'sources', PADDING),
    ('arbiter', 'if self._state == DRIVING and not self.enabled(now):', 'if False:', 'sources',
     PADDING),
    ('arbiter', 'elif stick.has_dead_man and self._let_go.get(name) != device:', 'elif False:',
     'sources', PADDING),
    ('arbiter', 'if self._selected - before and self._state == DRIVING:', 'if False:', 'stops',
     DRIVING),
    ('arbiter', "if not self._stick.neutral:\n            return 'centre",
     "if False:\n            return 'centre", 'stops', DRIVING),
    ('arbiter', '        self._last.clear()\n', '', 'velocities', RESTING + ('hang say',)),
    ('arbiter', 'exchanged = self._device not in (None, device) and', 'exchanged = False and',
     'velocities', PADDING),
    ('robot_rule', 'JOINING: IF_MOVING', 'JOINING: NEVER', 'robots', DRIVING),
    ('robot_rule', 'IDLE: IF_MOVING', 'IDLE: NEVER', 'robots', ON_TASK),
    ('robot_rule', 'HELD: IF_MOVING', 'HELD: NEVER', 'robots', DRIVING),
    ('robot_rule', 'STOPPED_ALONE: ALWAYS', 'STOPPED_ALONE: NEVER', 'robots', DRIVING),
    ('robot_rule', 'self._stopped, self._alone, self._task_rests = stopped, alone, False',
     'self._stopped, self._alone = stopped, alone', 'robots', ON_TASK),
    ('robot_rule', 'TASK_STALE_S = 0.25', 'TASK_STALE_S = 0.45', 'robots', ON_TASK),
    ('robot_rule', 'if allowed.speed_mps >= self._last.speed_mps:', 'if True:',
     'robots', DRIVING),
    ('robot_rule', '        self._centre = self._centre or self._driven()\n'
     '        return self._settle(now)\n\n    def begin',
     '        return self._settle(now)\n\n    def begin', 'robots', DRIVING),
    ('robot_rule', 'return self._stopped or self._alone',
     'return self._state in (STOPPED, STOPPED_ALONE)', 'robots', ('stop -',)),
    ('operator_lease', 'LEASE_S = 1.5', 'LEASE_S = 1.7',
     'operators', DRIVING + ('mute a', 'stick a out')),
    ('operator_lease', 'RETURN_S = 3.0', 'RETURN_S = 1.5', 'operators', DRIVING),
    ('operator_lease', 'if caller in self._refused or \\\n', 'if False or \\\n', 'operators',
     DRIVING + ('wish b gp', 'gone a', 'wait 32')),
    ('operator_lease', 'self._holder is not None and not caller.is_successor_of(self._holder):',
     'False:', 'operators', DRIVING),
    ('operator_lease', '                self._refuse(replaced)', '                pass',
     'operators',
     DRIVING),
    ('operator_lease', 'return self._chosen if self.state == LEASED else ()', 'return self._chosen',
     'operators', DRIVING + ('mute a', 'wait 32')),
    ('operator_lease', 'self._chosen, self._lapsed, self._empty_at = (), True, now + RETURN_S',
     'self._empty_at = now + RETURN_S', 'operators', DRIVING + ('wish b gp', 'gone a')),
    ('topic_owner', 'return known or not latches', 'return True', 'operators', ()),
    ('topic_owner', 'if self._claimed in there:', 'if False:',
     'operators', BEHIND_B + ('gone a', 'wait 2', 'wish a gp', 'wait 2')),
    ('stopped_alone', 'elif left_out or operator != whose:', 'else:', 'robots',
     DRIVING + ('alone p', 'wait 1')),
    ('drive', '        if not self._undertaken:\n            velocity = ZERO', '        pass',
     'robots', DRIVING),
    ('drive', '        self._take_sources(now)\n        self._apply(now)\n'
     '        self._everybody_joins(now)', '        self._take_sources(now)\n'
     '        self._apply(now)', 'robots', ON_TASK + ('wish b ',)),
    ('drive', 'return not self._pulse.discards_backlog(now)', 'return True', 'stops', DRIVING),
    ('drive', "if not (trusted or self.lease.operator in ('', caller)):", 'if False:', 'operators',
     DRIVING),
    ('drive', 'self._driven.on_selected(name, self._type_limits[name])', 'pass', 'robots',
     ('wait 1', 'wish a gp', 'reopen p 1')),
    ('drive', "self._owners[name].restore(kept['sources'][name])", 'pass', 'operators',
     BEHIND_B + ('restart -', 'wait 6')),
    ('drive', "if kept.get('stop'):", 'if False:', 'stops', DRIVING + ('stop -',)),
    ('drive', "'alone': self._alone.kept()}", "'alone': {}}", 'stops',
     DRIVING + ('alone p', 'restart -')),
    ('drive', '        self._pass_on(self.arbiter.tick(now), now)\n', '', 'stops', DRIVING),
    ('guard', '(session in self._retired, REPLACED)', '(False, REPLACED)', 'link', DRIVING),
    ('guard', 'return issued is not None and now - issued < self._answer_s', 'return True', 'link',
     DRIVING + ('cut g', 'wait 6', 'wait 11', 'wait 11')),
    ('guard',
     '        if now >= self._until:\n            return self._give(ZERO, now)\n        if',
     '        if', 'link', DRIVING + ('cut g',)),
    ('guard', '(session == self._session and number <= self._number, REPEATED)',
     '(False, REPEATED)', 'link', DRIVING),
    ('guard', '            self._issued.clear()', '            pass', 'link',
     DRIVING + ('cut g', 'wait 1')),
    ('guard_link', 'self._number += 1', 'self._number += 0', 'link', ()),
    ('guard_link', 'ECHO_S = 0.35', 'ECHO_S = 0.85', 'link', DRIVING + ('guard killed',)),
    ('guard_link', 'and ours and number <= self._stop_number', 'and ours', 'link', DRIVING),
    ('guard_link', 'if stop:\n            self._stop_number = self._number', 'pass', 'link',
     STOPPED),
    ('robot_rule', 'return self._stopped or self._alone', 'return self._alone', 'stops', DRIVING),
    ('topic_owner', '        if caller in connected:\n            self._displace(caller)\n', '',
     'operators', DRIVING + ('stick b out', 'wish b gp', 'take b', 'wish b gp')),
    ('drive', 'self._driven.select(() if new_holder else robots)', 'self._driven.select(())',
     'robots', DRIVING + ('reopen p 1',)),
    ('drive', '                self._take_sources(now)\n            self._apply(now)',
     '                self._take_sources(now)', 'stops', DRIVING),
    ('stick_brake', 'if asked and not self._asked:\n            self._scan_at = None', 'pass',
     'laser', SEEING),
    ('stick_brake', 'self._seen.clear()\n            self._scan_at = None', 'pass', 'laser',
     SEEING),
    ('sensors.brake', 'SCAN_OLD_S = 0.3', 'SCAN_OLD_S = 0.5', 'laser', SEEING),
    ('sensors.brake', 'if not life.look(', 'if False and life.look(', 'laser', SEEING),
    ('sensors.readings', 'share >= FELL_FROM and', 'False and', 'laser', SEEING),
    ('robots.stop_proof', 'elif now - late_s >= self._counts_from:', 'else:', 'proof', PROVING),
    ('robots.stop_proof', 'if old or late or not self.follows:', 'if late or not self.follows:',
     'proof', PROVING),
    ('robots.stop_proof', 'READINGS = 3', 'READINGS = 2', 'proof', PROVING),
]


@pytest.mark.parametrize('module, old, new, scene, way', CHANGES)
def test_a_wrong_rule_is_found(tmp_path, module, old, new, scene, way):
    if module == 'guard':
        text = tmp_path / 'mhri_guard'
        text.write_text(changed(GUARD_PATH.read_text(), old, new))
        names, other = GUARD, load(str(text))
    else:
        package, _, name = module.rpartition('.')
        real = importlib.import_module('mhri.{}.{}'.format(package or 'driving', name))
        names, other = vars(real), changed_module(real, old, new)
    with mutated(names, other), pytest.raises(Violation) as found:
        search(scene, MOST, collections.Counter(), recovers, [way])
    print(found.value)


@pytest.mark.parametrize('scene, way', sorted({
    row[3:] for row in CHANGES if row[4] not in SCENES[row[3]].ways}))
def test_the_rules_as_they_are_keep_everything_from_there(scene, way):
    """Else a row would say nothing; from the ways of the scenes the whole search begins."""
    search(scene, MOST, collections.Counter(), ways=[way])
