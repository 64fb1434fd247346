// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// `?session=FOLDER`: a source that plays a recorded session; `?session=` alone lists them. Nothing here is live, nothing drives.
import {bitmapOf} from './pictures.js';
import {clock, el, say} from './words.js';

const SPEEDS = [1, 2, 4, 8], SILENT_S = 3, PICTURE_MS = 200, TICK_MS = 200, KEPT = 200;

export function open(store, parameters) {
  const folder = parameters.get('session');
  document.head.append(Object.assign(document.createElement('link'), {rel: 'stylesheet', href: 'recorded.css'}));
  store.put('hello', {role: 'watch', may_stop: false, head: false, label: 'recorded'});
  store.put('connection', {up: true, why: ''});
  let player = null, looked = null;
  begin(store, folder).then(made => { player = made; player?.look(looked); });
  return object => {
    if (!('look' in object)) return;
    looked = object.look;
    player?.look(looked);
  };
}

async function begin(store, folder) {
  const tell = words => store.put('state', {...nothing(), driving: words});
  const waits = setInterval(() => tell(folder ? `Reading the session ${folder} ...` : 'Recorded sessions'), TICK_MS);
  try {
    const answer = await fetch(folder ? `session/${encodeURIComponent(folder)}/timeline.json` : 'sessions.json');
    if (!answer.ok) throw new Error(answer.headers.get('Content-Type')?.startsWith('text/plain') ? await answer.text() : `there is no session ${folder}`);
    const found = await answer.json();
    if (!folder) return void list(found);
    clearInterval(waits);
    return new Player(store, folder, found);
  } catch (error) {
    clearInterval(waits);
    setInterval(() => tell(`This session cannot be shown: ${error.message}`), TICK_MS);
  }
}

function nothing() {
  return {age_s: 0, mode: '', waits_for: '', stop_all: false, linear_mps: null, angular_rad_s: null, worst: '', robots: []};
}

// Shows the sessions as links, the newest first.
function list(rows) {
  const links = rows.map(({name, title, figures, words, problem}) => {
    const link = el('a', '', el('b', '', title), ` ${figures}  ${words}`);
    if (!problem) link.href = `?session=${name}`;
    return link;
  });
  document.body.append(el('nav', 'sessions', el('p', '', 'Recorded sessions'), ...(links.length ? links : ['No session has been recorded yet.'])));
}

class Player {
  #store; #folder; #line; #at = 0; #since = performance.now(); #playing = true; #speed = 1; #shown = 0; #bar; #busy = new Set();
  #looked = null; #had = new Map(); #due = new Map();

  constructor(store, folder, line) {
    [this.#store, this.#folder, this.#line] = [store, folder, line];
    for (const robot of line.robots) {
      let before = [];
      robot.track = robot.track.map(row => before = row.length > 1 ? row : [row[0], ...before.slice(1)]);
    }
    this.#build();
    if (line.map) this.#fetchMap(line.map);
    setInterval(() => this.#tick(), TICK_MS);
    this.#seek(0);
  }

  look(robot) {
    this.#looked = robot;
  }

  #build() {
    const {length_s, stopped, driven, events} = this.#line, share = at_s => `${100 * at_s / Math.max(length_s, 0.1)}%`;
    const [play, speed, time] = [el('button', 'play'), el('button', 'rate', '1x'), el('output')];
    const place = Object.assign(el('input'), {type: 'range', min: 0, max: length_s, step: 0.1, value: 0}), strip = el('div', 'strip');
    const mark = (kind, from_s, to_s, text) => {
      const part = el('i', kind);
      part.style.left = share(from_s);
      if (to_s !== undefined) part.style.width = share(to_s - from_s);
      part.title = text;
      strip.append(part);
    };
    for (const [from_s, to_s, robot] of driven) mark('driven', from_s, to_s, `${robot} driven`);
    for (const [from_s, to_s] of stopped) mark('stopped', from_s, to_s, 'STOP ALL');
    for (const {at_s, severity, text} of events) if (severity !== 'calm') mark(severity, at_s, undefined, text);
    place.setAttribute('aria-label', 'place in the session');
    play.onclick = () => this.#play(!this.#playing);
    speed.onclick = () => {
      this.#seek(this.#now());
      this.#speed = SPEEDS[(SPEEDS.indexOf(this.#speed) + 1) % SPEEDS.length];
      say(speed, `${this.#speed}x`);
    };
    place.oninput = () => this.#seek(Number(place.value));
    document.body.append(el('nav', 'player', play, el('div', 'place', strip, place), time, speed));
    this.#bar = {play, place, time};
  }

  #now() {
    const passed_s = this.#playing ? this.#speed * (performance.now() - this.#since) / 1000 : 0;
    return Math.min(this.#line.length_s, this.#at + passed_s);
  }

  #seek(at_s) {
    [this.#at, this.#since] = [at_s, performance.now()];
    this.#tick();
  }

  #play(on) {
    const at_s = this.#now();
    this.#playing = on;
    this.#seek(on && at_s >= this.#line.length_s ? 0 : at_s);
  }

