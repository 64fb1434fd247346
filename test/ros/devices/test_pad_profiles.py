# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An operator's own profile of a pad is kept whole, and replaced only when that was agreed to."""
import pytest

from mhri.base.config import ConfigError
from mhri.devices.ros.pad_profiles import own_folder, read_profiles, write_profile

TEXT = 'name: rat\nforward: {axis: 1}\nturn: {axis: 0}\nmatch: {names: [Lab rat]}\n'


@pytest.fixture
def path(tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_HOME', str(tmp_path))
    return '{}/rat.yaml'.format(own_folder())


def test_what_is_written_is_read_and_replaced_only_if_agreed(path):
    write_profile(path, TEXT, replace=False)
    assert read_profiles()[0][0].name == 'rat'
    with pytest.raises(FileExistsError):
        write_profile(path, TEXT.replace('1', '3'), replace=False)
    assert read_profiles()[0][0].forward.index == 1
    write_profile(path, TEXT.replace('1', '3'), replace=True)
    assert read_profiles()[0][0].forward.index == 3


def test_what_is_no_profile_leaves_the_old_one(path):
    write_profile(path, TEXT, replace=False)
    with pytest.raises(ConfigError, match='rat.yaml'):
        write_profile(path, 'name: rat\n', replace=True)
    assert [profile.name for profile in read_profiles()[0]].count('rat') == 1
