# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The format of sound in mhri: mono, 16 bit little endian, 16 kHz, in blocks of 20 ms.

It is a separate module, so that the search for a microphone once a second does not load numpy.
"""
RATE_HZ = 16000
BLOCK_S = 0.02
BLOCK_BYTES = int(RATE_HZ * BLOCK_S) * 2
# The model of the recogniser, as Debian and Ubuntu install it (pocketsphinx-en-us).
MODEL = '/usr/share/pocketsphinx/model/en-us'
# Its speaker-independent acoustic model.
SOUNDS = MODEL + '/en-us'
