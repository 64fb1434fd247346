#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Takes the guide's pictures of the page, of its demo: ``web_pictures.py <folder>``.

``web_phone.png``, ``web_tablet.png`` (it drives) and ``web_wall.png`` (one robot is lost).
"""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.browser import Browser  # noqa: E402
from support.ros_system import node_words, wait_for  # noqa: E402


def main(folder):
    """Serve the demo, and take the pictures into a folder."""
    server = subprocess.Popen(node_words('mhri_web', '--demo'), stdout=subprocess.PIPE)
    address = server.stdout.readline().decode().strip()
    with tempfile.TemporaryDirectory() as profile:
        browser = Browser(profile)
        try:
            browser.open(address + '=watch', (390, 844), True)
            browser.wait('return document.querySelector(".cell[data-name=bot1]")').click()
            take(browser, os.path.join(folder, 'web_phone.png'))
            browser.open(address, (1024, 768), True)
            browser.wait('return document.getElementById("stick").dataset.is === "free"')
            x, y = browser.middle('#pad')
            browser.touch('touchStart', (x, y))
            browser.touch('touchMove', (x + 6, y - 48))
            browser.wait('return document.getElementById("stick").dataset.is === "held"')
            take(browser, os.path.join(folder, 'web_tablet.png'))
            browser.open(address + '=watch', (1920, 1080))
            wait_for(lambda: browser.run('return document.querySelector("[data-level=alarm]")'))
            take(browser, os.path.join(folder, 'web_wall.png'))
        finally:
            browser.driver.quit()
            server.terminate()
            server.wait()


def take(browser, path):
    """Take a picture once every robot and the map have been drawn for a while."""
    browser.wait('self.first ??= performance.now();'
                 'return performance.now() - first > 2500 && ![...document.querySelectorAll('
                 '".tile")].some(tile => tile.offsetParent && tile.querySelector("canvas").hidden)')
    browser.screenshot(path)


if __name__ == '__main__':
    main(sys.argv[1])
