# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames cut out of a stream."""
import struct

import pytest

from mhri.recording.frames import FrameSplitter

FRAMES = [struct.pack('<I', size) + bytes([65 + size % 26]) * size
          for size in (0, 1, 3, 4, 5, 70, 0, 1000)]


@pytest.mark.parametrize('step', [1, 3, 7, 1000, 10000])
def test_frames_of_a_stream_in_pieces(step):
    stream, splitter, found = b''.join(FRAMES), FrameSplitter(), []
    for start in range(0, len(stream), step):
        found += splitter.split(stream[start:start + step])
    assert found == FRAMES


def test_what_is_missing_of_a_long_message():
    splitter = FrameSplitter()
    assert list(splitter.split(struct.pack('<I', 1000) + b'x' * 300)) == []
    assert splitter.wanted == 700
    assert list(splitter.split(b'x' * 699)) == [] and splitter.wanted == 1
    assert [len(item) for item in splitter.split(b'x')] == [1004]
    assert splitter.wanted == 0


def test_a_length_that_cannot_be():
    with pytest.raises(ValueError):
        FrameSplitter().split(struct.pack('<I', 2 * 10 ** 9) + b'x')
