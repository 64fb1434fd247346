// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// The virtual stick: hold to drive. A press is neutral wherever it is on the pad; what counts is how far the finger went from
// there. Whatever takes finger or page away lets go; mhri does the same if nothing comes for 0.3 s.

const EVERY_MS = 50, DEAD = 0.08;

// Calls changed() when it is pressed or released.
export class Stick {
  held = false;
  #store; #send; #pad; #ring; #pointer; #from; #timer; #mine = false; #value = [0, 0, 0];

  constructor(store, send, pad, changed) {
    [this.#store, this.#send, this.#pad, this.changed] = [store, send, pad, changed];
    this.#ring = pad.firstElementChild;
    pad.addEventListener('pointerdown', event => this.#press(event));
    pad.addEventListener('pointermove', event => this.#move(event));
    const release = () => this.release();
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      pad.addEventListener(type, event => { if (event.pointerId === this.#pointer) release(); });
    }
    for (const type of ['blur', 'pagehide']) addEventListener(type, release);
    document.addEventListener('visibilitychange', release);
    pad.addEventListener('contextmenu', event => event.preventDefault());
    store.subscribe('connection', ({up}) => { if (!up) release(); });
    store.subscribe('drive', drive => {
      if (!drive.you && (!drive.active || drive.holder || drive.why || this.#mine)) release();
      this.#mine = this.held && drive.you;
    });
  }

  // Whether a press would be heard.
  get free() {
    const {hello, connection, drive} = this.#store;
    return hello.role === 'drive' && connection.up && drive.active && (!drive.holder || drive.you);
  }

  #press(event) {
    if (this.held || !this.free || event.button !== 0) return;
    event.preventDefault();
    this.#pad.setPointerCapture(event.pointerId);
    const box = this.#pad.getBoundingClientRect();
    [this.held, this.#pointer, this.#from, this.#value] = [true, event.pointerId, [event.clientX, event.clientY], [0, 0, 0]];
    this.#show(event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2, 0, 0);
    this.#send({hold: true});
    this.#frame();
    this.#timer = setInterval(() => this.#frame(), EVERY_MS);
    this.changed();
  }

  #move(event) {
    if (event.pointerId !== this.#pointer) return;
    const reach = this.#ring.clientWidth / 2;
    let [x, y] = [(event.clientX - this.#from[0]) / reach, (event.clientY - this.#from[1]) / reach];
    const length = Math.hypot(x, y), kept = length > 1 ? 1 / length : 1;
    [x, y] = [x * kept, y * kept];
    this.#show(null, null, x * reach, y * reach);
    this.#value = [-x, -y, 0].map(value => Math.abs(value) < DEAD ? 0 : Number(value.toFixed(3)));
  }

  #frame() {
    this.#send({stick: this.#value});
  }

  release() {
    if (!this.held) return;
    clearInterval(this.#timer);
    [this.held, this.#pointer, this.#mine] = [false, undefined, false];
    this.#send({hold: false});
    this.#show(0, 0, 0, 0);
    this.changed();
  }

  #show(left, top, x, y) {
    if (left !== null) this.#ring.style.translate = `${left}px ${top}px`;
    this.#ring.firstElementChild.style.translate = `${x}px ${y}px`;
  }
}
