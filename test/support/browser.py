# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A browser without a window, by its driver: Debian's chromium. Without it a test is skipped."""
import base64
import contextlib
import shutil

import numpy
import pytest

from mhri.base.opencv import cv2
from support.ros_system import wait_for

# How long a busy computer may take to load a page, or to run a script [s].
TIMEOUT_S = 120.0


class Browser:
    """One window; sizes are in pixels of the page.

    :param profile: folder of its settings
    :param arguments: more of its command line
    """

    def __init__(self, profile, *arguments):
        webdriver = pytest.importorskip('selenium.webdriver')
        service = pytest.importorskip('selenium.webdriver.chrome.service')
        driver = shutil.which('chromedriver')
        if driver is None:
            pytest.skip('there is no chromedriver')
        options = webdriver.ChromeOptions()
        for argument in ('--headless=new', '--no-sandbox', '--disable-dev-shm-usage',
                         '--hide-scrollbars', '--no-first-run', '--user-data-dir=' + profile,
                         *arguments):
            options.add_argument(argument)
        self.driver = webdriver.Chrome(options=options, service=service.Service(driver))
        self.driver.set_page_load_timeout(TIMEOUT_S)
        self.driver.set_script_timeout(TIMEOUT_S)

    def open(self, url, size=(1024, 768), touch=False):
        """Load a page in a window of a size."""
        self.resize(size, touch)
        self.driver.get(url)

    def resize(self, size, touch=False):
        """Make the window another size, or that of something that is touched."""
        self.driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': size[0], 'height': size[1], 'deviceScaleFactor': 1, 'mobile': touch})

    def run(self, script, *arguments):
        """Return what a script returns; ``arguments[0]`` and so on are its arguments."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, script, *arguments, what=None):
        """Return the first true value that a script returns."""
        return wait_for(lambda: self.run(script, *arguments), what=what or script, poll_s=0.05)

    def text(self, selector):
        """Return the text of the first element that fits, '' without one."""
        return self.run('return document.querySelector(arguments[0])?.innerText ?? ""', selector)

    def wait_text(self, selector, text):
        """Wait until an element that fits has a text in it."""
        wait_for(lambda: text in self.run(
            'return [...document.querySelectorAll(arguments[0])]'
            '.map(one => one.innerText).join("\\n")', selector),
            what='{} with {!r}'.format(selector, text), poll_s=0.05)

    def middle(self, selector):
        """Return the pixel (x, y) of the page in the middle of an element."""
        return self.run('const box = document.querySelector(arguments[0]).getBoundingClientRect();'
                        'return [box.x + box.width / 2, box.y + box.height / 2]', selector)

    def screenshot(self, path=None):
        """Return what is seen, as an array (h, w, 3) in RGB order; keep it in a file as well."""
        png = base64.b64decode(self.driver.get_screenshot_as_base64())
        if path:
            with open(path, 'wb') as file:
                file.write(png)
        return cv2.imdecode(numpy.frombuffer(png, numpy.uint8), cv2.IMREAD_COLOR)[..., ::-1]

    def colour(self, selector, right=0.5, down=0.4):
        """Return (r, g, b) of what is seen of an element at a part of its width and height."""
        left, top, width, height = self.run(
            'const box = document.querySelector(arguments[0]).getBoundingClientRect();'
            'return [box.x, box.y, box.width, box.height]', selector)
        pixel = self.screenshot()[int(top + down * height), int(left + right * width)]
        return [int(value) for value in pixel]

    def touch(self, kind, *points):
        """Touch the page: touchStart, touchMove, touchEnd, with the fingers that are there."""
        self.driver.execute_cdp_cmd('Input.dispatchTouchEvent', {
            'type': kind, 'touchPoints': [{'x': x, 'y': y} for x, y in points]})


@contextlib.contextmanager
def browser(system, *arguments):
    """Yield a browser of a system of tests (:class:`support.ros_system.System`)."""
    opened = Browser(system.home + '/browser', *arguments)
    try:
        yield opened
    finally:
        opened.driver.quit()
