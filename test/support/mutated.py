# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Code that is wrong on purpose: a text of its source replaced, in memory, for a while."""
import contextlib
import inspect
import sys


@contextlib.contextmanager
def mutated(names, other):
    """Let a module be another one for a while.

    Its functions get the code of those of the other; its numbers and tables are replaced, too,
    wherever a module of mhri has them under the same name.

    :param names: what the module defines, as a dict
    :param other: what the other one does, see :func:`changed`
    """
    undo = []
    for holder, name, mine in list(_functions(names)):
        code = next((found.__code__ for where, also, found in _functions(other)
                     if (where, also) == (holder, name)), mine.__code__)
        if code != mine.__code__:
            undo.append((mine, mine.__code__))
            mine.__code__ = code
    holders = [names] + [vars(module) for name, module in list(sys.modules.items())
                         if name.startswith('mhri.')]
    replaced = []
    for name, value in other.items():
        if isinstance(value, (int, float, dict)) and names.get(name) != value and name in names:
            for one in holders:
                if one.get(name) is names[name] or one is names:
                    replaced.append((one, name, one[name]))
    for one, name, _ in replaced:
        one[name] = other[name]
    assert undo or replaced, 'nothing is different'
    try:
        yield
    finally:
        for function, code in undo:
            function.__code__ = code
        for one, name, value in replaced:
            one[name] = value


def changed(text, old, new):
    """Return a text in which something is replaced that has to be there once."""
    assert text.count(old) == 1, '{!r} is there {} times'.format(old, text.count(old))
    return text.replace(old, new)


def changed_module(module, old, new):
    """Return what a module would define with another text."""
    names = {'__name__': module.__name__}
    exec(compile(changed(inspect.getsource(module), old, new), module.__name__, 'exec'), names)
    return names


def _functions(names):
    """Yield (class or '', name, function) of all that a module defines."""
    for name, thing in list(names.items()):
        if getattr(thing, '__module__', None) != names['__name__']:
            continue
        if inspect.isfunction(thing):
            yield '', name, thing
        elif inspect.isclass(thing):
            for part, inner in list(vars(thing).items()):
                inner = inner.fget if isinstance(inner, property) else inner
                if inspect.isfunction(inner):
                    yield name, part, inner
