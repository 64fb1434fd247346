// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// The page in a headset (WebXR): the picture of the robot looked at on a large screen that stands
// still in the room, numbers at its left, the other robots at its right, the map below.
//
// Everything is sent and drawn from XRSession.requestAnimationFrame: no frame, no stick.
import {Painter, place} from './gl.js';
import {STALE_MS} from './store.js';

// How often stick and head are sent, and a head that rests is repeated; how often text is drawn [ms].
const SEND_MS = 50, REPEAT_MS = 100, TEXT_MS = 250;
// A head is sent when it has turned by this [rad].
const TURNED_RAD = 0.002;
// The buttons and axes of WebXR's mapping xr-standard.
const GRIP = 1, THUMB_X = 2, THUMB_Y = 3;
// From here on a turn narrows the view [rad/s]; how fast the vignette comes and goes [1/s].
const TURNS_RAD_S = 0.1, FADE_PER_S = 4;
// When a pause is suggested, for how long, and the words [ms].
const PAUSE_MS = 10 * 60 * 1000, HINT_MS = 60 * 1000;
const HINT = 'Ten minutes in the headset: take a short break';
const PICTURE = {distance: 2.2, wide: 3.0, high: 2.1};
// The brightness of a picture that is not live.
const PAST = 0.4;
const MAP_HIGH_M = 1.2;
const NUMBERS = place(0.88, 0, 2.2, 1.2, 1.58);
const SMALL = {distance: 2.2, wide: 0.8, high: 0.6, rows: 3};
const NOTE = place(0, -0.98, 2.2, 1.6, 0.16);
const TEXT = '#e8ecef', PALE = '#9aa4ab', LOUD = {attention: '#e69f00', alarm: '#d55e00'};

// From the socket to the end of the frame that shows it, of the last 500 pictures looked at [ms].
export const drawnAfter = [];

// Returns [pan, tilt] [rad], to the left and up, of an orientation {x, y, z, w}.
export function headAngles({x, y, z, w}) {
  return [Math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y)),
    Math.asin(Math.max(-1, Math.min(1, 2 * (w * x - y * z))))];
}

// Returns [left, right] of the pictures of a robot, {topic: picture}, or the picture of `topic` twice:
// two cameras are a pair if their topics differ in the word "left" and "right" alone.
export function eyesOf(pictures, topic) {
  const own = pictures[topic] ?? Object.values(pictures)[0];
  for (const [name, picture] of Object.entries(pictures)) {
    const other = name.replace(/left(?!.*left)/, 'right');
    if (other !== name && pictures[other] && (own === picture || own === pictures[other]))
      return [picture, pictures[other]];
  }
  return [own, own];
}

// Returns {topic: picture} of a robot.
const picturesOf = (store, robot) => Object.fromEntries(
  [...store.pictures].filter(([, picture]) => picture.robot === robot));

const number = (value, unit, digits = 2) => value == null ? '–' : value.toFixed(digits) + ' ' + unit;

// A canvas of text as a texture, drawn again when its lines change.
class Board {
  constructor(painter, wide, high, size) {
    this.texture = painter.texture();
    this.canvas = Object.assign(document.createElement('canvas'), {width: wide, height: high});
    this.#painter = painter;
    this.#size = size;
  }
  #painter;
  #size;
  #shown = null;

  // Shows lines [text, colour]; `image` is drawn above them, `key` changes when it does.
  show(lines, image = null, key = 0) {
    const shown = JSON.stringify([lines, key]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    const {canvas} = this, {width, height} = canvas, size = this.#size;
    const context = canvas.getContext('2d');
    context.fillStyle = '#12171b';
    context.fillRect(0, 0, width, height);
    let y = size * 0.4;
    if (image) {
      const room = height - lines.length * size * 1.25 - y;
      const share = Math.min(width / image.width, room / image.height);
      context.drawImage(image, (width - image.width * share) / 2, 0, image.width * share,
        image.height * share);
      y = room;
    }
    context.font = `${size}px sans-serif`;
    context.textBaseline = 'top';
    for (const [text, colour] of lines)
      for (const row of wrap(context, text, width - size)) {
        context.fillStyle = colour;
        context.fillText(row, size / 2, y);
        y += size * 1.25;
      }
    this.#painter.fill(this.texture, canvas);
  }
}

function wrap(context, text, wide) {
  const rows = [''];
  for (const word of text.split(' ')) {
    const longer = (rows[rows.length - 1] + ' ' + word).trim();
    if (context.measureText(longer).width <= wide) rows[rows.length - 1] = longer;
    else rows.push(word);
  }
  return rows;
}

// The stick and the head of a headset, as frames for the server; times are of the frames [ms].
export class Controls {
  constructor(send) {
    this.#send = send;
  }
  #send;
  // Whether the grip is held, and was seen open before: only then it counts.
  holds = false;
  #open = false;
  #had = false;
  #sentAt = -Infinity;
  #head = null;
  #headAt = -Infinity;

