// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// A robot: its number, state, reason and remedy, and its picture with the age of it.
import {STALE_MS} from './store.js';
import {age, el, say, sign, speed} from './words.js';

// The share of a picture that may be cut off to fill its tile, as on the operator's screen.
const CROP = {large: 0.1, cell: 0.28};

export class Tile {
  #kind; #store; #sized = null; #shown = null; #sign = null;

  // kind: large or cell; tapped(name) is called when the robot is tapped.
  constructor(store, kind, tapped) {
    [this.#store, this.#kind] = [store, kind];
    for (const part of ['name', 'state', 'battery', 'heard', 'age', 'old', 'speed', 'reason', 'remedy']) this[part] = el('span', part);
    this.canvas = el('canvas');
    this.head = el('div', 'head', this.name, this.state, this.battery, this.heard);
    this.why = el('p', 'why', this.reason, ' ', this.remedy);
    this.element = el('article', `tile ${kind}`, this.head, el('div', 'picture', this.canvas, this.old, this.age, this.speed), this.why);
    this.element.tabIndex = 0;
    this.element.onclick = () => tapped(this.robot.name);
    this.element.onkeydown = event => { if (event.key === 'Enter') tapped(this.robot.name); };
    new ResizeObserver(([{contentRect}]) => { this.#sized = contentRect; this.#fit(); }).observe(this.canvas.parentElement);
  }

  show(robot, looked) {
    if (robot.number !== this.robot?.number || robot.colour !== this.robot?.colour) {
      this.#sign?.remove();
      this.head.prepend(this.#sign = sign(robot));
    }
    this.robot = robot;
    say(this.name, robot.name);
    say(this.state, robot.state);
    say(this.battery, Number.isFinite(robot.battery) ? `${Math.round(100 * robot.battery)} %` : '');
    this.battery.classList.toggle('low', robot.battery <= 0.3);
    say(this.speed, speed(robot));
    say(this.reason, robot.reason);
    say(this.remedy, robot.remedy);
    this.element.dataset.level = robot.level;
    this.element.dataset.name = robot.name;
    this.element.classList.toggle('selected', !!robot.selected);
    this.element.classList.toggle('looked', looked);
    this.tick();
  }

  // Says how old everything is: four times a second.
  tick() {
    const now = performance.now(), up = this.#store.connection.up, picture = this.#store.pictureOf(this.robot);
    const heard = Number.isFinite(this.robot.age_s) ? now - this.#store.stateAt + 1000 * this.robot.age_s : NaN;
    const fresh = up && heard < STALE_MS;
    say(this.heard, Number.isNaN(heard) ? '' : !fresh ? `${age(heard)} ago` : this.#kind === 'large' ? `live ${age(heard)}` : '');
    this.heard.classList.toggle('live', fresh);
    const old = picture ? now - picture.at : NaN, stale = !up || !(old < STALE_MS);
    say(this.old, !picture ? 'no picture' : stale ? `picture ${age(old)} old` : '');
    say(this.age, [picture?.range?.map(m => `${m.toFixed(1)} m`).join(' to '), picture && !stale ? age(old) : ''].filter(Boolean).join('   '));
    this.element.classList.toggle('stale', stale);
    this.canvas.hidden = !picture;
  }

  // Draws the newest picture, if it is another than the one drawn.
  paint() {
    const picture = this.#store.pictureOf(this.robot);
    if (!picture || picture === this.#shown || !this.element.offsetParent) return;
    this.#shown = picture;
    const {width, height} = picture.bitmap;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      Object.assign(this.canvas, {width, height});
      this.#fit();
    }
    this.canvas.getContext('2d').drawImage(picture.bitmap, 0, 0);
    if (this.element.classList.contains('stale')) this.tick();
  }

  #fit() {
    const {width, height} = this.#sized ?? {}, ratio = width * this.canvas.height / (height * this.canvas.width);
    if (this.#kind === 'large') document.body.style.setProperty('--aspect', this.canvas.width / this.canvas.height);
    this.canvas.classList.toggle('cover', Math.min(ratio, 1 / ratio) >= 1 - CROP[this.#kind]);
  }
}
