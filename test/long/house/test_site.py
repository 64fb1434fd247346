# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The documents as a site: built by mkdocs, which refuses pages that are missing or in no menu.

Links of the sources: test/unit/house/test_documents.py; here only what the site makes of them.
"""
from html.parser import HTMLParser
import shutil
import subprocess

import pytest
from support.paths import REPO

pytestmark = [pytest.mark.skipif(
    shutil.which('mkdocs') is None, reason='there is no mkdocs (package mkdocs)')]


class Page(HTMLParser):
    """Anchors, and what links and pictures point to, of one page of HTML."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.targets = {''}, []
        self.feed(path.read_text(encoding='utf-8'))

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name == 'id':
                self.anchors.add(value)
            elif (tag, name) in (('a', 'href'), ('img', 'src'), ('link', 'href'),
                                 ('script', 'src')):
                self.targets.append(value)


@pytest.fixture(scope='module')
def pages(tmp_path_factory):
    """Return {path: :class:`Page`} of the built site."""
    folder = tmp_path_factory.mktemp('site')
    done = subprocess.run(['mkdocs', 'build', '--strict', '--site-dir', str(folder)],
                          cwd=str(REPO), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, done.stdout
    # It only notes a page that is in no menu.
    assert 'not included in the "nav"' not in done.stdout, done.stdout
    return {path: Page(path) for path in folder.rglob('*.html')}


def test_every_page_is_there(pages):
    assert len(pages) >= len(list((REPO / 'doc').rglob('*.md')))


def test_links_lead_to_an_anchor_of_the_site(pages):
    lost = []
    for path, page in pages.items():
        for target in page.targets:
            name, _, anchor = target.partition('#')
            other = (path.parent / name.partition('?')[0]).resolve() if name else path
            if ':' in name or path.name in ('404.html', 'search.html'):
                continue
            if not other.exists() or other in pages and anchor not in pages[other].anchors:
                lost.append('{}: {}'.format(path.name, target))
    assert lost == []


def test_no_page_loads_anything_from_elsewhere(pages):
    """Robots' networks often have no way out."""
    assert [target for page in pages.values() for target in page.targets
            if target.endswith(('.js', '.css')) and ':' in target] == []
