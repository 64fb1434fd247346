# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor on real links: one system in which each link is wrong in another way."""
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from unittest import mock

from mhri.doctor.facts import KeysSeen, LinkNote
from mhri.doctor.ros.linked import ask_links, linked_of
from mhri.graph.ros.parallel_calls import Answers
from mhri.link.carried import COMMAND, STATE
from mhri.link.frames import About, Beat, pack, pack_about, pack_beat
from mhri.link.ros.carrier import Carrier
from mhri.link.ros.side import ABOUT, BEAT, boot_clock
from support.paths import REPO
from support.ros_system import free_port, wait_for
from support.surgery import Clinic, EXAMINE_S, START_S

SCRIPT = str(REPO / 'utils' / 'host' / 'mhri_keys.sh')
LISTS = ('authority.pem', 'peers', 'withdrawn', 'withdrawn.pem')
HOST = 'host:lab.7'
# Stands before the real one: the script signs by another day.
DATE = '#!/bin/bash\nexec /bin/date "${{@/#now/now {}}}"\n'


class OldRobot:
    """The robot's end of a link, of another version of mhri and of zenoh."""

    def __init__(self, name, endpoint):
        self._carrier = Carrier(listen=[endpoint])
        between = self._carrier.between(name, HOST)
        self._say = [(between.sender('up', BEAT, COMMAND), pack_beat(Beat())),
                     (between.sender('up', ABOUT, STATE), pack_about(About(
                         {'link': {'mhri': '0.0.1', 'zenoh': '0.1'}},
                         (('odom', 'nav_msgs/Odometry'),))))]
        self._ended = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        number = 0
        while not self._ended.wait(0.2):
            number += 1
            for send, body in self._say:
                send(pack(1, number, boot_clock(), body))

    def close(self):
        self._ended.set()
        self._carrier.close()


class Keys:
    """Authorities in a folder, made by the script as of another day."""

    def __init__(self, folder):
        self.folder = folder
        os.mkdir(os.path.join(folder, 'bin'))

    def make(self, authority, shift, *words):
        date = os.path.join(self.folder, 'bin', 'date')
        with open(date, 'w') as file:
            file.write(DATE.format(shift))
        os.chmod(date, 0o755)
        subprocess.run(
            [SCRIPT, *words, '--folder', os.path.join(self.folder, authority)], check=True,
            stdout=subprocess.DEVNULL, env={'PATH': self.folder + '/bin:/usr/bin:/bin',
                                            'HOME': self.folder})

    def put(self, place, key, authority):
        """Return a folder with the key lab that one authority made, and the lists of another."""
        made = os.path.join(self.folder, place)
        shutil.copytree(os.path.join(self.folder, key, 'keys', 'lab'), made)
        for name in LISTS:
            shutil.copy(os.path.join(self.folder, authority, name), made)
        return made


class LinkTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='mhri_test_')
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_light()
        keys = Keys(cls.folder)
        for authority in ('ours', 'stranger'):
            keys.make(authority, '- 500 days', 'new')
        keys.make('ours', '- 400 days', 'host', 'lab')
        cls.expired = keys.put('.config/mhri/keys', 'ours', 'ours')
        cls.foreign = keys.put('foreign', 'ours', 'stranger')

    def link(self, name, *words, keys='off'):
        return self.clinic.start(
            sys.executable, '-c', 'from mhri.nodes.mhri_link import main; main()', '--side', 'host',
            '--name', name, '--host', HOST, '--keys', keys, *words, '__ns:=/' + name)

    def finds(self, expected):
        """Examine until there is {(check, about): a part of the problem} among what is wrong."""
        last = {}

        def there():
            _, report = self.clinic.examine()
            last.clear()
            last.update({(item['check'], item['about']): item for item in report['findings']
                         if item['severity'] != 'fine'})
            return all(part in last.get(key, {'problem': ''})['problem']
                       for key, part in expected.items())
        wait_for(there, EXAMINE_S, lambda: '{} in {}'.format(
            expected, {key: item['problem'] for key, item in last.items()}), 0.2)
        for key in expected:
            item = last[key]
            print('FOUND {check}: {about}: {problem} | {symptom} | {remedy}'.format(**item))
            self.assertTrue(item['symptom'] and item['remedy'], item)

    def test_each_link_is_wrong_in_another_way(self):
        self.addCleanup(self.clinic.heal)
        end, nobody = ('tcp/127.0.0.1:{}'.format(free_port()) for _ in range(2))
        robot = OldRobot('bot1', end)
        self.addCleanup(robot.close)
        self.link('bot1', '--connect', end)
        self.link('bot2', '--connect', end)
        self.link('bot3', '--connect', nobody)
        self.link('bot4', '--router', nobody)
        self.link('bot5', '--connect', 'nonsense')
        tls = nobody.replace('tcp/', 'tls/')
        self.link('bot6', '--connect', tls, keys=os.path.join(self.folder, 'nothing'))
        self.link('bot7', '--connect', tls, keys=self.foreign)
        self.link('bot8', '--connect', tls, keys=self.expired)
        killed = self.link('bot9', '--connect', nobody)
        wait_for(lambda: self.clinic.master.hasParam('/bot9/mhri_link/link'), START_S, 'bot9')
        killed.kill()
        killed.wait(START_S)
        # As rosnode cleanup does; before that it is one of the dead nodes.
        self.clinic.forget('/bot9/mhri_link')
        # On this master, too.
        self.clinic.patient('/bot1/base', '--odometry', 'odom')
        self.finds({
            ('link_versions', 'bot1'): '0.0.1 on the robot',
            ('zenoh_versions', 'bot1'): '0.1 on the robot',
            ('linked_twice', 'bot1, bot2'): 'which is one robot',
            ('linked_twice', 'bot1'): 'on this master, too: /bot1/base',
            ('link_silent', 'bot2'): 'answers, but not for bot2',
            ('link_silent', 'bot3'): 'does not run, though its computer is there',
            ('router_unreachable', 'bot4'): 'does not run',
            ('link_endpoint', 'bot5'): 'nonsense',
            ('keys_missing', 'bot6'): 'there is no',
            ('keys_wrong', 'bot7'): 'another authority',
            ('keys_expired', 'bot8'): 'has run out',
            ('link_ended', 'bot9'): 'is not running'})
        robot.close()
        self.finds({('link_silent', 'bot1'): 'no longer'})

    def test_the_keys_of_this_computer_are_looked_at(self):
        self.assertIn('has run out', self.seen(self.folder).problem)
        begun = os.path.join(self.folder, 'begun')
        os.makedirs(os.path.join(begun, '.config/mhri/authority'))
        shutil.copy(os.path.join(self.folder, 'ours', 'authority.pem'),
                    os.path.join(begun, '.config/mhri/authority'))
        self.assertEqual(self.seen(begun), KeysSeen(authority=True))

    @staticmethod
    def seen(home):
        """Look at the keys as if this were the operator's home, however long it takes."""
        with mock.patch.dict(os.environ, HOME=home):
            os.environ.pop('XDG_CONFIG_HOME', None)
            notes, answers = [LinkNote('bot1', heard='yes')], Answers()
            ask_links(answers, notes)
            return linked_of(notes, answers.by(time.monotonic() + START_S))[1]
