# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What other programs read of the project names what is there: Dockerfile, pre-commit, CI."""
import re
import shlex
import subprocess

from support.checkout import REPO
import yaml


def instructions(name):
    """Return what a Dockerfile says under one name, one text for each."""
    text = (REPO / 'Dockerfile').read_text().replace('\\\n', ' ')
    return [line.split(' ', 1)[1] for line in text.splitlines() if line.startswith(name + ' ')]


def test_dockerfile_installs_and_builds(checkout):
    """Its RUN lines, by its shell: apt and catkin are stand-ins, the link's library is there."""
    scripts = checkout.root / 'utils' / 'host'
    library = re.search('eclipse-zenoh==[0-9.]+', (scripts / 'common.sh').read_text())
    link = checkout.root / 'build' / '.ws' / 'link'
    link.mkdir(parents=True)
    (link / 'installed').write_text(library.group())
    shell = yaml.safe_load(instructions('SHELL')[0])
    for line in instructions('RUN'):
        done = subprocess.run(
            shell + [line], cwd=str(checkout.root), stdin=subprocess.DEVNULL,
            env=dict(checkout.environment, FAKE_MISSING='python3-rospy'),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        assert done.returncode == 0, done.stdout
    names = [call.split(' -')[0] for call in checkout.called('apt-get', 'catkin_make')]
    assert names == ['apt-get update', 'apt-get install', 'apt-get clean', 'catkin_make']


def test_dockerfile_starts_what_is_there():
    program = yaml.safe_load(instructions('ENTRYPOINT')[0])[0]
    assert (REPO / program.replace(instructions('WORKDIR')[0] + '/', '')).is_file()
    assert 'build' in (REPO / '.dockerignore').read_text().split()


def test_hooks_run_what_is_there():
    config = yaml.safe_load((REPO / '.pre-commit-config.yaml').read_text())
    hooks = {hook['id']: hook for repo in config['repos'] for hook in repo['hooks']}
    for hook in hooks.values():
        command = shlex.split(hook['entry'])
        program = REPO / command[0]
        assert program.is_file() if '/' in command[0] else subprocess.run(
            command + ['--version'], cwd=str(REPO), stdout=subprocess.DEVNULL).returncode == 0
    assert hooks['fast']['stages'] == ['pre-push']


def test_ci_is_the_host_script_and_industrial_ci():
    path = REPO / '.github' / 'workflows' / 'industrial_ci.yml'
    jobs = yaml.safe_load(path.read_text())['jobs']
    uses = [step.get('uses', '') for step in jobs['noetic']['steps']]
    assert any(name.startswith('ros-industrial/industrial_ci@') for name in uses)
    assert jobs['noetic']['env']['ROS_DISTRO'] == 'noetic'
    run = [step['run'] for step in jobs['debian']['steps'] if 'run' in step]
    assert run and all((REPO / command).is_file() for command in run)
