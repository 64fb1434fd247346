// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// `?demo`, `?demo=watch` without a stick: a source without robots and without mhri. A building, four invented robots in it, and what they see.
import {depthBitmap} from './pictures.js';

const CELL_M = 0.25, FOV = 1.2, WIDTH = 400, HEIGHT = 300, EYE_M = 0.35, WALL_M = 1.6, MAX_MPS = 0.5, MAX_RAD_S = 1;
const PLAN = ['########################################', '#                  #                   #',
  '#                  #                   #', '#      oo          #             o     #',
  '#      oo                              #', '#                                      #',
  '#                  #                   #', '##########   ####################   ####',
  '#                                      #', '#                                      #',
  '#    o                       oo        #', '#                            oo        #',
  '#                                      #', '#########   ##########   ###############',
  '#                   #                  #', '#                   #           o      #',
  '#                   #                  #', '#   o               #                  #',
  '#                                      #', '#                                      #',
  '#                   #                  #', '########################################'];
const COLOURS = {'#': [206, 201, 190], o: [196, 62, 50]};

export function open(store, parameters) {
  const robots = [
    {name: 'bot1', colour: '#E9C428', x: 3, y: 4.3, yaw: 0, mps: 0.32, rad_s: 0, battery: 0.82, task: 'Patrol, 3 of 5'},
    {name: 'bot2', colour: '#A589C9', x: 4.9, y: 2.9, yaw: 3, mps: 0, rad_s: 0, battery: 0.91, selected: true, held: true},
    {name: 'bot3', colour: '#D5F6EF', x: 7, y: 0.9, yaw: 2.6, mps: 0.25, rad_s: 0.1, battery: 0.28, task: 'Search'},
    {name: 'bot4', colour: '#FCD1F0', x: 3.2, y: 0.8, yaw: 0.4, mps: 0, rad_s: 0, battery: 0.67, lostFrom: 12}];
  robots.forEach((robot, i) => Object.assign(robot, {number: i + 1, picture: `${robot.name}/camera`, drawn: 0, heardAt: 0}));
  const began = performance.now(), canvas = new OffscreenCanvas(WIDTH, HEIGHT), context = canvas.getContext('2d', {willReadFrequently: true});
  let looked = null, hold = false, stick = [0, 0, 0], stickAt = 0, stopped = -Infinity, number = 0, visible = true;

  const drives = parameters.get('demo') !== 'watch';
  const event = (severity, robot, text) => store.put('event', {time_s: Date.now() / 1000, kind: 'demo', severity, robot, text});
  const seconds = () => (performance.now() - began) / 1000;
  const stopAll = () => seconds() - stopped < 8;
  const lost = robot => robot.lostFrom !== undefined && seconds() > robot.lostFrom;

  function step(dt) {
    for (const robot of robots) {
      if (robot.held) {
        const [turn, ahead] = hold && performance.now() - stickAt < 300 ? stick : [0, 0];
        [robot.mps, robot.rad_s] = [ahead * MAX_MPS, turn * MAX_RAD_S];
      } else if (robot.task) {
        // The longest way ahead, and round to the left at the end of one.
        const free = side => Math.min(...[-0.25, 0, 0.25].map(more => ray(robot.x, robot.y, robot.yaw + side + more).distance));
        const [way] = [-1, -0.5, 0, 0.5, 1].map(side => [side, free(side) - Math.abs(side)]).sort((one, other) => other[1] - one[1])[0];
        robot.mps = Math.min(0.3, Math.max(0, free(0) - 0.4));
        robot.rad_s = free(0) < 0.5 ? 0.6 : 0.5 * way;
      }
      if (stopAll() || lost(robot)) robot.mps = robot.rad_s = 0;
      const ahead = Math.sign(robot.mps), way = robot.mps * dt;
      if (ray(robot.x, robot.y, robot.yaw + (ahead < 0 ? Math.PI : 0)).distance > 0.3) {
        robot.x += way * Math.cos(robot.yaw);
        robot.y += way * Math.sin(robot.yaw);
      }
      robot.yaw += robot.rad_s * dt;
      if (!lost(robot)) robot.heardAt = performance.now();
    }
  }

  function view(robot) {
    const age_s = (performance.now() - robot.heardAt) / 1000, low = robot.battery < 0.3;
    const gone = lost(robot) && age_s > 3;
    const driven = robot.held && hold;
    return {name: robot.name, number: robot.number, colour: robot.colour, selected: !!robot.selected, linear_mps: robot.mps,
      angular_rad_s: robot.rad_s, battery: robot.battery, age_s, picture: robot.picture, picture_age_s: age_s, task: robot.task ?? '',
      level: gone ? 'alarm' : low ? 'attention' : 'calm',
      state: gone ? 'gone' : stopAll() ? 'stopped' : driven ? 'driving' : robot.task ? 'on a task' : 'live',
      reason: gone ? `bot4 has sent nothing for ${age_s.toFixed(0)} s` : low ? 'battery 28 %' : driven || robot.task ? '' : 'nobody drives it',
      remedy: gone ? 'Go and look; check its power and its radio.' : low ? 'Bring it back and charge it.' : ''};
  }

  function state() {
    const you = hold && !stopAll();
    store.put('state', {age_s: 0, driving: 'Driving bot2', mode: drives ? 'Tablet' : 'Virtual joystick',
      waits_for: stopAll() ? 'all robots are stopped' : drives && !you ? 'hold the stick to drive' : '',
      stop_all: stopAll(), linear_mps: MAX_MPS, angular_rad_s: MAX_RAD_S, worst: lost(robots[3]) ? 'bot4 is lost' : '', robots: robots.map(view)});
    store.put('places', {frame: 'map', age_s: 0, robots: robots.map(({name, x, y, yaw, heardAt}) => ({name, x, y, yaw, age_s: (performance.now() - heardAt) / 1000})),
      marks: [{name: 'Valve 3', x: 7.6, y: 4.2}, {name: 'Stairs', x: 1.2, y: 3}], fence: [[0.5, 0.4], [9.6, 0.4], [9.6, 5.1], [0.5, 5.1]]});
    const drive = {active: true, holder: you ? 'you' : '', you, why: stopAll() ? 'All robots are stopped.' : ''};
    if (JSON.stringify(drive) !== JSON.stringify(store.drive)) store.put('drive', drive);
  }

  async function picture(robot) {
    const values = draw(robot, robots, context), put = {robot: robot.name, topic: robot.picture, n: ++number, at: performance.now()};
    if (robot.name === 'bot3') store.put('picture', {...put, ...await depthBitmap(robot.picture, {width: WIDTH, height: HEIGHT, values})});
    else store.put('picture', {...put, bitmap: canvas.transferToImageBitmap(), range: null});
  }

  setInterval(() => {
    step(0.05);
    const now = performance.now();
    for (const robot of visible ? robots : []) {
      if (lost(robot) || now - robot.drawn < (robot.name === looked ? 60 : 190)) continue;
      robot.drawn = now;
      picture(robot);
    }
  }, 50);
  setInterval(state, 200);
  setTimeout(() => event('alarm', 'bot4', 'bot4 has sent nothing for 3 s'), 15000);
  store.put('hello', {role: drives ? 'drive' : 'watch', may_stop: drives, head: drives, label: 'Demo'});
  store.put('connection', {up: true, why: ''});
  event('calm', '', 'The demo begins: nothing here is a robot');
  event('calm', 'bot1', 'bot1 patrols');
  event('attention', 'bot3', 'bot3: battery 28 %');
  state();
  createImageBitmap(plan()).then(image => store.put('map', {version: 1, width: image.width, height: image.height, resolution_m: CELL_M, x: 0, y: 0, yaw: 0, image}));

  return object => {
    if ('look' in object) looked = object.look;
    if ('visible' in object) visible = object.visible;
    if ('stick' in object) [stick, stickAt] = [object.stick, performance.now()];
    if ('hold' in object && object.hold !== hold) {
      hold = object.hold;
      event('calm', 'bot2', hold ? 'The tablet drives bot2' : 'The tablet has let go of bot2');
    }
    if ('stop' in object) {
      stopped = seconds();
      event('attention', '', 'Every robot was stopped from a tablet');
    }
    state();
  };
}

