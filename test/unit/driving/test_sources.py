# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sources' file: rows in, sources out, and every slip named by file and key."""
import os

import pytest

from mhri.base.config import ConfigError
from mhri.driving.sources import parse_mux_config

PROFILE = 'name: p\nforward: {axis: 1}\nturn: {axis: 0}\n'
ROW = '  - {name: joy, topic: /mux_in/joy, profile: p}\n'
TAIL = 'speed_limit: {linear_mps: 0.5, angular_rad_s: 1.5}\n'
RESOURCE = os.path.join(os.path.dirname(__file__), '..', '..', '..', 'resource')


def parse(text, read=lambda name: ('p.yaml', PROFILE)):
    """Parse a text as mux.yaml."""
    return parse_mux_config(text, 'mux.yaml', read)


def test_defaults_of_a_row():
    """A row needs a name, a topic and a profile."""
    config = parse('sources:\n' + ROW + TAIL)
    source = config.sources[0]
    assert (source.name, source.label, source.topic) == ('joy', 'joy', '/mux_in/joy')
    assert (source.timeout_s, source.suspend_service) == (0.5, None)
    assert (config.default, config.linear_mps, config.angular_rad_s) == ('joy', 0.5, 1.5)
    assert config.enabling is None
    assert parse('enabling: joy\nsources:\n' + ROW + TAIL).enabling == 'joy'


def test_a_row_of_type_twist_needs_no_profile_and_may_rest_in_silence():
    config = parse('sources:\n  - {name: cmd, topic: /cmd_vel, type: twist}\n' + TAIL)
    source = config.sources[0]
    assert (source.kind, source.profile, source.timeout_s, source.rests) == (
        'twist', None, 0.5, True)


def test_a_source_that_sends_changes_only_is_held_for_a_while_not_for_ever():
    row = '  - {{name: pad, topic: /joy, profile: p, holds: true{}}}\n'
    assert parse('sources:\n' + row.format('') + TAIL).sources[0].timeout_s == 5.0
    assert parse('sources:\n' + row.format(', timeout_s: 60') + TAIL).sources[0].timeout_s == 60.0
    with pytest.raises(ConfigError, match='timeout_s'):
        parse('sources:\n' + row.format(', timeout_s: 61') + TAIL)


def test_dead_man_buttons_can_be_turned_off_for_all_profiles():
    profile = PROFILE + 'dead_man_button: 4\n'

    def read(name):
        return 'p.yaml', profile
    assert parse('sources:\n' + ROW + TAIL, read).sources[0].profile.dead_man == 4
    config = parse('dead_man: false\nsources:\n' + ROW + TAIL, read)
    assert (config.dead_man, config.sources[0].profile.dead_man) == (False, None)


def test_shipped_file_has_the_contract_s_sources():
    """Names, topics and services are public interface."""
    def read(name):
        path = os.path.join(RESOURCE, 'pads', name + '.yaml')
        with open(path, encoding='utf-8') as stream:
            return path, stream.read()
    with open(os.path.join(RESOURCE, 'mux.yaml'), encoding='utf-8') as stream:
        config = parse_mux_config(stream.read(), 'mux.yaml', read)
    assert [(source.name, source.topic, source.suspend_service, source.timeout_s)
            for source in config.sources[:4]] == [
        ('joy', '/mux_in/joy', None, 0.5),
        ('ps3joy', '/mux_in/ps3joy', '/mhri_joy/set_suspended', 0.5),
        ('pedal', '/mux_in/pedal', '/mhri_pedal/set_suspended', 0.5),
        ('voice', '/mux_in/voice', '/mhri_voice/set_suspended', 0.5)]
    assert config.default == 'joy'
    for source in config.sources[:4]:
        if source.name != 'ps3joy':
            stick = source.profile.read((1.0, 0.5), ())
            assert (stick.turn, stick.forward) == (1.0, 0.5), 'axes[0] left +, axes[1] forward +'


