# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_voice_teach``: learns an operator's voice from sentences read aloud.

It needs no master. The exit status is 0 if the voice was saved, else 1.
"""
import argparse
import os
import sys

from mhri.base.config import ConfigError, short
from mhri.base.io.files import whole
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.graph.ros.resources import read_text, resource_path
from mhri.voice.adaptation import ModelError
from mhri.voice.io.audio import open_source, WavFile
from mhri.voice.io.listening import missing
from mhri.voice.language import parse_language
from mhri.voice.teaching import voice_path, voice_problem

# A sentence that stays bad is left out after this many tries.
_TRIES = 3
# Minimum share of good sentences for learning a voice.
_ENOUGH = 0.6
_HELP = ('Read each sentence aloud when it is shown, the way you talk to the robots: at an even\n'
         'pace, the mouth a hand\'s width from the microphone. It takes about four minutes.\n'
         'Ctrl-C cancels; then nothing is saved.')


class Refused(Exception):
    """The voice is not saved; the text has the reason and the remedy."""


def parse(argv):
    """Return the options of a command line."""
    parser = argparse.ArgumentParser(
        prog='mhri_voice_teach', description='Teach mhri_voice your voice, once: read some '
        'sentences aloud. Use it with: rosparam set /mhri_voice/voice NAME')
    parser.add_argument('name', metavar='NAME', help='name for the voice')
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
    """Record the sentences, and save the voice.

    :raises Refused, ConfigError, DeviceAbsent, DeviceLost, ModelError, OSError: it is not saved
    """
    path = options.language if '/' in options.language else resource_path(
        'voice', options.language + '.yaml')
    language = parse_language(read_text(path), path)
    if missing():
        raise Refused(missing())
    # Imported late: loading takes a second.
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
        _save(language, teacher, options.name, say)
    except RecogniserError as reason:
        raise Refused(str(reason))


def _recordings(folder):
    """Return a function that returns the sound in the file of a sentence, b'' without one."""
    from mhri.voice.io.teaching import next_sentence

    def record(text):
        path = os.path.join(folder, text.replace(' ', '_') + '.wav')
        if not os.path.exists(path):
            return b''
        source = WavFile(path, paced=False)
        source.open()
        try:
            return next_sentence(source)
        finally:
            source.close()
    return record


def _live(text, say):
    """Return a function that records the operator reading a sentence."""
    from mhri.voice.io.teaching import next_sentence
    source = open_source(text)
    say('Listening to {}.\n{}\n'.format(source.open(), _HELP))

    def record(_):
        return next_sentence(source)
    return record


def _read_all(language, teacher, record, say, tries=_TRIES):
    """Record every sentence.

    :raises Refused: too few sentences were good
    """
    texts = language.teach + language.teach_check
    for number, text in enumerate(texts, 1):
        say('{} of {}:  {}'.format(number, len(texts), text))
        for left in reversed(range(tries)):
            problem = teacher.take(text, record(text))
            if not problem:
                break
            say('    {}{}'.format('again: ' if left else 'left out: ', problem))
    for kind in (language.teach, language.teach_check):
        if teacher.good(kind) < _ENOUGH * len(kind):
            raise Refused('only {} of {} sentences could be used; nothing was saved. Read the '
                          'reasons above, and try again'.format(teacher.good(kind), len(kind)))


def _save(language, teacher, name, say):
    """Learn the voice, and save it if it is recognised better.

    :raises Refused: it is not recognised better
    """
    say('Learning; this takes a minute.')
    path = voice_path(name, os.environ)
    with whole(path) as part:
        with open(part, 'wb') as stream:
            stream.write(teacher.learn())
        (before, wrong_before), (now, wrong) = teacher.understood(), teacher.understood(part)
        say('Of {} test sentences, {} were understood before, and {} are now.'.format(
            teacher.good(language.teach_check), before, now))
        if now - wrong < before - wrong_before:
            raise Refused('the voice was understood better before; nothing was saved. Try again in '
                          'a quiet place, and finish each word')
    say('Saved: {}\nUse it now:   rosparam set /mhri_voice/voice {}\nand always:   mhri_run.sh '
        'voice:={}'.format(path, name, name))


def main():
    """Run the program and exit; print the reason if no voice was saved."""
    options = parse(sys.argv[1:])
    try:
        teach(options, lambda text: print(text, flush=True))
    except KeyboardInterrupt:
        sys.exit('\ncancelled; nothing was saved')
    except (DeviceAbsent, DeviceLost) as reason:
        sys.exit('no sound source: {}; nothing was saved'.format(reason))
    except (Refused, ConfigError, ModelError) as reason:
        sys.exit('mhri_voice_teach: {}'.format(short(reason)))
    except OSError as error:
        sys.exit('mhri_voice_teach: {}: {}; make it readable and writable, or set ROS_HOME'.format(
            error.filename or 'the voice', error.strerror or error))
