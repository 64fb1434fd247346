# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RVL, the lossless depth code of A. D. Wilson, "Fast Lossless Depth Image Compression" (2017).

The pixels are runs of zeros and of others in turn: (count of zeros, count of others, the others),
the others as the zigzag difference to the one before. Every number is written three bits to a
nibble, the lowest first, with 8 added while more follow; nibbles fill 32-bit little-endian words
from the top. All numbers are read and written at once here, with numpy; only the heads of the runs
are followed one by one.
"""
import numpy as np

from mhri.core.frames import FrameError

_LONGEST = 10  # nibbles of a number below 2^30
_PART = 32_768  # nibbles read at once: what is worked on stays in the cache


def decode_rvl(payload, pixels):
    """Return the uint16 array of so many pixels that an RVL stream holds.

    :param payload: bytes of the stream, without any header
    :param pixels: number of pixels expected, > 0; the caller has checked that it is not absurd
    :raises FrameError: the stream ends early, or does not fit the number of pixels
    """
    numbers = _read_numbers(payload)
    heads, end = _heads(memoryview(numbers), pixels)
    counts = np.empty((len(heads), 2), np.intp)
    counts[:, 0] = numbers[heads]
    counts[:, 1] = numbers[heads + 1]
    if counts.min() < 0 or counts.sum() != pixels or end > len(numbers):
        raise FrameError('rvl: truncated or corrupted, its runs do not make {} pixels'.format(
            pixels))
    is_delta = np.ones(end, bool)
    is_delta[heads] = False
    is_delta[heads + 1] = False
    # In place where it can be: fresh arrays of this size cost more than the sums.
    values = numbers[:end][is_delta]
    signs = values & 1
    np.negative(signs, out=signs)
    values >>= 1
    values ^= signs
    np.cumsum(values, out=values)
    valid = np.repeat(np.tile((False, True), len(heads)), counts.ravel())
    image = np.zeros(pixels, np.uint16)
    image[valid] = values
    return image


def _read_numbers(payload):
    """Return every number of a stream as int32, in order.

    :raises FrameError: a number is longer than any that is written
    """
    words = np.frombuffer(payload, '<u4', len(payload) // 4)
    packed = words.astype('>u4').view(np.uint8)
    nibbles = np.empty((len(packed), 2), np.uint8)
    np.right_shift(packed, 4, out=nibbles[:, 0])
    np.bitwise_and(packed, 15, out=nibbles[:, 1])
    nibbles = nibbles.ravel()
    parts, begin = [], 0
    while begin < len(nibbles):
        part = nibbles[begin:begin + _PART]
        numbers, used = _read_part(part)
        parts.append(numbers)
        begin += used
        if used == 0:
            break
    return np.concatenate(parts) if parts else np.empty(0, np.int32)


def _read_part(nibbles):
    """Return the numbers that end in a part of the nibbles, and how many nibbles they took."""
    lasts = np.flatnonzero(nibbles < 8)
    numbers = nibbles[lasts].astype(np.int32)
    lengths = np.diff(lasts, prepend=-1)
    longest = lengths.max() if len(lasts) else len(nibbles)
    if longest > _LONGEST:
        raise FrameError('rvl: corrupted, a number of {} digits'.format(longest))
    # The nibbles before the last of a number, from the second last on: ever fewer have one more.
    which = np.flatnonzero(lengths > 1)
    places, left = lasts[which], lengths[which] - 1
    while len(which):
        places -= 1
        numbers[which] = (numbers[which] << 3) | (nibbles[places] & 7)
        left -= 1
        more = left > 0
        which, places, left = which[more], places[more], left[more]
    return numbers, int(lasts[-1]) + 1 if len(lasts) else 0


def _heads(numbers, pixels):
    """Return where the heads of the runs are among the numbers, and where the last run ends."""
    heads = []
    place, left = 0, pixels
    try:
        while left > 0:
            heads.append(place)
            others = numbers[place + 1]
            left -= numbers[place] + others
            if others < 0:
                break
            place += others + 2
    except IndexError:
        raise FrameError('rvl: truncated, {} of {} pixels are missing'.format(left, pixels))
    return np.array(heads, np.intp), place


def encode_rvl(image):
    """Return the RVL stream of a uint16 array of any shape, as bytes."""
    pixels = np.ascontiguousarray(image, np.uint16).ravel()
    valid = pixels != 0
    edges = np.flatnonzero(np.diff(valid, prepend=False, append=False))
    begins, ends = edges[0::2], edges[1::2]
    zeros = begins - np.concatenate(([0], ends[:-1])) if len(begins) else begins
    others = ends - begins
    tail = len(pixels) - (ends[-1] if len(ends) else 0)
    if tail:
        zeros, others = np.append(zeros, tail), np.append(others, 0)
    heads = 2 * np.arange(len(zeros)) + np.cumsum(others) - others
    deltas = np.diff(pixels[valid].astype(np.int32), prepend=0)
    numbers = np.empty(2 * len(zeros) + len(deltas), np.int32)
    is_delta = np.ones(len(numbers), bool)
    is_delta[heads] = False
    is_delta[heads + 1] = False
    numbers[heads] = zeros
    numbers[heads + 1] = others
    numbers[is_delta] = (deltas << 1) ^ (deltas >> 31)
    return _write_numbers(numbers)


def _write_numbers(numbers):
    """Return the stream of int32 numbers >= 0."""
    lengths = np.ones(len(numbers), np.intp)
    for digits in range(1, _LONGEST):
        longer = numbers >= 8 ** digits
        if not longer.any():
            break
        lengths += longer
    ends = np.cumsum(lengths)
    total = int(ends[-1]) if len(ends) else 0
    nibbles = np.zeros((total + 7) // 8 * 8, np.uint8)
    places, left, rest = ends - lengths, lengths, numbers
    while len(places):
        more = left > 1
        nibbles[places] = (rest & 7) | (more << 3)
        places, left, rest = places[more] + 1, left[more] - 1, rest[more] >> 3
    packed = (nibbles[0::2] << 4) | nibbles[1::2]
    return packed.view('>u4').astype('<u4').tobytes()
