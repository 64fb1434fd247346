// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// The map: the building, the fence, marks with their names, and the robots, pale where their place is old.
import {age, say, shapeOf} from './words.js';

const OLD_MS = 5000, DRIVE = '#56b4e9', TEXT = '#eceef0', MUTED = '#9aa3ad', FREE = [20, 23, 27], OCCUPIED = [206, 211, 216], UNKNOWN = [53, 59, 67];

export class MapView {
  #store; #canvas; #note; #image = null;

  constructor(store, section) {
    [this.#store, this.#canvas, this.#note] = [store, section.querySelector('canvas'), section.querySelector('.note')];
    store.subscribe('map', map => { this.#image = map && inColour(map.image); });
    new ResizeObserver(() => this.draw()).observe(section);
  }

  draw() {
    const {places, placesAt, map} = this.#store, canvas = this.#canvas, context = canvas.getContext('2d');
    // Signs are as large as text is: what follows counts in pixels of text of 15 px.
    const unit = parseFloat(getComputedStyle(canvas).fontSize) / 15, scale = devicePixelRatio * unit;
    const width = canvas.clientWidth / unit, height = canvas.clientHeight / unit;
    if (!width || !height) return;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      [canvas.width, canvas.height] = [Math.round(width * scale), Math.round(height * scale)];
    }
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    const old = performance.now() - placesAt;
    say(this.#note, !map && !places ? 'no map' : !this.#store.connection.up || old > OLD_MS ? `map as it was ${age(old)} ago` : '');
    const [at, pixels] = this.#fit(map, places, width, height);
    if (!at) return;
    if (map && this.#image) this.#building(context, map, at, pixels);
    scaleBar(context, pixels, height);
    this.#fence(context, places?.fence ?? [], at);
    for (const mark of places?.marks ?? []) drawMark(context, mark, at(mark.x, mark.y));
    for (const robot of places?.robots ?? []) this.#robot(context, robot, at(robot.x, robot.y), width < 400);
  }

  // Returns [a function from metres to pixels, pixels of a metre]: everything is in view.
  #fit(map, places, width, height) {
    const points = [...places?.robots ?? [], ...places?.marks ?? [], ...(places?.fence ?? []).map(([x, y]) => ({x, y})), ...map ? corners(map) : []]
      .filter(({x, y}) => Number.isFinite(x) && Number.isFinite(y));
    if (!points.length) return [null, 0];
    const xs = points.map(({x}) => x), ys = points.map(({y}) => y), edge = map ? 14 : 40;
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const pixels = Math.min((width - 2 * edge) / Math.max(2, right - left), (height - 2 * edge) / Math.max(2, high - low));
    return [(x, y) => [width / 2 + (x - (left + right) / 2) * pixels, height / 2 - (y - (low + high) / 2) * pixels], pixels];
  }

  #building(context, map, at, pixels) {
    context.save();
    context.translate(...at(map.x, map.y));
    context.rotate(-map.yaw);
    context.scale(map.resolution_m * pixels, map.resolution_m * pixels);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#image, 0, -map.height);
    context.restore();
  }

  #fence(context, fence, at) {
    if (!fence.length) return;
    context.beginPath();
    fence.forEach(([x, y]) => context.lineTo(...at(x, y)));
    context.closePath();
    stroke(context, MUTED, 1.5, [6, 5]);
  }

  #robot(context, {name, yaw, age_s}, [x, y], small) {
    const robot = this.#store.robot(name) ?? {number: 0, colour: MUTED};
    const old = performance.now() - this.#store.stateAt + 1000 * Math.max(age_s ?? 0, robot.age_s ?? 0);
    const lost = !this.#store.connection.up || old > OLD_MS;
    context.globalAlpha = lost ? 0.45 : 1;
    if (Number.isFinite(yaw)) {
      context.beginPath();
      for (const [turn, away] of [[0, 21], [0.55, 12], [-0.55, 12]]) context.lineTo(x + away * Math.cos(yaw + turn), y - away * Math.sin(yaw + turn));
      context.fillStyle = robot.colour;
      context.fill();
    }
    outline(context, shapeOf(robot.number), x, y, 11);
    context.fillStyle = robot.colour;
    context.fill();
    stroke(context, robot.selected ? DRIVE : '#0c0e12', robot.selected ? 3 : 1.5, lost ? [3, 3] : []);
    label(context, String(robot.number || '?'), x, y, '#14171a', '700 13px "DejaVu Sans", system-ui, sans-serif');
    context.globalAlpha = 1;
    const words = [small ? '' : name, lost ? `${age(old)} ago` : ''].filter(Boolean).join(', ');
    if (words) label(context, words, x, y + 21, lost ? MUTED : TEXT);
  }
}

