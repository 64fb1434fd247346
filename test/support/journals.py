# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The journal of the drives of a test, and whether all that left is what the drive says."""
import os
import time

from mhri.driving.io.journal_file import replay_file


class Journal:
    """The journal of all drives of a test, in its folder.

    :param folder: one that lasts until :meth:`conforms`
    """

    def __init__(self, folder):
        self.path = os.path.join(str(folder), 'drive.journal')
        #: the argument that lets a mux write it
        self.argument = '_journal:=' + self.path

    def conforms(self):
        """Show that every velocity that left is what the drive says; print how many they were."""
        begun = time.monotonic()
        report = replay_file(self.path)
        print('\nMEASURED journal: {} bytes, {} drives, {} events, {} velocities that left; '
              'replayed in {:.1f} s'.format(os.path.getsize(self.path), report.runs, report.events,
                                            report.velocities, time.monotonic() - begun))
        assert not report.difference, '\n'.join((report.difference,) + report.shortest)
        assert report.velocities, 'nothing was told'
