# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Helpers shared by tests and benchmarks."""
import os
import unittest

# test/run.py runs one test of a node alone: rostest has no option for it.
if os.environ.get('MHRI_TEST_ONLY'):
    unittest.TestLoader.testNamePatterns = [os.environ['MHRI_TEST_ONLY']]