  #tick() {
    const now_s = this.#now(), {start, length_s, events} = this.#line, {play, place, time} = this.#bar;
    if (this.#playing && now_s >= length_s) [this.#playing, this.#at] = [false, length_s];
    say(play, this.#playing ? 'Pause' : 'Play');
    place.value = now_s;
    say(time, `${clock(start + now_s)}   ${minutes(now_s)} of ${minutes(length_s)}`);
    const past = events.findIndex(event => event.at_s > now_s), count = past < 0 ? events.length : past;
    if (count < this.#shown) {
      this.#store.put('events', []);
      this.#shown = 0;
    }
    for (const event of events.slice(Math.max(this.#shown, count - KEPT), count)) this.#store.put('event', event);
    this.#shown = count;
    this.#show(now_s);
    for (const robot of this.#line.robots) this.#fetchPicture(robot, now_s);
  }

  #show(now_s) {
    const within = ([from_s, to_s]) => from_s <= now_s && now_s < to_s, {driven, stopped, robots, problems} = this.#line;
    const selected = new Set(driven.filter(within).map(([, , robot]) => robot)), stop = stopped.some(within);
    const seen = robots.map(robot => ({robot, ...this.#reading(robot, now_s)})), heardAt = performance.now();
    for (const picture of this.#store.pictures.values()) picture.at = heardAt - 1000 * Math.max(0, now_s - picture.at_s);
    this.#store.put('state', {...nothing(), stop_all: stop, worst: problems[0] ?? '',
      driving: stop ? 'STOP ALL' : selected.size ? `Driving ${[...selected].join(', ')}` : 'nobody drives', robots: seen.map(({robot, row, age_s}) => {
        const lost = !(age_s <= SILENT_S), driven = selected.has(robot.name);
        return {name: robot.name, number: robot.number, colour: robot.colour, selected: driven, linear_mps: row?.[4] ?? null,
          angular_rad_s: row?.[5] ?? null, battery: null, age_s, picture: robot.picture, task: '',
          level: lost && driven ? 'alarm' : lost ? 'attention' : 'calm', state: lost ? 'silent' : stop ? 'stopped' : driven ? 'driven' : '',
          reason: lost && row ? `sent nothing for ${age_s.toFixed(0)} s` : lost ? 'nothing was recorded of it yet' : '', remedy: ''};
      })});
    this.#store.put('places', {frame: 'map', age_s: 0, marks: [], fence: [], robots: seen.filter(({row}) => typeof row?.[1] === 'number')
      .map(({robot, row, age_s}) => ({name: robot.name, x: row[1], y: row[2], yaw: row[3], age_s}))});
  }

  // The newest reading of a robot at a time, its place on the way to the next, and its age.
  #reading({track}, now_s) {
    let [low, high] = [0, track.length];
    while (low < high) {
      const middle = low + high >> 1;
      if (track[middle][0] <= now_s) low = middle + 1;
      else high = middle;
    }
    const row = track[low - 1], next = track[low];
    if (!row) return {row: null, age_s: null};
    if (!next || next[0] - row[0] > SILENT_S || row[1] === null || next[1] === null) return {row, age_s: now_s - row[0]};
    const part = (now_s - row[0]) / (next[0] - row[0]), turn = next[3] - row[3], between = i => row[i] + part * (next[i] - row[i]);
    return {row: [now_s, between(1), between(2), row[3] + part * Math.atan2(Math.sin(turn), Math.cos(turn)), row[4], row[5]], age_s: 0};
  }

  async #fetchPicture({name, picture}, now_s) {
    const due = this.#due.get(name) ?? 0, now = performance.now(), often = !this.#looked || this.#looked === name;
    if (!picture || document.hidden || this.#busy.has(name) || now < due) return;
    this.#busy.add(name);
    this.#due.set(name, now + (often ? PICTURE_MS : 3 * PICTURE_MS) - TICK_MS / 2);
    try {
      const answer = await fetch(`session/${this.#folder}/picture?${new URLSearchParams({robot: name, t: now_s.toFixed(2), had: this.#had.get(name) ?? -1})}`);
      if (answer.status === 200) {
        const at_s = Number(answer.headers.get('X-Time')), bytes = new Uint8Array(await answer.arrayBuffer());
        const drawn = await bitmapOf(picture, answer.headers.get('X-Kind'), bytes);
        this.#had.set(name, answer.headers.get('X-Time'));
        this.#store.put('picture', {...drawn, robot: name, topic: picture, n: 0, at_s, at: performance.now() - 1000 * Math.max(0, this.#now() - at_s)});
      }
    } catch (error) {
      console.warn(`${name}: ${error}`);
    }
    this.#busy.delete(name);
  }

  async #fetchMap(map) {
    const image = await createImageBitmap(await (await fetch(`session/${this.#folder}/map.png`)).blob());
    this.#store.put('map', {...map, image});
  }
}

function minutes(s) {
  return `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, '0')}`;
}
