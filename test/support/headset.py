# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A real browser without a window, with an emulated headset on it (iwer).

Pixels are read from WebGL. The drawing is done by the processor: a few frames a second.
"""
import math

from support.browser import Browser
from support.iwer import iwer_script
from support.paths import REPO
from support.ros_system import wait_for

LONG_S = 180.0
SIZE = (500, 400)
SWITCHES = ('--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
            '--ignore-certificate-errors')
# Before the scripts of each page: a headset; the context that draws in it, or nothing while it is
# blind, so that frames come nearly as fast as a real one's; what was sent, and when; jobs for the
# end of its next frame.
BEFORE = '''
const headset = globalThis.headset = new IWER.XRDevice(IWER.metaQuest3, {
  stereoEnabled: true, visibilityMaskEnabled: false});
headset.installRuntime({forceInstall: true});
Object.assign(headset, {blind: false, frames: 0, jobs: [], sent: []});
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function(kind, ...more) {
  const made = getContext.call(this, kind, ...more);
  if (kind === 'webgl2') {
    headset.gl = made;
    for (const name of ['drawArrays', 'texImage2D', 'clear']) {
      const draw = made[name].bind(made);
      made[name] = (...words) => headset.blind || draw(...words);
    }
  }
  return made;
};
const request = XRSession.prototype.requestAnimationFrame;
XRSession.prototype.requestAnimationFrame = function(call) {
  return request.call(this, (now, frame) => {
    call(now, frame);
    headset.frames += 1;
    for (const job of headset.jobs.splice(0)) job(headset.gl);
  });
};
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function(data) {
  headset.sent.push([(performance.timeOrigin + performance.now()) / 1000, JSON.parse(data)]);
  send.call(this, data);
};
'''
# Reads places as fractions of an eye's view, from the left and from above: [r, g, b] of each, of
# both eyes.
PIXELS = '''
return await new Promise(done => headset.jobs.push(gl => {
  const [width, height] = [gl.drawingBufferWidth / 2, gl.drawingBufferHeight], found = [];
  for (const eye of [0, 1]) for (const [x, y] of words[0]) {
    const pixel = new Uint8Array(4);
    gl.readPixels((eye + x) * width, (1 - y) * height, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    found.push([...pixel.slice(0, 3)]);
  }
  done(found);
}));
'''


class Headset:
    """The browser, and the headset on it.

    :param profile: folder of the browser's settings
    :raises OSError: the package iwer cannot be fetched
    """

    def __init__(self, profile):
        script = iwer_script(REPO / 'build' / '.ws' / 'tools')
        self._browser = Browser(profile, *SWITCHES)
        self._browser.driver.execute_cdp_cmd('Page.addScriptToEvaluateOnNewDocument', {
            'source': script + BEFORE})

    def run(self, script, *words):
        """Return what the body of an asynchronous function returns in the page; `words` is there.

        :raises AssertionError: it throws
        """
        done, value = self._browser.driver.execute_async_script(
            'const words = [...arguments], done = words.pop();'
            '(async () => {' + script + '})().then('
            'value => done([true, value]), error => done([false, String(error)]));', *words)
        assert done, value
        return value

    def until(self, script, *words, what='the page'):
        """Return the first true value of a script."""
        return wait_for(lambda: self.run(script, *words), LONG_S, what, poll_s=0.05)

    def wear(self, url, blind=False):
        """Open a page, press its button, and wait until the headset shows something.

        :param blind: draw nothing, as what it shows does not matter
        """
        self._browser.open(url, SIZE)
        self.until('return !!document.getElementById("headset")', what='the button')
        self.run('headset.blind = words[0]; document.getElementById("headset").click()', blind)
        self.until('return headset.frames > 2', what='the first frames')

    def turn(self, left, up=0.0):
        """Turn the head [rad]; return when that was, in seconds since 1970."""
        x, y = math.sin(up / 2), math.sin(left / 2)
        cx, cy = math.cos(up / 2), math.cos(left / 2)
        return self.run(
            'headset.quaternion.set(...words);'
            'return (performance.timeOrigin + performance.now()) / 1000;',
            cy * x, y * cx, -y * x, cy * cx)

    def hold(self, gripped, left=0.0, ahead=0.0):
        """Open or close the right hand's grip, and put its stick somewhere, each from -1 to 1."""
        self.run('const hand = headset.controllers.right;'
                 'hand.updateButtonValue("squeeze", words[0]);'
                 'hand.updateAxes("thumbstick", words[1], words[2])',
                 float(gripped), -left, -ahead)

    def show(self, state):
        """Set the session's visibility state, as a headset does that is taken off."""
        self.run('headset.updateVisibilityState(words[0])', state)

    def pixels(self, *places):
        """Return [r, g, b] at places (see PIXELS): of the left eye, then of the right one."""
        return self.run(PIXELS, places)

    def close(self):
        """End the browser."""
        self._browser.driver.quit()
