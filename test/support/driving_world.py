# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A world around the real ``Drive``, for the search over every state that it can reach.

Two operators, two sources, and two robots: ``p`` is plain and keeps its last velocity, ``g`` is
guarded by the guard's real rule with the real ``GuardLink`` in between. Everything that can happen
is a method ``do_<event>``; what it means for the contract is noted there, too.
"""
import json
import math
from pathlib import Path

from play_guard import load

from mhri.base.limits import Velocity, ZERO
from mhri.devices.profile import Asked, Stick, STOP_ALL
from mhri.driving.drive import Drive
from mhri.driving.guard_link import GuardLink
from mhri.driving.operator_lease import Caller
from mhri.driving.sources import MuxConfig, Source, TWIST
from mhri.driving.topic_owner import LiveMessages
from support.driving_contract import (
    ANSWER_S, DEAF_S, LIMITS, LOST_S, NEUTRAL, OPERATORS, ROBOTS, SETTINGS, STEP_S, TASK_STALE_S)
from support.driving_tools import Tools

GUARD_PATH = Path(__file__).resolve().parents[2] / 'utils' / 'remote' / 'mhri_guard'
GUARD = load(str(GUARD_PATH))
# What a stick says: at rest or out; with its dead-man button released: free or loose.
PAD = {'rest': Stick(0.0, 0.0, True, True, True), 'out': Stick(1.0, 0.0, False, True, True),
       'free': Stick(0.0, 0.0, True, False, True), 'loose': Stick(0.0, 0.0, False, False, True)}
JOY = {'rest': Stick(0.0, 0.0, True), 'out': Stick(1.0, 0.0, False)}
JOY['free'] = JOY['rest']
VELOCITIES = {'rest': Asked(ZERO), 'out': Asked(Velocity(0.3, 0.0))}
TASK = 0.2, 0.0, 0.0, 0.0, 0.0, 0.0


class World(Tools):
    """One state: the real objects, what is around them, and the facts of the contract.

    :param options: ``enabling`` (there is a pedal), ``twist`` (the operators' source is of
        velocities, and silent at rest, and the pad has no dead-man button), ``automatic`` (a
        touched source becomes the active one), ``eye`` (the brake of p sees by a laser, and a asks
        for it), ``proof`` (the stop of p is proven by its odometry), ``tool`` (p has a flipper)
    :param premises: counts how often each demand alone kept something from moving
    """

    def __init__(self, options, premises):
        super().__init__(options, premises)
        self.run, self.guard_run, self.foreign_run = 0, 0, 0
        kind = {'kind': TWIST} if 'twist' in options else {}
        self.config = MuxConfig(
            (Source('joy', 'joy', '/joy', None, **kind), Source('pad', 'pad', '/pad', None))
            + ((Source('pedal', 'pedal', '/pedal', None),) if 'enabling' in options else ()),
            'joy', *SETTINGS['a'].limits, 'pedal' if 'enabling' in options else None,
            'automatic' in options)
        # What is around the drive.
        self.uris, self.there = {'a': 0, 'b': 0}, {'a': 'off', 'b': 'off'}
        self.links, self.wishes = {'a': 0, 'b': 0}, {'a': '', 'b': ''}
        self.words = {'a': 'off', 'b': 'off', 'pad': 'off', 'pedal': 'off'}
        self.plug, self.wall = 0, False
        self.cut, self.held = dict.fromkeys(ROBOTS, False), dict.fromkeys(ROBOTS, False)
        self.cut_at, self.queue = {}, dict.fromkeys(ROBOTS, ())
        self.last_command, self.echoes = (), []
        self.given = dict.fromkeys(ROBOTS, tuple(ZERO))
        self.guarded, self.guard_there, self.twins, self.lossy = False, True, set(), False
        self.guard = GUARD['Guard']('r0')
        self._begin(None)

    def _begin(self, kept):
        """Start a drive, with the lines that it has to the robots."""
        self.live = LiveMessages()
        self.drive = Drive(self.config, self.now, kept, connected=self._connected)
        self.link, self.guarded = GuardLink('d{}'.format(self.run)), False
        for name in ROBOTS:
            self.held[name] = False
            self._open(name, LIMITS[0])

    def _open(self, name, limits):
        orders = self.drive.open(name, limits, self.now,
                                 self._brake if name == 'g' else self.allow,
                                 self.tools if name == 'p' else ())
        if name == 'g':
            self.rule_g = self.drive.robots['g']
        else:
            self._see_anew()
        self._carry_out(orders)
        self._join(name)

    def _connected(self, source):
        return {'/' + name for name in OPERATORS if self.there[name] != 'off'} \
            if source == 'joy' else {'/' + source}

    def _brake(self, velocity, _):
        return ZERO if self.wall and velocity.linear_mps > 0.0 else velocity

    # What happens. Each returns False where it cannot.

    def do(self, event):
        """Let an event happen, such as "stick a out"; return False if nothing has."""
        what, *words = event.split()
        before = self.drive.mode
        if getattr(self, 'do_' + what)(*words) is False:
            return False
        self._follow(before)
        self._follow_brake()
        self._judge()
        return True

    def do_wait(self, steps):
        """Let time pass while everybody repeats what it says."""
        for number in range(int(steps)):
            self._pass_time(number)
            before = self.drive.mode
            self._tell(self.drive.tick, self._there())
            # Of what was due something may still be: numbers are rounded.
            again = self.drive.next_tick(self.now)
            self._claim('is called again and again', again > self.now - 1e-6)
            self._look_at_lines(number)
            self._follow_brake()
            self._note_guard()
            if number % 2:
                self._sense()
                self._use()
                for who, word in self.words.items():
                    if word != 'off' and not (word == 'rest' and who in OPERATORS
                                              and 'twist' in self.options):
                        self._say(who)
            if number % 10 == 0:
                for name in OPERATORS:
                    if self.there[name] == 'on':
                        self._wish(name)
            self._follow(before)
            self._judge()

    def do_hang(self, first):
        """The drive is stopped for a while; what it finds then is old."""
        for number in range(12):
            self._pass_time(number)
        self._forget_sources()
        self._end_tools()
        self.deaf_until = self.now + DEAF_S
        self.task_free = dict.fromkeys(ROBOTS, False)
        if first == 'tick':
            self._tell(self.drive.tick, self._there())
        for who, word in self.words.items():
            if word != 'off':
                self._say(who)
        self._use()
        self._tell(self.drive.tick, self._there())

    def _pass_time(self, number):
        self.now = round(self.now + STEP_S, 3)
        if self.guard_there:
            self._give(self.guard.tick(self.now))
            if number % 2 == 0:
                self._echo()

    def do_stick(self, who, word):
        """A stick is moved, or falls silent."""
        if self.words[who] == word or self.there.get(who) == 'off' or (
                who == 'pedal' and 'enabling' not in self.options):
            return False
        self.words[who] = word
        return None if word == 'off' else self._say(who)

    def do_button(self, who):
        """Its stop button is pressed, and let go."""
        if self.words[who] == 'off':
            return False
        self._stop()
        self._say(who, {STOP_ALL})
        return self._say(who)

    def do_plug(self, _):
        """The pad is pulled out, and comes back as another device."""
        if self.plug == 2:
            return False
        self.words['pad'], self.plug, self.let_go = 'off', self.plug + 1, False
        self._lose('pad')
        return self._tell(self.drive.on_lost, 'pad', 'lost')

    def do_swap(self, _):
        """Another pad is there, and nobody has noticed."""
        if self.plug == 2 or self.words['pad'] == 'off':
            return False
        self.plug, self.let_go = self.plug + 1, False
        self._lose('pad')
        return self._say('pad')

    def _say(self, who, pressed=frozenset()):
        source, word, before = 'joy' if who in OPERATORS else who, self.words[who], self.drive.mode
        words = PAD if who == 'pad' and 'twist' not in self.options else (
            VELOCITIES if who in OPERATORS and 'twist' in self.options else JOY)
        orders, _ = self.drive.on_source(
            source, '/' + who, who + str(self.plug), lambda _: words[word], self.now, pressed,
            word == 'out')
        if self.now >= self.deaf_until and self.drive.owner(source) == '/' + who:
            self._hear(source, word)
        if self.drive.mode != before:
            self._follow(before)
        self._carry_out(orders)

    def do_wish(self, name, robots=''):
        """An operator selects these robots."""
        if self.there[name] == 'on' and self.wishes[name] == robots:
            return False
        if self.there[name] == 'off':
            self._connect(name)
        self.there[name], self.wishes[name] = 'on', robots
        return self._wish(name)

    def do_mute(self, name):
        """An operator hangs: it is connected, and silent."""
        if self.there[name] != 'on':
            return False
        self.there[name] = 'mute'
        return self.do_stick(name, 'off') and None

    def do_latch(self, name):
        """It is connected anew, and what it wished once comes first."""
        if self.there[name] == 'off':
            return False
        return self._connect(name, 'gp')

    def _connect(self, name, past=''):
        self.links[name] = 1 - self.links[name]
        self._wish(name, past, live=False)

    def _wish(self, name, robots=None, live=True, uri=None):
        """Send a wish; whether it is alive is for the drive to find out."""
        caller = self._caller(name, uri)
        robots = tuple(self.wishes[name] if robots is None else robots)
        if not self.live.is_live(caller, self.links[name], True):
            return
        count, settings = self.drive.wishes, SETTINGS[name]._replace(brake=name in self.brakes)
        orders, _ = self.drive.on_wish(caller, robots, (settings,), '', self.now)
        accepted = self.drive.wishes > count
        if not live and accepted:
            self._claim('a message of the past counts', False)
        if accepted:
            self._take_in_wish(caller, robots, settings)
        elif caller not in self.refused:
            self.refused.add(caller)
        self._settle_owners()
        self._carry_out(orders)

    def _caller(self, name, uri=None):
        return Caller('/' + name, 'uri{}'.format(self.uris[name] if uri is None else uri), 'host')

    def _there(self):
        return [self._caller(name) for name in OPERATORS if self.there[name] != 'off']

    def do_gone(self, name):
        """An operator's process ends."""
        if self.there[name] == 'off':
            return False
        self.there[name] = self.words[name] = 'off'
        return self._leave(self._caller(name))

    def _leave(self, caller):
        self.live.forget(caller)
        if caller == self.holder:
            self._end_wish()
        self._tell(self.drive.on_gone, caller)

    def do_again(self, name):
        """An operator is started anew, and its end is noticed later than that."""
        if self.there[name] == 'off' or self.uris[name]:
            return False
        old = self._caller(name)
        self.words[name], self.uris[name] = 'off', 1
        self._connect(name)
        self.there[name], self.wishes[name] = 'on', ''
        self._wish(name)
        self._leave(old)
        return True

    def do_old(self, name):
        """The process before it still speaks."""
        if not self.uris[name]:
            return False
        return self._wish(name, 'gp', uri=0)

    def do_take(self, name):
        """An operator takes control."""
        if self.there[name] == 'off':
            return False
        caller, orders = self._caller(name), self.drive.on_take(self._caller(name), self.now)
        self._take_over(caller)
        self._settle_owners()
        return self._carry_out(orders)

    def do_mode(self, name, mode):
        """A node asks for another source."""
        before = self.drive.mode
        orders, _ = self.drive.on_mode('/' + name, mode, self.now)
        if self.holder is not None and self.holder.name != '/' + name:
            self._claim('a mode of another', self.drive.mode == before)
        self._follow(before)
        self._carry_out(orders)

    def do_stop(self, _):
        """Stop-all is asked for."""
        self._stop()
        self._tell(self.drive.on_stop)

    def _stop(self):
        self.stopped, self.task_free = True, dict.fromkeys(ROBOTS, False)
        self._ask_for_neutral()
        self._begin_proof()

    def do_release(self, _):
        """Its release is asked for."""
        if not self.stopped:
            return False
        orders, problem = self.drive.on_release(self.now)
        if not problem:
            self._claim('released with the stick out',
                        self.last[self.drive.mode] in NEUTRAL + ('off',))
            self.stopped, self.foreign, self.proof_at = False, False, None
            self._ask_for_neutral()
        return self._carry_out(orders)

    def do_alone(self, name):
        """One robot is stopped."""
        chosen = self.wish if self.wish else ()
        self.alone[name] = self.holder.name if self.holder else '', name not in chosen
        self.task_free[name] = False
        self._tell(self.drive.on_stop_robots, [name])

    def do_hold(self, cause):
        """The master is lost, say."""
        self._end_tools()
        self._ask_for_neutral()
        self._tell(self.drive.on_hold, cause)

    def do_undertaker(self, alive):
        """The process that stands by dies, or is there again."""
        if self.undertaken == bool(int(alive)):
            return False
        self.undertaken = bool(int(alive))
        self._ask_for_neutral()
        self.task_free = dict.fromkeys(ROBOTS, False)
        return self._tell(self.drive.on_undertaker, self.undertaken)

    def do_restart(self, _):
        """The drive is killed, and the next one knows what that one has kept."""
        if self.run == 2:
            return False
        self.run += 1
        self.task_at = {}
        self._end_tools()
        self.tool_moves, self.tool_at = False, -math.inf
        self._forget_sources()
        self._end_wish()
        self.gone_at, self.undertaken, self.deaf_until = None, True, -math.inf
        self.owners, self.let_go = {'joy': None, 'pad': None}, False
        self._begin(json.loads(json.dumps(self.drive.kept())))
        for name in OPERATORS:
            if self.there[name] != 'off':
                self._connect(name, self.wishes[name])
        return True

    def do_task(self, robots=''):
        """The tasks that run say what these robots do."""
        enabled = self._enabled() and self.undertaken
        for name in ROBOTS:
            if name not in robots:
                self.task_free[name] = True
            elif enabled and not self.stopped:
                if self.now - self.task_at.get(name, -math.inf) >= TASK_STALE_S:
                    self.task_free[name] = True
                self.task_at[name] = self.now
        orders, _ = self.drive.on_task(tuple(robots), [TASK] * len(robots), self.now)
        self.tasking = True
        self._carry_out(orders)
        self.tasking = False

    def do_reopen(self, name, limits):
        """A robot is there anew, with other limits."""
        self._carry_out(self.drive.close_robot(name, self.now))
        new = LIMITS[int(limits)]
        self.most[name] = min(new, self.most[name] if name in self.chosen else new,
                              key=lambda limits: limits.linear_mps)
        self.held[name] = False
        if name == 'p':
            self._end_tools()
        self.task_at.pop(name, None)
        self._restless((name,))
        self._open(name, new)

    def do_join(self, name):
        """A robot is heard for the first time."""
        self._restless((name,))
        self.task_free[name] = False
        self._tell(self.drive.on_joined, name)

    def do_twins(self, name, there):
        """Two computers are the same robot, or no more."""
        if (name in self.twins) == bool(int(there)):
            return False
        self.twins ^= {name}
        return self._look_at_lines(1)

    def do_wall(self, there):
        """Something comes into the way of all robots, or leaves it."""
        if self.wall == bool(int(there)):
            return False
        self.wall = bool(int(there))
        return self._tell(self.drive.tick, self._there())

    def do_cut(self, name):
        """What is sent to a robot waits in its link; its echoes are lost."""
        if self.cut[name]:
            return False
        self.cut[name], self.cut_at[name] = True, self.now
        return True

    def do_mend(self, name):
        """All of that arrives, and the link is as before."""
        if not self.cut[name]:
            return False
        while self.queue[name]:
            self.do_deliver(name)
        self.cut[name] = False
        self.cut_at.pop(name)
        self._look_at_lines(1)
        return True

    def do_deliver(self, name, how='once'):
        """The oldest of it arrives (once, or "twice"), or is lost."""
        if not self.queue[name]:
            return False
        (frame_id, velocity, sent), *rest = self.queue[name]
        if how == 'lost':
            self.lossy = True
        else:
            self._arrive(name, frame_id, velocity, sent)
        if how != 'twice':
            self.queue[name] = tuple(rest)
        return True

    def do_repeat(self, _):
        """What the guard has obeyed once comes a second time."""
        if not self.last_command:
            return False
        return self._arrive('g', *self.last_command)

    def do_guard(self, what):
        """The guard is killed, or started anew."""
        if what == 'killed' and self.guard_there:
            self.guard_there, self.foreign = False, False
            self.guard_gone_at = self.now if self.guarded else None
        elif what == 'started' and not self.guard_there and not self.guard_run:
            self.guard_there, self.guard_run, self.guard = True, 1, GUARD['Guard']('r1')
            self.guard_gone_at = None
        else:
            return False
        return True

    def do_foreign(self, _):
        """The drive of another master stops the guarded robot."""
        if not self.guard_there or self.foreign_run:
            return False
        # One that comes while ours is held is told from it by nothing.
        self.foreign, self.foreign_run = not self.guard.stopped, 1
        self._give(self.guard.on_command('x!:1:', tuple(ZERO), self.now)[0])
        return self._echo()

    # The lines to the robots, as mhri.driving.ros.robot_line has them.

    def _tell(self, event, *facts):
        self._carry_out(event(self.now, *facts) if event == self.drive.tick
                        else event(*facts, self.now))

    def _join(self, name):
        self._restless((name,))
        self.task_free[name] = False
        self._carry_out(self.drive.on_joined(name, self.now) or [(name, ZERO)])

    def _carry_out(self, orders):
        self._reselect()
        for name, velocity in self._take_in_acts(orders):
            if not velocity.is_zero():
                self._judge_order(name, velocity)
            if name == 'p' or not (self.guarded or velocity.is_zero()):
                self._send(name, '', velocity)
            elif velocity.is_zero():
                self._send(name, '', velocity)
                self._send_to_guard(velocity)
            else:
                self._send_to_guard(ZERO if self.link.stop_confirmed else velocity)
        while self.echoes:
            self._hear_echo(self.echoes.pop(0))

    def _send_to_guard(self, velocity):
        self._send('g', self.link.next_id(self.rule_g.stopped), velocity)

    def _send(self, name, frame_id, velocity):
        if self.cut[name]:
            self.queue[name] = (self.queue[name] + ((frame_id, velocity, self.now),))[-2:]
        else:
            self._arrive(name, frame_id, velocity, self.now)

    def _arrive(self, name, frame_id, velocity, sent):
        """Let a robot, or its guard, be told something."""
        if not frame_id:
            self.given[name] = tuple(velocity)
            return
        if not self.guard_there:
            return
        latched = self.guard.stopped
        said, fault = self.guard.on_command(frame_id, tuple(velocity), self.now)
        if latched and not self.guard.stopped:
            self._claim('a latched stop', not (
                self.stopped or self.foreign or 'g' in self.alone))
        if not fault:
            self._claim('the word of an older drive', int(frame_id[1]) >= self.newest_run)
            self.newest_run = int(frame_id[1])
            self._claim('a stale command', velocity.is_zero() or self.now - sent < ANSWER_S)
            if not velocity.is_zero():
                self.last_command = frame_id, velocity, sent
            self._echo()
        self._give(said)

    def _give(self, velocity):
        if velocity is not None:
            self.given['g'] = velocity

    def _echo(self):
        said = self.guard.echo_id(self.now)
        if not self.cut['g']:
            self.echoes.append(said)

    def _hear_echo(self, frame_id):
        link, rule = self.link, self.rule_g
        link.on_echo(frame_id, self.now)
        ours = link.speaker.startswith('d{}'.format(self.run))
        if link.stop_confirmed and not (link.stop_is_own or rule.stopped):
            self._stop()
            self._tell(self.drive.on_stop)
        self._look_at_guard()
        if link.displaced:
            self.link = GuardLink('d{}-1'.format(self.run))
            self._join('g')
        if rule.sent.is_zero() and (link.stop_confirmed != rule.stopped
                                    or link.stop_confirmed and not ours):
            self._send_to_guard(ZERO)

    def _look_at_guard(self):
        alive = self.link.alive(self.now)
        if alive != self.guarded:
            self.guarded = alive
            self._join('g')

    def _look_at_lines(self, number):
        while self.echoes:
            self._hear_echo(self.echoes.pop(0))
        self._look_at_guard()
        for name in ROBOTS:
            lost = name in self.twins or (
                self.cut[name] and self.now - self.cut_at[name] >= LOST_S)
            if lost != self.held[name]:
                self.held[name] = lost
                self._restless((name,))
                self.task_free[name] = False
                self._tell(self.drive.on_held, name, 'not_heard' if lost else '')

    def recovers(self):
        """Return whether an operator who does all that can be asked drives both robots again."""
        for event in ('undertaker 1', 'mend g', 'mend p', 'twins p 0', 'wall 0', 'guard started',
                      'wish b gp', 'take b', 'wish b', 'wait 12', 'wish b gp', 'mode b pad',
                      'stick pedal out', 'stick pad free', 'wait 2', 'release -', 'wait 2',
                      'stick pad rest', 'wait 2', 'stick pad out', 'wait 2'):
            self.do(event)
        return all(any(self.given[name]) for name in ROBOTS)