function corners({x, y, yaw, width, height, resolution_m}) {
  return [[0, 0], [width, 0], [0, height], [width, height]].map(([i, j]) => ({
    x: x + resolution_m * (i * Math.cos(yaw) - j * Math.sin(yaw)), y: y + resolution_m * (i * Math.sin(yaw) + j * Math.cos(yaw))}));
}

// Returns the map in the colours of the page.
function inColour(image) {
  const canvas = new OffscreenCanvas(image.width, image.height), context = canvas.getContext('2d', {willReadFrequently: true});
  context.drawImage(image, 0, 0);
  const pixels = context.getImageData(0, 0, image.width, image.height);
  for (let i = 0; i < pixels.data.length; i += 4) {
    const grey = pixels.data[i];
    pixels.data.set(grey === 205 ? UNKNOWN : OCCUPIED.map((value, n) => value + grey / 254 * (FREE[n] - value)), i);
  }
  context.putImageData(pixels, 0, 0);
  return canvas;
}

function outline(context, shape, x, y, size) {
  context.beginPath();
  if (shape === 'disc') context.arc(x, y, size, 0, 2 * Math.PI);
  else if (shape === 'square') context.rect(x - size + 1, y - size + 1, 2 * size - 2, 2 * size - 2);
  else for (let i = 0; i < 5; i++) context.lineTo(x + 1.15 * size * Math.sin(0.4 * Math.PI * i), y - 1.15 * size * Math.cos(0.4 * Math.PI * i));
  context.closePath();
}

function stroke(context, colour, width, dash = []) {
  context.setLineDash(dash);
  [context.strokeStyle, context.lineWidth] = [colour, width];
  context.stroke();
  context.setLineDash([]);
}

function label(context, text, x, y, colour, font = '13px "DejaVu Sans", system-ui, sans-serif') {
  Object.assign(context, {font, textAlign: 'center', textBaseline: 'middle', lineJoin: 'round', lineWidth: 3, strokeStyle: '#0c0e12', fillStyle: colour});
  if (colour !== '#14171a') context.strokeText(text, x, y);
  context.fillText(text, x, y);
}

function drawMark(context, {name}, [x, y]) {
  context.beginPath();
  for (const [dx, dy] of [[0, -7], [6, 0], [0, 7], [-6, 0]]) context.lineTo(x + dx, y + dy);
  context.closePath();
  context.fillStyle = '#0c0e12';
  context.fill();
  stroke(context, TEXT, 2);
  label(context, name, x, y + 17, TEXT);
}

function scaleBar(context, pixels, height) {
  const metres = [0.5, 1, 2, 5, 10, 20, 50, 100, 200].find(length => length * pixels > 50) ?? 500;
  context.beginPath();
  for (const [x, y] of [[10, -13], [10, -8], [10 + metres * pixels, -8], [10 + metres * pixels, -13]]) context.lineTo(x, height + y);
  stroke(context, MUTED, 1.5);
  label(context, `${metres} m`, 10 + metres * pixels / 2, height - 20, MUTED);
}
