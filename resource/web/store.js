// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// The newest of everything that the page shows, whoever sends it: link.js (mhri), demo.js, recorded.js. A source is a module
// with `open(store, parameters)`, which puts values here and returns `send(object)` for what the page asks of it (look, visible,
// hold, stick, stop, head). Kinds and fields are those of the socket: see doc/ros_api.md.

// A picture or a state older than this is not live, and must not look it [ms].
export const STALE_MS = 1000;

export class Store {
  hello = {role: 'watch', may_stop: false, head: false, label: ''};
  state = null;
  stateAt = -Infinity;    // when what the state says was so [ms of performance.now()]
  events = [];            // newest last
  map = null;             // as sent, with `image`: what drawImage() takes, row 0 on top
  places = null;
  placesAt = -Infinity;   // when they came
  drive = {active: false, holder: '', you: false, why: ''};
  connection = {up: false, why: 'connecting'};
  pictures = new Map();   // by topic; an ImageBitmap is closed when the next one comes: draw it, never keep it
  #readers = {};

  // Calls read(value) whenever a value of this kind was put: hello, state, event, map, places, drive, connection, picture.
  // Returns a function that ends it.
  subscribe(kind, read) {
    const readers = this.#readers[kind] ??= new Set();
    readers.add(read);
    return () => readers.delete(read);
  }

  put(kind, value) {
    const now = performance.now();
    if (kind === 'event') {
      this.events.push(value);
      this.events.splice(0, this.events.length - 200);
    } else if (kind === 'events') {
      this.events = [];
    } else if (kind === 'picture') {
      this.pictures.get(value.topic)?.bitmap.close();
      this.pictures.set(value.topic, value);
    } else {
      this[kind] = value;
      if (kind === 'state') this.stateAt = now - 1000 * (value?.age_s ?? Infinity);
      if (kind === 'places') this.placesAt = now;
    }
    for (const read of this.#readers[kind] ?? []) read(value);
  }

  // A picture: {robot, topic, n, at: when it was taken [ms of performance.now()], bitmap, range: [near, far] of depth [m] or null}
  // Returns the one that a robot's tile shows, or undefined.
  pictureOf(robot) {
    return this.pictures.get(robot?.picture);
  }

  robot(name) {
    return this.state?.robots.find(robot => robot.name === name);
  }
}

export const store = new Store();
