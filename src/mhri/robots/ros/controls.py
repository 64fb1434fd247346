# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests control of linked robots (``mhri_link``), for the screen."""
import threading

from std_srvs.srv import Trigger

from mhri.graph.ros.node_client import call


def ask_for_control(name, on_answer):
    """Request control of a robot, without blocking; a second request takes it.

    :param on_answer: called with the answer, a sentence, on its own thread
    """
    def ask():
        """Send the request and wait for the answer."""
        answer = call('/{}/mhri_link/take_control'.format(name), Trigger)
        text = answer.message if answer else 'cannot ask for control: its link does not answer'
        on_answer('{}: {}'.format(name, text))
    threading.Thread(target=ask, name='ask', daemon=True).start()
