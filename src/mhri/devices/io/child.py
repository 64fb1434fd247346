# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Starts a module of mhri as a separate process, whatever lies in the working folder.

``python3 -c`` and ``python3 -m`` look for modules in the working folder first: a child would run a
``json.py`` or an ``mhri.py`` there.
"""
import os
import sys

# The working folder is left out by -I, as is PYTHONPATH: the paths come as the first argument.
_RUN = ('import sys; sys.path[:] = sys.argv.pop(1).split({!r}); import importlib; '
        'importlib.import_module(sys.argv.pop(1)).main()'.format(os.pathsep))


def command(module, *arguments):
    """Return the command that runs ``main()`` of a module with the modules of this process.

    :param module: dotted name
    :param arguments: texts, which the module finds as ``sys.argv[1:]``
    """
    # A package of a devel space puts its sources first once it is imported, and its messages are
    # not there: what PYTHONPATH says comes first, as where this process was started.
    wanted = os.environ.get('PYTHONPATH', '').split(os.pathsep) + sys.path
    paths = os.pathsep.join(path for path in dict.fromkeys(wanted) if os.path.isabs(path))
    return [sys.executable, '-I', '-c', _RUN, paths, module, *arguments]
