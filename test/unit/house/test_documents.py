# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the documents point to exists: pages, their headings, pictures, and files of the project."""
import functools
from pathlib import Path
import re

import pytest

REPO = Path(__file__).resolve().parents[3]
PAGES = sorted([REPO / 'README.md', REPO / 'CONTRIBUTING.md', *REPO.glob('doc/**/*.md')])
LINK = re.compile(r'\]\(([^)\s]+)\)|<img src="([^"]+)"')
HEADING = re.compile(r'^#+ (.*)$', re.M)
CODE = re.compile(r'^ *```.*?^ *```|^(?: {4}[^\n]*\n)+', re.M | re.S)
# Files of the project in running text, such as `utils/host/mhri_run.sh`. Pages on how to write a
# package of one's own name the files of that.
OWN_PACKAGES = 'new_robot.md', 'new_task.md', 'new_accessory.md'
NAMED = re.compile(r'`((?:utils|resource|launch|test|doc|src|scripts)/[\w./-]+\.[a-z0-9]+)[`: ]')


@functools.lru_cache(maxsize=None)
def anchors_of(path):
    """Return the anchors of a page's headings, as web pages of repositories make them."""
    text = CODE.sub('', path.read_text(encoding='utf-8'))
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')
            for heading in HEADING.findall(text)}


@functools.lru_cache(maxsize=None)
def links_of(path):
    """Return the links of a page to the project's own files."""
    text = CODE.sub('', path.read_text(encoding='utf-8'))
    return [link or picture for link, picture in LINK.findall(text)
            if not (link or picture).startswith(('http:', 'https:', 'mailto:'))]


@pytest.mark.parametrize('page', PAGES, ids=lambda page: str(page.relative_to(REPO)))
def test_links_lead_somewhere(page):
    for link in links_of(page):
        name, _, anchor = link.partition('#')
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), link
        assert not anchor or anchor in anchors_of(target), link


@pytest.mark.parametrize('page', [page for page in PAGES if page.name not in OWN_PACKAGES],
                         ids=lambda page: str(page.relative_to(REPO)))
def test_files_that_are_named_exist(page):
    for name in NAMED.findall(page.read_text(encoding='utf-8')):
        assert (REPO / name).exists(), name


def test_every_picture_is_on_a_page():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links_of(page)}
    assert [path.name for path in sorted(REPO.glob('doc/images/*')) if path not in shown] == []


def test_every_page_is_reached_from_the_readme():
    reached, waiting = set(), [REPO / 'README.md']
    while waiting:
        page = waiting.pop()
        if page in reached:
            continue
        reached.add(page)
        waiting += [target for target in (
            (page.parent / link.partition('#')[0]).resolve() for link in links_of(page))
            if target.suffix == '.md']
    assert [str(page.relative_to(REPO)) for page in PAGES if page not in reached] == []
