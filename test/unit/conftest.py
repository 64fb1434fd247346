# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""These tests run where there is no ROS and nothing is built, so none of them may import it."""
import re
import sys

ROS = re.compile(r'((ros|gen)(py|lib|graph|launch|bag|param|topic|service|node|msg)|actionlib|tf'
                 r'|tf2_\w+|cv_bridge|diagnostic_updater|message_filters|mhri\.(msg|srv)'
                 r'|\w+_(msgs|srvs))\Z')


class Refusal:
    """An importer that refuses ROS even where it is installed."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        """Refuse a module of ROS; leave every other one to the next importer.

        :raises ImportError: the module belongs to ROS, or is generated from the messages of mhri
        """
        if ROS.match(name):
            raise ImportError('{} is of ROS, which tests in test/unit do without: put the test in '
                              'test/ros'.format(name), name=name)


sys.meta_path.insert(0, Refusal)