  // Reads the controllers of `sources` (XRInputSource); `may` says whether one that is held would be heard.
  read(sources, may, now) {
    const pads = [...sources ?? []].map(source => source.gamepad)
      .filter(pad => pad?.mapping === 'xr-standard');
    const held = pads.find(pad => pad.buttons[GRIP]?.pressed);
    if (!held || !may) {
      this.release();
      this.#open = !held && pads.length > 0;
      return;
    }
    if (!this.holds && !this.#open) return;
    if (!this.holds) this.#send({hold: true});
    this.holds = true;
    if (now - this.#sentAt < SEND_MS) return;
    this.#sentAt = now;
    this.#send({stick: [-(held.axes[THUMB_X] ?? 0), -(held.axes[THUMB_Y] ?? 0), 0]
      .map(value => Math.max(-1, Math.min(1, value)) || 0)});
  }

  // Handles whether the server says that this page has the stick: what was taken away stays away.
  answer(you) {
    if (this.#had && !you) this.release();
    this.#had = you && this.holds;
  }

  // Lets go; the grip has to be seen open before it counts again.
  release() {
    this.#open = this.#had = false;
    if (!this.holds) return;
    this.holds = false;
    this.#send({hold: false});
  }

  // Sends where the head looks.
  turn(angles, now) {
    const turned = !this.#head || angles.some((angle, i) =>
      Math.abs(angle - this.#head[i]) >= TURNED_RAD);
    if (now - this.#headAt < (turned ? SEND_MS : REPEAT_MS)) return;
    this.#headAt = now;
    this.#head = angles;
    this.#send({head: angles});
  }
}

// The headset of a page: its Store, its send(frame), and `page`: looked() is the name of the robot looked
// at or null, look(name) changes it, and `map` is the canvas with the map.
export class Headset {
  constructor(store, send, page) {
    [this.#store, this.#send, this.#page] = [store, send, page];
    // Some browsers call a page hidden while its headset is in use.
    document.addEventListener('visibilitychange', () => this.#session && this.#showVisible());
    store.subscribe('connection', ({up}) => up || this.#controls?.release());
    store.subscribe('drive', ({you}) => this.#controls?.answer(you));
  }
  #store;
  #send;
  #page;
  #session = null;
  #space = null;
  #painter = null;
  #controls = null;
  #boards = {};
  // {texture, picture} of each eye.
  #eyes = [];
  #began = 0;
  #last = 0;
  #dark = 0;
  #textAt = 0;

  // Starts the session; call it from a click. Throws what the browser says if it does not start.
  async start() {
    const session = await navigator.xr.requestSession('immersive-vr');
    try {
      const canvas = document.createElement('canvas');
      const gl = canvas.getContext('webgl2', {xrCompatible: true, alpha: false});
      if (!gl) throw new Error('this browser has no WebGL 2');
      await gl.makeXRCompatible();
      this.#painter = new Painter(gl);
      await session.updateRenderState({baseLayer: new XRWebGLLayer(session, gl)});
      this.#space = await session.requestReferenceSpace('local');
    } catch (error) {
      session.end();
      throw error;
    }
    const {texture} = this.#painter, make = texture.bind(this.#painter);
    this.#session = session;
    this.#controls = new Controls(this.#send);
    this.#eyes = [{texture: make()}, {texture: make()}];
    this.#boards = {numbers: new Board(this.#painter, 704, 928, 42), small: new Map(),
      map: make(), note: new Board(this.#painter, 1024, 102, 44)};
    this.#began = this.#last = this.#textAt = 0;
    session.addEventListener('visibilitychange', () => {
      if (session.visibilityState !== 'visible') this.#controls.release();
      this.#showVisible();
    });
    session.addEventListener('end', () => {
      this.#controls.release();
      this.#session = null;
      this.#showVisible();
    });
    this.#showVisible();
    session.addEventListener('select', () => this.#next());
    session.requestAnimationFrame((now, frame) => this.#first(now, frame));
  }

  // Tells whether anybody sees pictures. The page itself nobody sees: the headset needs the processor.
  #showVisible() {
    document.body.classList.toggle('worn', !!this.#session);
    this.#send({visible: this.#session ? this.#session.visibilityState !== 'hidden' : !document.hidden});
  }

  // Whether a grip would be heard.
  get #free() {
    const {hello, connection, drive} = this.#store;
    return hello.role === 'drive' && connection.up && drive.active && (!drive.holder || drive.you);
  }

  // Puts the screen in front of the eyes once it is known where they are.
  #first(now, frame) {
    const pose = frame.getViewerPose(this.#space);
    if (!pose) return frame.session.requestAnimationFrame((...more) => this.#first(...more));
    const {position: {x, y, z}, orientation} = pose.transform;
    const yaw = headAngles(orientation)[0] / 2;
    this.#space = this.#space.getOffsetReferenceSpace(new XRRigidTransform(
      {x, y, z}, {x: 0, y: Math.sin(yaw), z: 0, w: Math.cos(yaw)}));
    this.#began = this.#last = now;
    frame.session.requestAnimationFrame((...more) => this.#frame(...more));
  }

  #frame(now, frame) {
    const {session} = frame, store = this.#store;
    session.requestAnimationFrame((...more) => this.#frame(...more));
    const pose = frame.getViewerPose(this.#space);
    if (!pose || session.visibilityState !== 'visible') {
      this.#controls.release();
      return;
    }
    this.#controls.read(session.inputSources, this.#free, now);
    if (store.hello.head && this.#robot)
      this.#controls.turn(headAngles(pose.transform.orientation), now);
    const fresh = this.#load();
    if (now - this.#textAt >= TEXT_MS) {
      this.#textAt = now;
      this.#write(now);
    }
    this.#fade(now);
    this.#draw(session.renderState.baseLayer, pose);
    const done = performance.now();
    for (const picture of fresh)
      if (picture.received) drawnAfter.splice(0, drawnAfter.push(done - picture.received) - 500);
  }

  get #robots() {
    return this.#store.state?.robots ?? [];
  }

  get #robot() {
    return this.#store.robot(this.#page.looked());
  }

  // Looks at the next robot, unless the stick is held.
  #next() {
    const names = this.#robots.map(robot => robot.name);
    if (names.length && !this.#controls.holds)
      this.#page.look(names[(names.indexOf(this.#page.looked()) + 1) % names.length]);
  }

  // Stores new pictures in the textures of the eyes; returns those that were new.
  #load() {
    const robot = this.#robot, fresh = new Set();
    const found = robot ? eyesOf(picturesOf(this.#store, robot.name), robot.picture) : [];
    this.#eyes.forEach((eye, i) => {
      if (found[i] && found[i] !== eye.picture) {
        this.#painter.fill(eye.texture, found[i].bitmap);
        fresh.add(found[i]);
      }
      eye.picture = found[i];
    });
    return fresh;
  }

  // Draws what is written: numbers, captions with small pictures, the map and the hint.
  #write(now) {
    if (!this.#robot && this.#robots.length)
      this.#page.look((this.#robots.find(robot => robot.selected) ?? this.#robots[0]).name);
    const {state, drive, connection, stateAt} = this.#store, robot = this.#robot, boards = this.#boards;
    const lines = [];
    if (robot) {
      lines.push([`${robot.number} ${robot.name}`, robot.colour], [robot.state, LOUD[robot.level] ?? TEXT]);
      for (const text of [robot.reason, robot.remedy]) if (text) lines.push([text, PALE]);
      lines.push([number(robot.linear_mps, 'm/s'), TEXT], [number(robot.angular_rad_s, 'rad/s'), TEXT],
        ['Battery ' + (robot.battery == null ? '–' : Math.round(100 * robot.battery) + ' %'), TEXT],
        ['Picture ' + number(robot.picture_age_s, 's old', 1), PALE]);
      if (robot.task) lines.push([robot.task, TEXT]);
    }
    if (state) {
      lines.push([state.stop_all ? 'STOP ALL is in force' : state.driving, state.stop_all ? LOUD.alarm : TEXT]);
      for (const text of [state.mode, state.waits_for]) if (text) lines.push([text, PALE]);
      lines.push([`up to ${number(state.linear_mps, 'm/s')}, ${number(state.angular_rad_s, 'rad/s')}`, PALE]);
    }
    const age = now - stateAt;
    if (!connection.up) lines.push([connection.why, LOUD.alarm]);
    else if (age > STALE_MS) lines.push([`${number(age / 1000, 's old', 0)}`, LOUD.alarm]);
    if (this.#controls.holds)
      lines.push([drive?.you ? 'You have the stick' : drive?.why || 'Asking for the stick', TEXT]);
    boards.numbers.show(lines);
    for (const other of this.#robots) {
      if (!boards.small.has(other.name))
        boards.small.set(other.name, new Board(this.#painter, 320, 240, 24));
      const [picture] = eyesOf(picturesOf(this.#store, other.name), other.picture);
      boards.small.get(other.name).show(
        [[`${other.number} ${other.name}: ${other.state}`, LOUD[other.level] ?? TEXT]],
        picture?.bitmap, picture?.at);
    }
    if (this.#page.map.width && this.#page.map.height) this.#painter.fill(boards.map, this.#page.map);
    if (this.#hints(now)) boards.note.show([[HINT, LOUD.attention]]);
  }

  #hints(now) {
    return now - this.#began >= PAUSE_MS && (now - this.#began) % PAUSE_MS < HINT_MS;
  }

  // Narrows the view while the robot turns.
  #fade(now) {
    const turns = Math.abs(this.#robot?.angular_rad_s ?? 0) >= TURNS_RAD_S;
    const step = FADE_PER_S * (now - this.#last) / 1000;
    this.#last = now;
    this.#dark = Math.max(0, Math.min(1, this.#dark + (turns ? step : -step)));
  }

  #draw(layer, pose) {
    const painter = this.#painter, boards = this.#boards, robot = this.#robot, {map} = this.#page;
    painter.begin(layer.framebuffer);
    for (const view of pose.views) {
      const viewport = layer.getViewport(view);
      if (!viewport?.width) continue;
      painter.look(viewport, view.projectionMatrix, view.transform.inverse.matrix);
      painter.draw(boards.map, place(0, -1.5, 1.8, MAP_HIGH_M * map.width / map.height || 0, MAP_HIGH_M, 0.8));
      painter.draw(boards.numbers.texture, NUMBERS);
      this.#robots.filter(other => other !== robot).forEach((other, i) => {
        const small = boards.small.get(other.name), {rows, wide, high, distance} = SMALL;
        if (small) painter.draw(small.texture, place(-0.9 - 0.38 * Math.floor(i / rows),
          (1 - i % rows) * high * 1.1, distance, wide, high));
      });
      const eye = this.#eyes[view.eye === 'right' ? 1 : 0];
      if (eye.picture) {
        const {width, height} = eye.picture.bitmap;
        const share = Math.min(PICTURE.wide / width, PICTURE.high / height);
        painter.draw(eye.texture, place(0, 0, PICTURE.distance, width * share, height * share),
          this.#last - eye.picture.at > STALE_MS ? PAST : 1);
      }
      if (this.#hints(this.#last)) painter.draw(boards.note.texture, NOTE);
      if (this.#dark > 0) painter.vignette(0.85 * this.#dark);
    }
  }
}

// Puts the headset's button into an element; beside it, why the session did not start.
export function offer(store, send, element, page) {
  const headset = new Headset(store, send, page);
  const button = Object.assign(document.createElement('button'), {id: 'headset', textContent: 'Headset'});
  const note = document.createElement('span');
  button.addEventListener('click', () => headset.start().then(() => '', error => error.message)
    .then(words => { note.textContent = words; }));
  element.append(button, note);
}
