# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_voice_teach``: reads sentences with an operator, and keeps the voice.

It needs no master. The exit status is 0 if the voice was kept, else 1.
"""
import argparse
import os
import sys

from mhri.base.config import ConfigError, short
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.graph.ros.resources import read_text, resource_path
from mhri.voice.adaptation import ModelError
from mhri.voice.io.audio import open_source, WavFile
from mhri.voice.io.listening import missing
from mhri.voice.language import parse_language
from mhri.voice.teaching import voice_path, voice_problem

# Read so often, a sentence that stays bad is left out.
_TRIES = 3
# With fewer of the sentences a voice is not known [fraction].
_ENOUGH = 0.6
_HELP = ('Read each sentence aloud when it is shown, the way you talk to the robots: at an even\n'
         'pace, the mouth a hand\'s width from the microphone. It takes about four minutes.\n'
         'Ctrl-C ends it, and nothing is kept.')


class Refused(Exception):
    """The voice is not kept; the text says why, and what to do."""


def parse(argv):
    """Return the options of a command line."""
    parser = argparse.ArgumentParser(
        prog='mhri_voice_teach', description='Teach mhri_voice your voice, once: read some '
        'sentences aloud. Use it with: rosparam set /mhri_voice/voice NAME')
    parser.add_argument('name', metavar='NAME', help='what the voice shall be called')
    parser.add_argument('--source', default='',
                        help='where the sound comes from, as ~source of mhri_voice')
    parser.add_argument('--recordings', metavar='FOLDER',
                        help='instead: a WAV file for each sentence, robot_turn_left.wav')
    parser.add_argument('--language', default='english', help='as ~language of mhri_voice')
    options = parser.parse_args(argv)
    problem = voice_problem(options.name)
    if problem:
        parser.error('NAME: ' + problem)
    return options


def teach(options, say=print):
    """Read the sentences, and keep the voice.

    :raises Refused, ConfigError, DeviceAbsent, DeviceLost, ModelError, OSError: it is not kept
    """
    path = options.language if '/' in options.language else resource_path(
        'voice', options.language + '.yaml')
    language = parse_language(read_text(path), path)
    if missing():
        raise Refused(missing())
    # Only now: loading takes a second.
    from mhri.voice.io.recogniser import Dictionary, RecogniserError
    from mhri.voice.io.teaching import Teacher
    try:
        teacher = Teacher(language, Dictionary())
        if not language.teach or not language.teach_check:
            raise Refused('{} has no sentences: give some below teach and teach_check'.format(path))
        if options.recordings:
            _read_all(language, teacher, _recordings(options.recordings), say, tries=1)
        else:
            _read_all(language, teacher, _live(options.source, say), say)
        _keep(language, teacher, options.name, say)
    except RecogniserError as reason:
        raise Refused(str(reason))


def _recordings(folder):
    """Return a function from a sentence to the sound of its file, b'' without one."""
    from mhri.voice.io.teaching import next_sentence

    def hear(text):
        path = os.path.join(folder, text.replace(' ', '_') + '.wav')
        if not os.path.exists(path):
            return b''
        source = WavFile(path, paced=False)
        source.open()
        try:
            return next_sentence(source)
        finally:
            source.close()
    return hear


def _live(text, say):
    """Return a function from a sentence to the sound of somebody who reads it."""
    from mhri.voice.io.teaching import next_sentence
    source = open_source(text)
    say('Listening to {}.\n{}\n'.format(source.open(), _HELP))

    def hear(_):
        return next_sentence(source)
    return hear


def _read_all(language, teacher, hear, say, tries=_TRIES):
    """Have every sentence read.

    :raises Refused: too few of them were good
    """
    texts = language.teach + language.teach_check
    for number, text in enumerate(texts, 1):
        say('{} of {}:  {}'.format(number, len(texts), text))
        for left in reversed(range(tries)):
            problem = teacher.take(text, hear(text))
            if not problem:
                break
            say('    {}{}'.format('again: ' if left else 'left out: ', problem))
    for kind in (language.teach, language.teach_check):
        if teacher.good(kind) < _ENOUGH * len(kind):
            raise Refused('only {} of {} sentences could be used; nothing was kept. Read the '
                          'reasons above, and try again'.format(teacher.good(kind), len(kind)))


def _keep(language, teacher, name, say):
    """Learn the voice, and keep it if it is understood better.

    :raises Refused: it is not
    """
    say('Learning; this takes a minute.')
    path = voice_path(name, os.environ)
    part = path + '.part'
    os.makedirs(os.path.dirname(path), exist_ok=True)
    try:
        with open(part, 'wb') as stream:
            stream.write(teacher.learn())
        (before, wrong_before), (now, wrong) = teacher.understood(), teacher.understood(part)
        say('Of {} sentences that check it, {} were understood before, {} are now.'.format(
            teacher.good(language.teach_check), before, now))
        if now - wrong < before - wrong_before:
            raise Refused('the voice was understood better before; nothing was kept. Read it again '
                          'in a quiet place, each word whole')
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)
    say('Kept: {}\nUse it now:   rosparam set /mhri_voice/voice {}\nand always:   mhri_run.sh '
        'voice:={}'.format(path, name, name))


def main():
    """Teach, or say why not; exit."""
    options = parse(sys.argv[1:])
    try:
        teach(options, lambda text: print(text, flush=True))
    except KeyboardInterrupt:
        sys.exit('\nended: nothing was kept')
    except (DeviceAbsent, DeviceLost) as reason:
        sys.exit('there is nothing to listen to: {}; nothing was kept'.format(reason))
    except (Refused, ConfigError, ModelError) as reason:
        sys.exit('mhri_voice_teach: {}'.format(short(reason)))
    except OSError as error:
        sys.exit('mhri_voice_teach: {}: {}; make it readable and writable, or set ROS_HOME'.format(
            error.filename or 'the voice', error.strerror or error))
