# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU time that the obstacle brake takes of a depth camera: a picture of 640x480, ten a second."""
import argparse
import os
import sys
import time

import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.mocap import Pose  # noqa: E402
from mhri.camera.depth_codec import decode_depth, encode_depth  # noqa: E402
from mhri.camera.raw_image import metres  # noqa: E402
from mhri.sensors.brake import Surroundings  # noqa: E402
from mhri.sensors.depth_beams import DepthBeams  # noqa: E402
from support.depth_world import LENS  # noqa: E402
from support.pictures import depth_picture  # noqa: E402

HZ = 10.0
MOUNT = np.array([[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.3],
                  [0.0, 0.0, 0.0, 1.0]])


def main():
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='20 pictures instead of 300')
    count = 20 if parser.parse_args().short else 300
    cv2.setNumThreads(1)
    mm, beams, seen = depth_picture(), DepthBeams(), Surroundings()
    coded = encode_depth(mm, 'png')
    for name, decode in (('compressedDepth png', lambda: decode_depth(*coded)[0]),
                         ('raw 16UC1', lambda: metres(mm))):
        found = []
        for _ in range(count + 5):
            begun = time.process_time()
            seen.see(beams.scan(decode(), LENS, MOUNT), Pose(0.0, 0.0, 0.0))
            found.append(1e3 * (time.process_time() - begun))
        found = sorted(found[5:])
        print('MEASURED {}: {:.1f} ms of CPU a picture (p95 {:.1f}), {:.3f} of a core at {:g} Hz'
              .format(name, found[count // 2], found[int(0.95 * count)],
                      found[count // 2] * HZ / 1e3, HZ))


if __name__ == '__main__':
    main()
