# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Real rosdep resolves package.xml, from the names in test/rosdep.yaml and without a network."""
import os
import shutil
import subprocess

from catkin_pkg.package import parse_package
import pytest
from support.paths import REPO
import yaml

pytestmark = pytest.mark.skipif(shutil.which('rosdep') is None,
                                reason='there is no rosdep (package python3-rosdep2)')
NAMES = REPO / 'test' / 'rosdep.yaml'
INDEX = {'distributions': {'noetic': {
    'distribution': ['noetic.yaml'], 'distribution_status': 'active', 'distribution_type': 'ros1',
    'python_version': 3}}, 'type': 'index', 'version': 4}
NOETIC = {'release_platforms': {'ubuntu': ['focal']}, 'repositories': {}, 'type': 'distribution',
          'version': 2}
# Not in Debian; doc/systems.md names both.
SKIP = ['--skip-keys', 'rqt_gui rqt_gui_py']
# For a robot alone; and mhri loads the library without its headers.
NOT_IN_THE_SCRIPTS = {'python3-nodelet', 'libturbojpeg0-dev'}


@pytest.fixture(scope='module')
def rosdep(tmp_path_factory):
    """Return a function that runs rosdep with nothing but our names: (status, output)."""
    folder = tmp_path_factory.mktemp('rosdep')
    (folder / 'sources').mkdir()
    (folder / 'sources' / '10-names.list').write_text('yaml file://{}\n'.format(NAMES))
    for name, content in (('index.yaml', INDEX), ('noetic.yaml', NOETIC)):
        (folder / name).write_text('%YAML 1.1\n---\n' + yaml.safe_dump(content))
    environment = dict(os.environ, ROSDEP_SOURCE_PATH=str(folder / 'sources'),
                       ROS_HOME=str(folder), ROS_DISTRO='noetic', ROS_PYTHON_VERSION='3',
                       ROSDISTRO_INDEX_URL='file://{}/index.yaml'.format(folder))

    def run(*arguments):
        done = subprocess.run(['rosdep', *arguments], env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
        return done.returncode, done.stdout
    status, output = run('update', '--rosdistro', 'noetic')
    assert status == 0, output
    return run


def packages(rosdep, system, *options):
    """Return the packages that ``rosdep install`` would install for mhri on a system."""
    status, output = rosdep('install', '--from-paths', str(REPO), '--ignore-src',
                            '--rosdistro', 'noetic', '--simulate', '--reinstall',
                            '--os', system, *options)
    assert status == 0, output
    return {line.split()[-1] for line in output.splitlines() if 'apt-get install' in line}


def keys():
    manifest = parse_package(str(REPO / 'package.xml'))
    manifest.evaluate_conditions({'ROS_PYTHON_VERSION': '3'})
    return {entry.name for kind in ('build', 'buildtool', 'exec', 'build_export', 'test')
            for entry in getattr(manifest, kind + '_depends')}


def test_every_key_has_a_name_and_every_name_a_key():
    assert keys() == set(yaml.safe_load(NAMES.read_text()))


@pytest.mark.parametrize('system, family, options', [
    ('ubuntu:focal', 'ubuntu', []), ('debian:bookworm', 'debian', SKIP)],
    ids=['focal', 'bookworm'])
def test_every_key_resolves(rosdep, system, family, options):
    wanted = {name for row in yaml.safe_load(NAMES.read_text()).values()
              for name in row.get(family, [])}
    assert packages(rosdep, system, *options) == wanted


def test_debian_needs_the_option():
    """Else the page that names it is out of date."""
    without = {key for key, row in yaml.safe_load(NAMES.read_text()).items()
               if 'debian' not in row}
    assert without == set(SKIP[1].split())
    assert ' '.join(['--skip-keys', '"{}"'.format(SKIP[1])]) in (
        REPO / 'doc' / 'systems.md').read_text(encoding='utf-8')


def test_debians_list_of_the_scripts_has_them(rosdep):
    """Ubuntu's scripts read package.xml; Debian's list, written by hand, has to have the same."""
    text = (REPO / 'utils' / 'host' / 'common.sh').read_text()
    listed = set(text[text.index('DEBIAN_RUN=('):text.index('UBUNTU_RUN=(')].split())
    wanted = packages(rosdep, 'debian:bookworm', *SKIP)
    assert wanted - listed == NOT_IN_THE_SCRIPTS


@pytest.mark.skipif(not os.path.exists('/usr/share/python3-rosdep2/debian.yaml'),
                    reason='only the rosdep of Debian has its own names')
def test_our_names_are_those_of_debian():
    with open('/usr/share/python3-rosdep2/debian.yaml') as file:
        debian = yaml.safe_load(file)
    ours = {key: row.get('debian', []) for key, row in yaml.safe_load(NAMES.read_text()).items()}
    assert {key: names for key, names in ours.items()
            if key in debian and set(names) - set(debian[key]['debian'])} == {}
