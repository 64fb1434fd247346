# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Manifest and changelog, as catkin's release tools and bloom read them."""
from pathlib import Path
import re
import subprocess

from catkin_pkg.changelog import get_changelog_from_path
from catkin_pkg.package import parse_package
import pytest

REPO = Path(__file__).resolve().parents[3]
MAX_LINE = 4  # of one item: it says what changed, the documents say the rest


@pytest.fixture(scope='module')
def changelog():
    return get_changelog_from_path(str(REPO), 'mhri')


@pytest.fixture(scope='module')
def manifest():
    return parse_package(str(REPO / 'package.xml'))


def versions(changelog):
    """Return (version, date) of each release, the newest first."""
    return [(version, date) for version, date, _ in changelog.foreach_version(reverse=True)
            if version != 'Forthcoming']


def test_versions_have_dates_and_fall(changelog):
    found = versions(changelog)
    numbers = [tuple(map(int, version.split('.'))) for version, _ in found]
    assert all(len(number) == 3 for number in numbers)
    assert numbers == sorted(set(numbers), reverse=True)
    dates = [date for _, date in found]
    assert None not in dates and dates == sorted(dates, reverse=True)


def test_the_newest_version_is_that_of_the_manifest(changelog, manifest):
    assert versions(changelog)[0][0] == manifest.version


def test_every_item_is_short():
    items = re.split(r'^\* ', (REPO / 'CHANGELOG.rst').read_text(encoding='utf-8'), flags=re.M)
    assert [item for item in items[1:] if len(re.split(r'\n(?:  )', item)) > MAX_LINE] == []


def test_a_tag_is_a_version_of_the_changelog(changelog):
    """A release is tagged with its bare version, as catkin_tag_changelog and bloom expect."""
    done = subprocess.run(['git', 'tag', '--list', '[0-9]*'], cwd=str(REPO), stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, universal_newlines=True)
    assert set(done.stdout.split()) <= {version for version, _ in versions(changelog)}


def test_the_manifest_says_whom_to_ask_and_where(manifest):
    manifest.validate()
    assert {url.type for url in manifest.urls} == {'website', 'bugtracker', 'repository'}
    assert all(person.email for person in manifest.maintainers)
    assert manifest.licenses == ['BSD-3-Clause']
