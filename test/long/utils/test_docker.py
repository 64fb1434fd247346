# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_docker.sh: which docker commands it runs; docker is a stand-in."""
import os
import shlex

import pytest

# Answers which sources the image was made of, and fails where FAKE_BUILD says so.
DOCKER = '''case "$1" in
  image) cat "$HOME/image" 2>/dev/null || exit 1 ;;
  build) for part in "$@"; do case "$part" in mhri.checksum=*) label=${part#*=} ;; esac; done
    [ -z "${FAKE_BUILD:-}" ] || exit "$FAKE_BUILD"; echo "$label" >"$HOME/image" ;;
  run) exit "${FAKE_RUN:-0}" ;;
esac'''
ALWAYS = ('--rm --init ', '--network host', '--env HOME={home} --env USER=me',
          '--volume {home}:{home}')


@pytest.fixture
def docker(checkout, tmp_path):
    """Return a function that runs the script with a stand-in of docker: (status, output, calls)."""
    checkout.stand_in('docker', DOCKER)
    root = tmp_path / 'root'
    for folder in ('dev/input', 'dev/snd', 'run/udev', 'tmp/.X11-unix'):
        (root / folder).mkdir(parents=True)
    for file in ('dev/input/event0', 'dev/snd/controlC0'):
        (root / file).touch()
    (tmp_path / 'key').touch()
    (tmp_path / 'pulse').mkdir()
    (tmp_path / 'pulse' / 'native').touch()
    started = checkout.root / 'utils' / 'host' / 'mhri_docker.sh'

    def run(*arguments, **settings):
        environment = {'DISPLAY': '', 'USER': 'me', 'MHRI_DEVICES': str(tmp_path / 'nothing')}
        environment.update(settings)
        before = len(checkout.calls)
        status, output = checkout.run(*arguments, script=started, **environment)
        return status, output, [line for line in checkout.calls[before:]
                                if line.startswith('docker ')]
    run.root, run.home, run.checkout = root, tmp_path, checkout
    return run


def command(output, verb):
    """Return a printed docker command as its arguments between single spaces."""
    return next(' '.join(shlex.split(line)[1:]) for line in output.splitlines()
                if line.startswith('docker ' + verb))


@pytest.mark.parametrize('settings, there, absent', [
    ({}, [], ['DISPLAY', '--device', '/dev', '--group-add', 'PULSE', 'XAUTHORITY', '--ipc']),
    ({'DISPLAY': ':1'}, ['--env DISPLAY=:1', '--env QT_QPA_PLATFORM=xcb', '--ipc host'],
     ['XAUTHORITY', '/dev']),
    ({'DISPLAY': ':1', 'XAUTHORITY': '{home}/key', 'MHRI_DEVICES': '{root}'},
     ['--volume {root}/tmp/.X11-unix:/tmp/.X11-unix:ro',
      '--volume {home}/key:/run/mhri.xauthority:ro --env XAUTHORITY=/run/mhri.xauthority'], []),
    # A Wayland desktop with its Xwayland.
    ({'DISPLAY': ':0', 'WAYLAND_DISPLAY': 'wayland-0'}, ['--env DISPLAY=:0', 'QT_QPA_PLATFORM=xcb'],
     ['WAYLAND_DISPLAY']),
    ({'MHRI_DEVICES': '{root}'},
     ['--volume {root}/dev/input:/dev/input --device-cgroup-rule c 13:* rmw',
      '--volume {root}/run/udev:/run/udev:ro', '--group-add {group}',
      '--device {root}/dev/snd:/dev/snd'], ['DISPLAY']),
    ({'XDG_RUNTIME_DIR': '{home}'},
     ['--volume {home}/pulse/native:/run/mhri.pulse --env PULSE_SERVER=unix:/run/mhri.pulse'], []),
], ids=['bare', 'screen', 'screen with a key', 'wayland', 'devices', 'sound'])
def test_what_the_container_gets(docker, settings, there, absent):
    names = {'root': docker.root, 'home': docker.home, 'group': os.getgid()}
    status, output, calls = docker(
        '--dry-run', '--sim', '3', 'robots:=bot1 bot2',
        **{name: value.format(**names) for name, value in settings.items()})
    assert status == 0, output
    assert calls == []
    made = command(output, 'run')
    assert made.endswith(' mhri --sim 3 robots:=bot1 bot2')
    for part in [*ALWAYS, *there]:
        assert part.format(**names) in made
    assert [part for part in absent if part in made] == []


def test_it_is_built_where_it_is_missing_or_the_checkout_has_changed(docker):
    def verbs(*arguments):
        status, output, calls = docker(*arguments)
        assert status == 0, output
        return [call.split()[1] for call in calls]
    assert verbs() == ['image', 'build', 'run']
    assert verbs() == ['image', 'run']
    (docker.checkout.root / 'build').mkdir(exist_ok=True)
    (docker.checkout.root / 'build' / 'log').touch()
    assert verbs() == ['image', 'run']
    (docker.checkout.root / 'launch' / 'new.launch').touch()
    assert verbs() == ['image', 'build', 'run']
    assert verbs('--rebuild') == ['build', 'run']


def test_nothing_runs_where_the_image_cannot_be_built(docker):
    status, output, calls = docker(FAKE_BUILD='1')
    assert status == 1 and [call.split()[1] for call in calls] == ['image', 'build']


def test_its_exit_status_is_that_of_mhri(docker):
    assert docker(FAKE_RUN='130')[0] == 130


def test_wayland_without_an_x_server_starts_nothing(docker):
    """There nothing would watch the keys of STOP ALL while the screen hangs."""
    status, output, calls = docker(WAYLAND_DISPLAY='wayland-0')
    assert status == 1 and 'Xwayland' in output
    assert 'run' not in [call.split()[1] for call in calls]


def test_its_home_is_where_it_starts_if_the_folder_is_elsewhere(docker, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp('elsewhere')
    status, output = docker.checkout.run(
        '--dry-run', script=docker.checkout.root / 'utils' / 'host' / 'mhri_docker.sh',
        cwd=elsewhere, DISPLAY='')
    assert status == 0 and '--workdir {} '.format(docker.home) in command(output, 'run') + ' '
    status, output, _ = docker('--dry-run')
    assert '--workdir {} '.format(docker.checkout.root.parent) in command(output, 'run') + ' '


def test_without_docker_it_says_how_to_install_it(docker, tmp_path):
    (tmp_path / 'bin' / 'docker').unlink()
    status, output, _ = docker()
    assert status == 1 and 'docker.io' in output
