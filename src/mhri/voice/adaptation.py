# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Adapts the acoustic model to one person's voice, from sentences with known text.

Only the means of the Gaussians are adapted, in the two standard steps: an affine transformation of
all means that maximises the likelihood of the sentences (MLLR: Leggetter and Woodland, 1995), and
then a shift of each mean towards its observed mean (MAP: Gauvain and Lee, 1994). The rest of the
model is unchanged. Silence takes only the second step, since it depends on the room: without that,
the sounds beside a pause become like the room, and pauses seem spoken. This works for phonetically
tied models with one codebook for each sound, such as pocketsphinx-en-us.
"""
import struct
from dataclasses import dataclass, replace
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

SILENCE = 'SIL'
_NOT_SPOKEN = [SILENCE, '+NSN+', '+SPN+']
# Frames of 10 ms. With a single MAP step and an inertia of 10, a sound that a voice pronounces very
# differently from the model stayed halfway: "deselect" was recognised as "please select".
_TRANSFORMATIONS, _REST_FRAMES, _DRAWN, _INERTIA = 2, 20.0, 3, 5.0
_STATES = 3
_MIN_WEIGHT = 1e-7
_MIN_VARIANCE = 1e-4
# One step of the logarithms in pocketsphinx's files: 2^10 in base 1.0001.
_STEP = 1024 * np.log(1.0001)


class ModelError(Exception):
    """A file of the model has unexpected content; the text names it."""


@dataclass(frozen=True)
class Sounds:
    """An acoustic model.

    ``means`` and ``variances`` are [sound, stream, density, dimension], ``weights`` [sound, state,
    stream, density], for context-independent sounds; ``phones`` are the names of the sounds.
    """

    phones: Tuple[str, ...]
    means: np.ndarray
    variances: np.ndarray
    weights: np.ndarray


def read_gaussians(data: bytes, name: str) -> np.ndarray:
    """Return the numbers in a file ``means`` or ``variances``.

    :raises ModelError: it is not such a file, or its streams differ in size
    """
    head, mark, rest = data.partition(b'endhdr\n')
    if not mark or len(rest) < 32 or rest[:4] != b'\x44\x33\x22\x11':
        raise ModelError('{} is not a file of Gaussians'.format(name))
    books, streams, densities = struct.unpack_from('<3i', rest, 4)
    if not 0 < streams <= 4:
        raise ModelError('{} has {} streams'.format(name, streams))
    sizes = struct.unpack_from('<{}i'.format(streams), rest, 16)
    at = 16 + 4 * streams
    count, = struct.unpack_from('<i', rest, at)
    if len(set(sizes)) != 1 or count != books * densities * sum(sizes):
        raise ModelError('{} has streams of several sizes'.format(name))
    if len(rest) < at + 4 + 4 * count:
        raise ModelError('{} is cut off'.format(name))
    values = np.frombuffer(rest, '<f4', count, at + 4)
    if not np.isfinite(values).all():
        raise ModelError('{} contains NaN or infinity'.format(name))
    return values.reshape(books, streams, densities, sizes[0]).astype(float)


def write_gaussians(values: np.ndarray) -> bytes:
    """Return the content of a file for :func:`read_gaussians`."""
    books, streams, densities, size = values.shape
    head = struct.pack('<4i', 0x11223344, books, streams, densities)
    head += struct.pack('<{}i'.format(streams + 1), *[size] * streams, values.size)
    return b's3\nversion 1.0\nendhdr\n' + head + bytes(values.astype('<f4').tobytes())


def read_phones(data: bytes) -> Tuple[str, ...]:
    """Return the names of the sounds in a file ``mdef``, in the order of their codebooks.

    :raises ModelError: it is not a binary mdef, or its sounds do not have three states each
    """
    if data[:4] != b'BMDF':
        raise ModelError('mdef is not binary')
    length, = struct.unpack_from('<i', data, 8)
    if len(data) < 52 + length:
        raise ModelError('mdef is cut off')
    count, _, states, pdfs = struct.unpack_from('<4i', data, 12 + length)
    names = data[12 + length + 40:].split(b'\0', count)[:count]
    if states != _STATES or pdfs != _STATES * count:
        raise ModelError('the sounds of mdef have not three states each')
    return tuple(name.decode() for name in names)


def read_weights(data: bytes, phones: int) -> np.ndarray:
    """Return the weights of the densities in a file ``sendump``, for context-independent sounds.

    :raises ModelError: its weights are clustered
    """
    at, texts = 0, []
    while True:
        length, = struct.unpack_from('<i', data, at)
        at += 4
        if not length:
            break
        texts.append(data[at:at + length - 1].decode('ascii', 'replace'))
        at += length
    densities, pdfs = struct.unpack_from('<2i', data, at)
    streams = [int(text.split()[1]) for text in texts if text.startswith('feature_count')]
    if 'cluster_count 0' not in texts or not streams:
        raise ModelError('the weights of sendump are clustered')
    costs = np.frombuffer(data, np.uint8, streams[0] * densities * pdfs, at + 8)
    costs = costs.reshape(streams[0], densities, pdfs)[:, :, :_STATES * phones]
    weights = np.exp(-_STEP * costs.astype(float)).reshape(streams[0], densities, phones, _STATES)
    return weights.transpose(2, 3, 0, 1) + _MIN_WEIGHT


def features(cepstra: np.ndarray) -> np.ndarray:
    """Return the features [frame, stream, dimension] of cepstra [frame, dimension].

    As in pocketsphinx, these are the cepstra minus their mean, with first and second differences.
    """
    whole = np.pad(cepstra - cepstra.mean(axis=0), ((3, 3), (0, 0)), 'edge')
    count = len(cepstra)

    def at(shift: int) -> np.ndarray:
        return whole[3 + shift:3 + shift + count]
    return np.stack([at(0), at(2) - at(-2), at(3) - at(-1) - (at(1) - at(-3))], axis=1)


class Network(NamedTuple):
    """The states of a sentence: its sounds, with optional silence at possible pauses.

    ``sound`` and ``state`` [place]; ``before`` [place, way]: the possible predecessors, first the
    place itself; ``first`` and ``last``: the places where a sentence may begin and end.
    """

    sound: np.ndarray
    state: np.ndarray
    before: np.ndarray
    first: List[int]
    last: List[int]


def network(words: Sequence[Sequence[Sequence[int]]], silence: int) -> Network:
    """Return the network of words, each given by its pronunciations (sounds)."""
    sound: List[int] = []
    state: List[int] = []
    before: List[List[int]] = []

    def add(way: Sequence[int], comes_from: List[int]) -> int:
        for place, phone in enumerate(way):
            for step in range(_STATES):
                sound.append(phone)
                state.append(step)
                own = len(before)
                before.append([own] + (comes_from if not place and not step else [own - 1]))
        return len(before) - 1
    ends = [add([silence], [])]
    first = [0]
    for number, ways in enumerate(words):
        begins = len(before)
        last = [add(way, ends) for way in ways]
        if not number:
            # A sentence may begin without silence.
            first += [begins] + [end + 1 for end in last[:-1]]
        ends = last + [add([silence], last)]
    width = max(len(row) for row in before)
    rows = [row + [row[0]] * (width - len(row)) for row in before]
    return Network(np.array(sound), np.array(state), np.array(rows), first, ends)


def densities(sounds: Sounds, frames: np.ndarray, phone: int) -> np.ndarray:
    """Return the logarithm of each density of a sound [frame, stream, density]."""
    means, variances = sounds.means[phone], np.maximum(sounds.variances[phone], _MIN_VARIANCE)
    over = 1.0 / variances
    frames = frames.transpose(1, 0, 2)
    square = (frames ** 2 @ over.transpose(0, 2, 1)
              - 2.0 * frames @ (means * over).transpose(0, 2, 1)
              + (means ** 2 * over).sum(axis=2)[:, None])
    logs = -0.5 * (square + np.log(2.0 * np.pi * variances).sum(axis=2)[:, None])
    return np.asarray(logs.transpose(1, 0, 2))


def path(sounds: Sounds, frames: np.ndarray, net: Network) -> Tuple[np.ndarray, float]:
    """Return the place of each frame on the most likely path through a network, and its score."""
    scores = np.zeros((len(frames), len(net.sound)))
    for phone in set(net.sound.tolist()):
        own = densities(sounds, frames, phone)
        top = own.max(axis=2, keepdims=True)
        shares = np.exp(own - top)
        for state in range(_STATES):
            likely = (np.log((shares * sounds.weights[phone, state]).sum(axis=2))
                      + top[:, :, 0]).sum(axis=1)
            scores[:, (net.sound == phone) & (net.state == state)] = likely[:, None]
    best = np.full(len(net.sound), -np.inf)
    best[net.first] = scores[0, net.first]
    came = np.zeros(scores.shape, dtype=int)
    every = np.arange(len(net.sound))
    for at in range(1, len(frames)):
        ways = best[net.before]
        chosen = ways.argmax(axis=1)
        came[at] = net.before[every, chosen]
        best = ways[every, chosen] + scores[at]
    place = max(net.last, key=lambda end: best[end])
    total = float(best[place])
    places = [place]
    for at in range(len(frames) - 1, 0, -1):
        places.append(int(came[at, places[-1]]))
    return np.array(places[::-1]), total


@dataclass(frozen=True)
class Counts:
    """Observations of each density: total weight [sound, stream, density], and weighted sum."""

    amount: np.ndarray
    total: np.ndarray


def count(sounds: Sounds, said: Sequence[Tuple[np.ndarray, Network]]) -> Counts:
    """Count the observations of each density in sentences, given as frames and network."""
    amount = np.zeros(sounds.means.shape[:3])
    total = np.zeros(sounds.means.shape)
    for frames, net in said:
        places, _ = path(sounds, frames, net)
        for phone in set(net.sound[places].tolist()):
            chosen = net.sound[places] == phone
            own, states = frames[chosen], net.state[places][chosen]
            logs = densities(sounds, own, phone) + np.log(sounds.weights[phone][states])
            shares = np.exp(logs - logs.max(axis=2, keepdims=True))
            shares /= shares.sum(axis=2, keepdims=True)
            amount[phone] += shares.sum(axis=0)
            total[phone] += np.einsum('tsk,tsd->skd', shares, own)
    return Counts(amount, total)


def transformed(sounds: Sounds, counts: Counts) -> Sounds:
    """Return the sounds with all means under the best-fitting affine transformation (MLLR)."""
    spoken = ~np.isin(sounds.phones, _NOT_SPOKEN)
    means = sounds.means.copy()
    size = means.shape[3]
    for stream in range(means.shape[1]):
        old = sounds.means[spoken, stream].reshape(-1, size)
        weight = 1.0 / np.maximum(sounds.variances[spoken, stream], _MIN_VARIANCE)
        weight = weight.reshape(-1, size)
        amount = counts.amount[spoken, stream].reshape(-1, 1)
        total = counts.total[spoken, stream].reshape(-1, size)
        one = np.hstack([np.ones((len(old), 1)), old])
        # A prior with the weight of a few frames for no change: rare sounds stay where they are.
        stay = _REST_FRAMES * np.diag((one ** 2).mean(axis=0))
        moved = np.empty_like(old)
        for row in range(size):
            own = weight[:, row:row + 1]
            kept = own.mean() * stay
            matrix = np.linalg.solve(one.T @ (amount * own * one) + kept,
                                     one.T @ (total[:, row:row + 1] * own)
                                     + kept[:, row + 1:row + 2])
            moved[:, row] = (one @ matrix)[:, 0]
        means[spoken, stream] = moved.reshape(-1, means.shape[2], size)
    return replace(sounds, means=means)


def drawn(sounds: Sounds, said: Sequence[Tuple[np.ndarray, Network]]) -> Sounds:
    """Return the sounds with each mean shifted towards its observed mean (MAP).

    The frames are assigned again in each iteration; the means start from the same model.
    """
    moved = sounds
    for _ in range(_DRAWN):
        counts = count(moved, said)
        moved = replace(sounds, means=(_INERTIA * sounds.means + counts.total)
                        / (_INERTIA + counts.amount[..., None]))
    return moved


def adapted(sounds: Sounds, said: Sequence[Tuple[np.ndarray, Network]]) -> Sounds:
    """Return the sounds adapted to the voice in some sentences.

    :param said: :func:`features` and :func:`network` of each sentence
    """
    for _ in range(_TRANSFORMATIONS):
        sounds = transformed(sounds, count(sounds, said))
    return drawn(sounds, said)
