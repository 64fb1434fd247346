# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Searches every state that a world of real objects can reach, and says how a bad one is reached.

A state is a few bytes: the number of the form of each object. A form is every attribute, and of
every time the milliseconds from now, as far back as it makes a difference. So equal states are
found, however they were reached, and each event is tried on objects made anew from the bytes.
"""
from array import array
from collections import deque
import math


class Violation(AssertionError):
    """A property does not hold."""


def _ms(at, now, horizon_s):
    if at is None or at in (math.inf, -math.inf):
        return at
    found = round((at - now) * 1000.0)
    return found if found >= -round(horizon_s * 1000.0) else -math.inf


def _seconds(code):
    return None if code is None else code / 1000.0


class Shape:
    """How the objects of one class become numbers, one for each of the forms that are met.

    Attributes are immutable values, boxes (dict, set, list, deque, of immutable values), times, or
    dicts of times.

    :param times: {attribute: how far in the past it makes no difference any more [s]}
    :param fixed: {attribute: value}: no part of the state
    """

    def __init__(self, sample, times, fixed):
        self._class, self._fixed, attributes = type(sample), fixed, vars(sample)
        self._numbers, self._forms = {}, []
        unknown = set(times).union(fixed) - set(attributes)
        assert not unknown, '{} has no {}'.format(self._class.__name__, unknown)
        rest = [name for name in attributes if name not in times and name not in fixed]
        floats = [name for name in rest if type(attributes[name]) is float]
        assert not floats, '{}: are they times? {}'.format(self._class.__name__, floats)
        self._boxes = [(name, type(attributes[name])) for name in rest
                       if isinstance(attributes[name], (dict, set, list, deque))]
        self._plain = [name for name in rest if name not in dict(self._boxes)]
        self._times = [(name, horizon_s) for name, horizon_s in times.items()
                       if not isinstance(attributes[name], dict)]
        self._clocks = [(name, horizon_s, type(attributes[name]))
                        for name, horizon_s in times.items() if isinstance(attributes[name], dict)]

    def pack(self, thing, now):
        """Return the number of an object's form."""
        attributes = vars(thing)
        form = (
            tuple([attributes[name] for name in self._plain]),
            tuple([_ms(attributes[name], now, horizon_s) for name, horizon_s in self._times]),
            tuple([tuple(sorted(attributes[name].items())) if kind is dict else
                   frozenset(attributes[name]) if kind is set else tuple(attributes[name])
                   for name, kind in self._boxes]),
            tuple([tuple([(key, _ms(at, now, horizon_s)) for key, at in attributes[name].items()])
                   for name, horizon_s, _ in self._clocks]))
        number = self._numbers.get(form)
        if number is None:
            number = self._numbers[form] = len(self._forms)
            plain, times, boxes, clocks = form
            values = dict(zip(self._plain, plain), **self._fixed)
            values.update((name, _seconds(ms)) for (name, _), ms in zip(self._times, times))
            self._forms.append((values, [
                (name, kind, box) for (name, kind), box in zip(self._boxes, boxes) if box] + [
                (name, kind, [(key, _seconds(ms)) for key, ms in clock])
                for (name, _, kind), clock in zip(self._clocks, clocks) if clock], [
                (name, kind) for (name, kind), box in zip(self._boxes, boxes) if not box] + [
                (name, kind) for (name, _, kind), clock in zip(self._clocks, clocks) if not clock]))
        return number

    def unpack(self, number):
        """Return an object of that form; the time is 0."""
        values, boxes, empty = self._forms[number]
        thing = self._class.__new__(self._class)
        attributes = vars(thing)
        attributes.update(values)
        for name, kind, content in boxes:
            attributes[name] = kind(content)
        for name, kind in empty:
            attributes[name] = kind()
        return thing


class Search:
    """Breadth first from the worlds behind some ways; what it found is in its attributes.

    :param fresh: returns a world; it has ``do(event)``, which returns False if nothing happened
    :param load: returns a world from its numbers
    :param pack: returns the numbers of a world, which is of no more use then
    :param events: what can happen in every state
    :param ways: lists of events, each of which leads to a state to begin with
    """

    def __init__(self, fresh, load, pack, events, ways=((),)):
        self._fresh, self._load, self._pack = fresh, load, pack
        self._events, self._ways = events, ways
        self._found = {}
        self.transitions = self.depth = self.expanded = 0

    @property
    def states(self):
        """How many different states were found."""
        return len(self._found)

    def run(self, most, look=lambda world, way: None, every=1):
        """Search until nothing is new, or so many states are found.

        :param look: called with every so many-th world found and a function that returns its way
        :raises Violation: with the shortest list of events
        """
        level, found = [], self._found
        for way in self._ways:
            world = self._fresh()
            for number, event in enumerate(way):
                self._try(world, event, list(way[:number]))
            key = array('i', self._pack(world)).tobytes()
            if key not in found:
                found[key] = None, way
                level.append(key)
        while level and len(found) < most:
            level = self._next_level(level, most, look, every)
            self.depth += 1

    def _next_level(self, level, most, look, every):
        found, after = self._found, []
        for key in level:
            if len(found) >= most:
                break
            numbers = array('i')
            numbers.frombytes(key)
            self.expanded += 1
            if self.expanded % every == 0:
                look(self._load(numbers), lambda key=key: self.way(key))
            for event in self._events:
                world = self._load(numbers)
                if self._try(world, event, key) is False:
                    continue
                self.transitions += 1
                new = array('i', self._pack(world)).tobytes()
                if new not in found:
                    found[new] = key, event
                    after.append(new)
        return after

    def _try(self, world, event, before):
        try:
            return world.do(event)
        except Violation as problem:
            way = before if isinstance(before, list) else self.way(before)
            raise Violation('{}; after: {}'.format(problem, ', '.join([*way, event]))) from None

    def way(self, key):
        """Return the shortest list of events to a state."""
        events = []
        while True:
            before, event = self._found[key]
            if before is None:
                return list(event) + events[::-1]
            events.append(event)
            key = before
