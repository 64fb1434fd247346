# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""RVL, the lossless depth code of A. D. Wilson, "Fast Lossless Depth Image Compression" (2017).

The pixels are alternating runs of zeros and of others: (count of zeros, count of others, the
others), the others as zigzag-encoded differences to their predecessors. Numbers have three bits per
nibble, the lowest first, with 8 added while more follow; nibbles fill 32-bit little-endian words
from the top. This module reads and writes all numbers at once, with numpy; only the heads of the
runs are read one by one. ROS has this code in C++ alone (compressed_depth_image_transport).
"""
from typing import Tuple

import numpy as np


from mhri.base.wire import Data
from mhri.camera.images import FrameError

_MAX_DIGITS = 10  # nibbles of a number below 2^30
_PART = 65_536  # nibbles read at once, few enough to stay in the cache


def _pairs() -> np.ndarray:
    """Return the value of a number's last nibble with its predecessor: [16 * last + before].

    A predecessor below 8 belongs to the previous number.
    """
    last, before = np.divmod(np.arange(256, dtype=np.int32), 16)
    return np.where(before >= 8, (last << 3) | (before & 7), last).astype(np.int32)


_PAIRS = _pairs()


def decode_rvl(payload: Data, pixels: int) -> np.ndarray:
    """Return the pixels of an RVL stream as a uint16 array.

    :param payload: bytes of the stream, without any header
    :param pixels: number of pixels expected, > 0; the caller has checked that it is not absurd
    :raises FrameError: the stream ends early, or does not fit the number of pixels
    """
    numbers = _read_numbers(payload)
    heads, end = _heads(memoryview(numbers), pixels)
    zeros, others = numbers[heads].astype(np.intp), numbers[heads + 1].astype(np.intp)
    if min(zeros.min(), others.min()) < 0 or zeros.sum() + others.sum() != pixels \
            or end > len(numbers):
        raise FrameError('rvl: truncated or corrupted, its runs do not make {} pixels'.format(
            pixels))
    # In place if possible: allocating arrays of this size takes longer than the sums.
    values = numbers[:end]
    values[heads] = values[heads + 1] = 0
    signs = values & 1
    np.negative(signs, out=signs)
    values >>= 1
    values ^= signs
    np.cumsum(values, out=values)
    # The place of each number; the counts go after the last pixel.
    places = np.repeat(np.cumsum(zeros + others) - others - heads - 2, others + 2)
    places += np.arange(end)
    places[heads] = places[heads + 1] = pixels
    image = np.zeros(pixels + 1, np.uint16)
    image[places] = values
    return image[:pixels]


def _read_numbers(payload: Data) -> np.ndarray:
    """Return every number of a stream as int32, in order.

    :raises FrameError: a number is longer than any encoder writes
    """
    words = np.frombuffer(payload, '<u4', len(payload) // 4)
    packed = words.astype('>u4').view(np.uint8)
    # Padding before the first number.
    nibbles = np.zeros(_MAX_DIGITS + 2 * len(packed), np.uint8)
    np.right_shift(packed, 4, out=nibbles[_MAX_DIGITS::2])
    np.bitwise_and(packed, 15, out=nibbles[_MAX_DIGITS + 1::2])
    if nibbles[-_MAX_DIGITS - 1:].min() >= 8:
        raise _too_long()
    parts = [_read_part(nibbles, begin, min(begin + _PART, len(nibbles)))
             for begin in range(_MAX_DIGITS, len(nibbles), _PART)]
    return np.concatenate(parts) if parts else np.empty(0, np.int32)


def _too_long() -> FrameError:
    return FrameError('rvl: corrupted, a number of more than {} digits'.format(_MAX_DIGITS))


def _read_part(nibbles: np.ndarray, begin: int, end: int) -> np.ndarray:
    """Return the numbers whose last nibble is in a part of the nibbles."""
    last, before, earlier = (nibbles[begin - back:end - back] for back in range(3))
    ends = np.flatnonzero(last < 8)
    numbers = _PAIRS[((last << 4) | before)[ends]]
    # Most numbers have at most two nibbles; ever fewer have one more.
    which = np.flatnonzero(((before >= 8) & (earlier >= 8))[ends])
    places, digits = ends[which] + begin - 1, 2
    while len(which):
        digits += 1
        if digits > _MAX_DIGITS:
            raise _too_long()
        places -= 1
        numbers[which] = (numbers[which] << 3) | (nibbles[places] & 7)
        more = nibbles[places - 1] >= 8
        which, places = which[more], places[more]
    return numbers


def _heads(numbers: memoryview, pixels: int) -> Tuple[np.ndarray, int]:
    """Return the indices of the heads of the runs in the numbers, and the end of the last run."""
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


def encode_rvl(image: np.ndarray) -> bytes:
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


def _write_numbers(numbers: np.ndarray) -> bytes:
    """Return the stream of int32 numbers >= 0."""
    lengths = np.ones(len(numbers), np.intp)
    for digits in range(1, _MAX_DIGITS):
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
    stream: bytes = packed.view('>u4').astype('<u4').tobytes()
    return stream
