# SPDX-FileCopyrightText: 2026 The lab
# SPDX-License-Identifier: BSD-3-Clause
"""Used by catkin_python_setup() alone; do not call it by hand."""
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=['lab_tasks'], package_dir={'': 'src'}))
