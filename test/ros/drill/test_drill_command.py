# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command line of a drill: what it refuses, and what it names."""
import sys

import pytest

from mhri.nodes import mhri_drill

BROKEN = 'title: Short\nabout: Drive.\nplan: short.yaml\nrobots: [turtlebot2]\n'


@pytest.mark.parametrize('arguments, named', [
    (['nowhere'], 'figure_of_eight'), (['{folder}/broken.yaml'], 'broken.yaml'),
    (['--compare', '{folder}'], 'drill.yaml'), (['maze', '--delay', '9'], '--delay'),
    ([], 'figure_of_eight')])
def test_an_unusable_drill_is_refused(arguments, named, tmp_path, monkeypatch, capsys):
    (tmp_path / 'broken.yaml').write_text(BROKEN)
    monkeypatch.setattr(sys, 'argv', ['mhri_drill', *(
        one.format(folder=tmp_path) for one in arguments)])
    with pytest.raises(SystemExit) as refused:
        mhri_drill.main()
    assert refused.value.code == 2
    assert named in capsys.readouterr().err