BAD = {
    'sources': 'sources: []\n' + TAIL,
    'sources[0]': 'sources: [joy]\n' + TAIL,
    'sources[0].name': 'sources:\n  - {topic: /a, profile: p}\n' + TAIL,
    'sources[0].topic': 'sources:\n  - {name: joy, topic: mux_in/joy, profile: p}\n' + TAIL,
    'sources[0].timeout_s': 'sources:\n  - {name: j, topic: /a, profile: p, timeout_s: 9}\n' + TAIL,
    'sources[0].colour': 'sources:\n  - {name: j, topic: /a, profile: p, colour: red}\n' + TAIL,
    'sources[1].name': 'sources:\n' + ROW + '  - {name: joy, topic: /b, profile: p}\n' + TAIL,
    'sources[1].topic': 'sources:\n' + ROW + '  - {name: b, topic: /mux_in/joy, profile: p}\n'
                        + TAIL,
    'sources[0].type': 'sources:\n  - {name: j, topic: /a, profile: p, type: string}\n' + TAIL,
    'sources[0].profile': 'sources:\n  - {name: j, topic: /a}\n' + TAIL,
    'sources[0].holds': 'sources:\n  - {name: j, topic: /a, profile: p, holds: 3}\n' + TAIL,
    'sources[0].label': 'sources:\n  - {name: j, topic: /a, profile: p, label: ' + 61 * 'x'
                        + '}\n' + TAIL,
    'enabling': 'enabling: cmd\nsources:\n  - {name: cmd, topic: /a, type: twist}\n' + TAIL,
    'dead_man': 'dead_man: sometimes\nsources:\n' + ROW + TAIL,
    'default': 'default: ps5\nsources:\n' + ROW + TAIL,
    'speed_limit': 'sources:\n' + ROW,
    'speed_limit.linear_mps': 'sources:\n' + ROW
                              + 'speed_limit: {linear_mps: .inf, angular_rad_s: 1}\n',
    'speed_limit.angular_rad_s': 'sources:\n' + ROW + 'speed_limit: {linear_mps: 0.5}\n',
    'speed_limits': 'sources:\n' + ROW + TAIL + 'speed_limits: 3\n',
}
NAMES = {
    'enabling': 'enabling: nobody\nsources:\n' + ROW + TAIL,
    'sources[0].name': "sources:\n  - {name: '', topic: /a, profile: p}\n" + TAIL,
    'sources[0].topic': 'sources:\n  - {name: j, topic: /mux in/joy, profile: p}\n' + TAIL,
    'sources[0].suspend_service': 'sources:\n  - {name: j, topic: /a, profile: p, '
                                  'suspend_service: a b}\n' + TAIL,
}


@pytest.mark.parametrize('key, text', [*BAD.items(), *NAMES.items()])
def test_error_names_file_and_key(key, text):
    """A lab edits this file by hand; names that ROS cannot use do not fail only in the node."""
    with pytest.raises(ConfigError) as error:
        parse(text)
    assert str(error.value).startswith('mux.yaml: {}:'.format(key))


@pytest.mark.parametrize('key, least, most', [
    ('timeout_s', 0.05, 2.0), ('linear_mps', 0.01, 5.0), ('angular_rad_s', 0.01, 10.0)])
def test_the_least_and_most_of_each_number(key, least, most):
    text = 'sources:\n  - {{name: j, topic: /a, profile: p, timeout_s: {timeout_s}}}\n' \
           'speed_limit: {{linear_mps: {linear_mps}, angular_rad_s: {angular_rad_s}}}\n'
    for value, is_good in ((least, True), (most, True), (0.9 * least, False), (1.1 * most, False)):
        numbers = {'timeout_s': 0.5, 'linear_mps': 0.5, 'angular_rad_s': 1.5, key: value}
        if is_good:
            parse(text.format(**numbers))
        else:
            with pytest.raises(ConfigError, match=key):
                parse(text.format(**numbers))


def test_profile_that_cannot_be_read_names_the_row():
    """The row that asks for it, and why."""
    def read(name):
        raise FileNotFoundError(2, 'No such file or directory')
    with pytest.raises(ConfigError, match=r"sources\[0\].profile: cannot read profile 'p': No"):
        parse('sources:\n' + ROW + TAIL, read)


def test_profile_that_is_wrong_names_its_own_file():
    """The slip is there, not in mux.yaml."""
    with pytest.raises(ConfigError, match='p.yaml: forward'):
        parse('sources:\n' + ROW + TAIL, lambda name: ('p.yaml', 'name: p\n'))


def test_not_yaml_names_the_file():
    """On one line."""
    with pytest.raises(ConfigError, match='mux.yaml: is not valid YAML') as error:
        parse('sources: [}')
    assert '\n' not in str(error.value)
