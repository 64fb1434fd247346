# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How different two colours look, with each kind of colour vision.

Colour vision deficiencies are simulated after Machado, Oliveira and Fernandes (2009), complete ones
(severity 1.0); distances are those of OKLab (Ottosson, 2020), where 2 is just noticeable and
lightness goes from 0 to 100.
"""
import numpy as np

SIGHTS = {
    'usual': np.eye(3),
    'protan': np.array(((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216),
                        (-0.003882, -0.048116, 1.051998))),
    'deutan': np.array(((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413),
                        (-0.011820, 0.042940, 0.968881))),
    'tritan': np.array(((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602),
                        (0.004733, 0.691367, 0.303900)))}
LMS = np.array(((0.4122214708, 0.5363325363, 0.0514459929),
                (0.2119034982, 0.6806995451, 0.1073969566),
                (0.0883024619, 0.2817188376, 0.6299787005)))
LAB = np.array(((0.2104542553, 0.7936177850, -0.0040720468),
                (1.9779984951, -2.4285922050, 0.4505937099),
                (0.0259040371, 0.7827717662, -0.8086757660)))


def seen(colour, sight):
    """Return how a colour "#RRGGBB" looks, as OKLab."""
    parts = np.array([int(colour[place:place + 2], 16) / 255.0 for place in (1, 3, 5)])
    light = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return 100.0 * LAB @ np.cbrt(LMS @ np.clip(SIGHTS[sight] @ light, 0.0, 1.0))


def apart(one, other, sight):
    """Return how different two colours look."""
    return float(np.linalg.norm(seen(one, sight) - seen(other, sight)))
