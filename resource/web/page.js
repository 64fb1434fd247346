// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// Watching, and driving where the operator allows it. Everything shown comes from the store; what fills it is a source:
// link.js, demo.js for `?demo`, recorded.js for `?session=FOLDER`. xr.js adds the headset where there is one.
import {MapView} from './map.js';
import {Stick} from './stick.js';
import {store} from './store.js';
import {Tile} from './tile.js';
import {age, clock, el, number, say, sign} from './words.js';

const MAP = '@map', SCREEN_SILENT_MS = 2000, STOP_WAITS_MS = 1500;
const at = id => document.getElementById(id);
const parameters = new URLSearchParams(location.search);
const name = parameters.has('demo') ? 'demo' : parameters.has('session') ? 'recorded' : 'link';
const send = (await import(`./${name}.js`)).open(store, parameters);

const cells = new Map(), large = new Tile(store, 'large', () => look(null)), map = new MapView(store, at('map'));
const stick = new Stick(store, send, at('pad'), () => showStick());
let looked = null, chosen = false, stopAsked = -Infinity, lostAt = clock(), dirty = false;
at('stage').append(large.element);

// What is large: a robot's name, MAP, or null for all robots alike.
function look(what) {
  [looked, chosen] = [what, true];
  send({look: what === MAP ? null : what});
  showState();
}

function showState() {
  const {state} = store, robots = state?.robots ?? [];
  // Who may drive needs the picture of the robot that a stick would move.
  if (!chosen && store.hello.role === 'drive') {
    const first = robots.find(robot => robot.selected)?.name ?? null;
    if (first !== looked) send({look: looked = first});
  }
  for (const [name, tile] of cells) {
    if (robots.some(robot => robot.name === name)) continue;
    tile.element.remove();
    cells.delete(name);
  }
  robots.forEach((robot, i) => {
    if (!cells.has(robot.name)) cells.set(robot.name, new Tile(store, 'cell', name => look(name === looked ? null : name)));
    const tile = cells.get(robot.name);
    if (at('cells').children[i] !== tile.element) at('cells').insertBefore(tile.element, at('cells').children[i] ?? null);
    tile.show(robot, robot.name === looked);
  });
  const robot = store.robot(looked);
  document.body.dataset.look = robot ? 'robot' : looked === MAP ? 'map' : 'all';
  const columns = robots.length < 2 ? 1 : robots.length < 5 ? 2 : robots.length < 10 ? 3 : 4;
  at('cells').style.setProperty('--columns', columns);
  at('cells').style.setProperty('--side', Math.min(3, columns));
  if (robot) large.show(robot, true);
  say(at('driving'), state?.driving ?? '');
  say(at('waits'), [state?.mode, state?.waits_for].filter(Boolean).map(words => `– ${words}`).join(' '));
  at('drives').classList.toggle('stopped', !!state?.stop_all);
  say(at('limits'), Number.isFinite(state?.linear_mps) ? ['up to', number(state.linear_mps, 'm/s'), number(state.angular_rad_s, 'rad/s')].filter(Boolean).join('  ') : '');
  say(at('worst'), state?.worst ?? '');
  showStick();
  repaint();
}

// Ages and what depends on them.
function tick() {
  const {connection, state, stateAt} = store, old = performance.now() - stateAt, silent = !(old < SCREEN_SILENT_MS);
  say(at('state-age'), Number.isFinite(old) ? `as of ${age(old)} ago` : '');
  document.body.classList.toggle('lost', !connection.up);
  at('lost').hidden = connection.up && !silent;
  say(at('lost'), connection.why === 'connecting' ? 'Connecting.' : !connection.up ? `Connection lost at ${lostAt}: ${connection.why}. Nothing here is live; trying again.`
    : Number.isFinite(old) ? `The operator's screen has sent nothing for ${age(old)}. Nothing here is live but pictures that say so.` : 'Waiting for the operator\'s screen.');
  for (const tile of [large, ...cells.values()]) if (tile.robot) tile.tick();
  showStop();
  repaint();
}

function repaint() {
  if (!dirty) requestAnimationFrame(paint);
  dirty = true;
}

function paint() {
  dirty = false;
  for (const tile of [large, ...cells.values()]) if (tile.robot) tile.paint();
}

function showEvent({time_s, severity, robot: about, text}) {
  const robot = store.robot(about), list = at('events').firstElementChild;
  list.prepend(el('li', severity, el('time', '', clock(time_s)), robot ? sign(robot) : el('span', 'sign none'), el('span', 'text', text)));
  while (list.children.length > 200) list.lastChild.remove();
}

function showStick() {
  const {hello, drive, state, connection} = store, robots = (state?.robots ?? []).filter(robot => robot.selected).map(robot => robot.name).join(', ');
  at('stick').hidden = hello.role !== 'drive';
  document.body.classList.toggle('drives', hello.role === 'drive');
  at('stick').dataset.is = stick.held ? 'held' : stick.free ? 'free' : 'off';
  const call = !robots ? 'The operator has selected no robot' : stick.held ? `Driving ${robots}` : `Hold to drive ${robots}`;
  say(at('stick').firstElementChild, !connection.up ? 'No connection' : !stick.free ? drive.why : `${drive.why} ${call}`.trim());
}

function showStop() {
  const waits = performance.now() - stopAsked, button = at('stop');
  button.hidden = !store.hello.may_stop;
  document.body.classList.toggle('stops', store.hello.may_stop);
  const fresh = store.connection.up && performance.now() - store.stateAt < SCREEN_SILENT_MS, stopped = fresh && store.state.stop_all;
  button.classList.toggle('done', stopped);
  say(button.firstElementChild, stopped ? 'STOP ALL IS ON' : waits < STOP_WAITS_MS ? 'STOPPING' : waits < 10000 ? 'NOT CONFIRMED: press again' : 'STOP ALL ROBOTS');
  say(button.lastElementChild, stopped ? 'Only the operator releases it' : 'A software stop, not an emergency stop');
}

function stop() {
  stopAsked = performance.now();
  send({stop: true});
  showStop();
}

store.subscribe('connection', ({up}) => {
  if (up) send({look: looked === MAP ? null : looked});
  else if (!at('lost').textContent.includes('lost at')) lostAt = clock();
  tick();
});
store.subscribe('state', () => { showState(); tick(); });
store.subscribe('picture', repaint);
store.subscribe('event', showEvent);
store.subscribe('events', () => at('events').firstElementChild.replaceChildren());
for (const kind of ['map', 'places']) store.subscribe(kind, () => map.draw());
for (const kind of ['hello', 'drive']) store.subscribe(kind, showStick);
at('map').onclick = () => look(looked === MAP ? null : MAP);
at('map').onkeydown = event => { if (event.key === 'Enter') look(looked === MAP ? null : MAP); };
at('stop').addEventListener('pointerdown', stop);
at('stop').addEventListener('click', event => { if (!event.detail) stop(); });
say(at('source'), {demo: 'DEMO', recorded: 'RECORDED', link: ''}[name]);
store.events.forEach(showEvent);
setInterval(() => { tick(); map.draw(); }, 250);
showState();
tick();
map.draw();

// The headset's button, where there is a headset.
if (await navigator.xr?.isSessionSupported('immersive-vr').catch(() => false)) {
  (await import('./xr.js')).offer(store, send, at('extra'), {looked: () => looked, look, map: at('map').firstElementChild});
}