// Returns what stands at a place [m], ' ' for nothing.
function at(x, y) {
  return PLAN[PLAN.length - 1 - Math.floor(y / CELL_M)]?.[Math.floor(x / CELL_M)] ?? '#';
}

// Returns what a ray meets: {distance [m], what, shade, along: where on the wall [m]}. Cell by cell (Amanatides and Woo 1987).
function ray(x, y, yaw) {
  const dx = Math.cos(yaw), dy = Math.sin(yaw);
  let distance = 0, side = 0;
  for (let i = 0; i < 100; i++) {
    const [px, py] = [x + dx * (distance + 1e-6), y + dy * (distance + 1e-6)], what = at(px, py);
    if (what !== ' ') return {distance, what, shade: side ? 0.78 : 1, along: side ? px : py};
    const tx = ((Math.floor(px / CELL_M) + (dx > 0 ? 1 : 0)) * CELL_M - px) / dx, ty = ((Math.floor(py / CELL_M) + (dy > 0 ? 1 : 0)) * CELL_M - py) / dy;
    side = ty < tx ? 1 : 0;
    distance += Math.max(1e-6, Math.min(tx, ty));
  }
  return {distance, what: '#', shade: 1, along: 0};
}

// Draws what a robot sees and returns its depth [mm].
function draw(robot, robots, context) {
  const focal = WIDTH / 2 / Math.tan(FOV / 2), values = new Uint16Array(WIDTH * HEIGHT), horizon = HEIGHT * 0.45;
  const image = context.createImageData(WIDTH, HEIGHT), pixels = new Uint32Array(image.data.buffer);
  for (let column = 0; column < WIDTH; column++) {
    const angle = Math.atan((WIDTH / 2 - column) / focal), hit = ray(robot.x, robot.y, robot.yaw + angle);
    let depth = Math.max(0.1, hit.distance * Math.cos(angle)), colour = COLOURS[hit.what], shade = hit.shade, top = WALL_M;
    if (hit.what === '#' && hit.along % 0.5 < 0.02) shade *= 0.85;
    for (const other of robots) {
      const dx = other.x - robot.x, dy = other.y - robot.y, ahead = dx * Math.cos(robot.yaw) + dy * Math.sin(robot.yaw);
      const beside = dy * Math.cos(robot.yaw) - dx * Math.sin(robot.yaw) - ahead * Math.tan(angle);
      if (other !== robot && ahead > 0.2 && ahead < depth && Math.abs(beside) < 0.18) {
        [depth, colour, top] = [ahead, other.colour.match(/\w\w/g).map(part => parseInt(part, 16)), 0.42];
        shade = 1 - 12 * beside * beside;
      }
    }
    const from = horizon - (top - EYE_M) / depth * focal, to = horizon + EYE_M / depth * focal;
    for (let row = 0; row < HEIGHT; row++) {
      const i = row * WIDTH + column, wall = row >= from && row < to;
      const far = wall ? depth : row >= to ? EYE_M * focal / (row - horizon) : Math.max(depth, 3);
      let [r, g, b] = colour, light = shade * Math.max(0.35, 1 - far / 9);
      if (!wall && row >= to) {
        const reach = far / Math.cos(angle), x = robot.x + reach * Math.cos(robot.yaw + angle), y = robot.y + reach * Math.sin(robot.yaw + angle);
        [r, g, b] = Math.floor(2 * x) + Math.floor(2 * y) & 1 ? [128, 120, 108] : [112, 104, 94];
        light = Math.max(0.4, 1 - far / 8);
      } else if (!wall) {
        [r, g, b, light] = [70, 76, 84, 1];
      } else if (top === WALL_M && Math.abs((row - from) / (to - from) - 0.45) < 0.03 && colour === COLOURS['#']) {
        [r, g, b] = [64, 112, 138];
      }
      pixels[i] = 255 << 24 | b * light << 16 | g * light << 8 | r * light;
      values[i] = !wall && row < to ? 0 : Math.min(65535, far * 1000);
    }
  }
  context.putImageData(image, 0, 0);
  return values;
}

// Returns the building as the map of mhri has it: free, occupied.
function plan() {
  const image = new ImageData(PLAN[0].length, PLAN.length);
  PLAN.join('').split('').forEach((cell, i) => image.data.fill(cell === ' ' ? 254 : 0, 4 * i, 4 * i + 4).fill(255, 4 * i + 3, 4 * i + 4));
  return image;
}
