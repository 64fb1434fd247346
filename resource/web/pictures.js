// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// From the bytes of a picture to a bitmap. Depth: near is yellow, far dark purple (viridis, as on the operator's screen),
// a pixel without depth a grey hatch.

const MIN_SPAN_M = 0.5, SMOOTH_MS = 1000;
const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
  [170, 220, 50], [253, 231, 37]];
// By brightness, far (0) to near (255), as the pixels of ImageData are in memory.
const COLOURS = new Uint32Array(256).map((_, value) => {
  const place = value / 255 * (VIRIDIS.length - 1), low = Math.min(VIRIDIS.length - 2, Math.floor(place));
  const [r, g, b] = VIRIDIS[low].map((from, i) => Math.round(from + (place - low) * (VIRIDIS[low + 1][i] - from)));
  return rgb(r, g, b);
});
const HATCH = [rgb(96, 96, 96), rgb(160, 160, 160)];
const ranges = new Map();

function rgb(r, g, b) {
  return (255 << 24 | b << 16 | g << 8 | r) >>> 0;
}

// Returns {bitmap, range}; range: [near, far] of a depth picture [m], else null. Rejects if the bytes are no picture.
export async function bitmapOf(topic, format, bytes) {
  if (format !== 'depth') return {bitmap: await createImageBitmap(new Blob([bytes])), range: null};
  return depthBitmap(topic, await grey16(bytes));
}

// The same of depths [mm, row by row; 0: none].
export async function depthBitmap(topic, {width, height, values}) {
  const range = follow(topic, values);
  return {bitmap: await createImageBitmap(coloured(width, height, values, range)), range};
}

// Reads a PNG of one channel of 16 bits, not interlaced: canvas would leave 8 of them.
export async function grey16(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), parts = [];
  if (view.getUint32(0) !== 0x89504e47) throw new Error('no PNG');
  const width = view.getUint32(16), height = view.getUint32(20);
  if (bytes[24] !== 16 || bytes[25] !== 0 || bytes[28] !== 0 || width * height > 1 << 24) throw new Error('no depth of 16 bits');
  for (let at = 8; at + 12 <= bytes.length;) {
    const length = view.getUint32(at), IDAT = 0x49444154;
    if (view.getUint32(at + 4) === IDAT) parts.push(bytes.subarray(at + 8, at + 8 + length));
    at += 12 + length;
  }
  const inflated = new Blob(parts).stream().pipeThrough(new DecompressionStream('deflate'));
  const rows = new Uint8Array(await new Response(inflated).arrayBuffer());
  const stride = 2 * width;
  if (rows.length !== (stride + 1) * height) throw new Error('a PNG of another size');
  for (let y = 0; y < height; y++) unfilter(rows, y * (stride + 1), stride, y > 0);
  const values = new Uint16Array(width * height);
  for (let y = 0, i = 0; y < height; y++) {
    for (let at = y * (stride + 1) + 1, end = at + stride; at < end; at += 2) values[i++] = rows[at] << 8 | rows[at + 1];
  }
  return {width, height, values};
}

// Undoes the filter of one row of a PNG in place (PNG specification, section 9); 2 bytes for each pixel.
function unfilter(rows, start, stride, above) {
  const filter = rows[start];
  for (let i = start + 1, end = i + stride; filter && i < end; i++) {
    const left = i > start + 2 ? rows[i - 2] : 0, up = above ? rows[i - stride - 1] : 0;
    if (filter === 1) rows[i] += left;
    else if (filter === 2) rows[i] += up;
    else if (filter === 3) rows[i] += left + up >> 1;
    else rows[i] += paeth(left, up, above && i > start + 2 ? rows[i - stride - 3] : 0);
  }
}

function paeth(left, up, corner) {
  const [a, b, c] = [Math.abs(up - corner), Math.abs(left - corner), Math.abs(left + up - 2 * corner)];
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

// Returns the range [m] of a stream after one more picture: 2nd to 98th percentile, smoothed over a second.
function follow(topic, values) {
  const some = [], step = Math.max(1, Math.floor(values.length / 20000)), now = performance.now();
  for (let i = 0; i < values.length; i += step) if (values[i]) some.push(values[i]);
  const before = ranges.get(topic);
  if (!some.length) return before?.range ?? null;
  some.sort((a, b) => a - b);
  let [near, far] = [0.02, 0.98].map(part => some[Math.floor(part * (some.length - 1))] / 1000);
  if (far - near < MIN_SPAN_M) {
    near = Math.max(0, (near + far - MIN_SPAN_M) / 2);
    far = near + MIN_SPAN_M;
  }
  if (before) {
    const weight = 1 - Math.exp((before.at - now) / SMOOTH_MS);
    [near, far] = [near, far].map((value, i) => before.range[i] + weight * (value - before.range[i]));
  }
  ranges.set(topic, {range: [near, far], at: now});
  return [near, far];
}

function coloured(width, height, values, range) {
  const pixels = new Uint32Array(width * height), [near, far] = range ?? [0, 1], scale = 255 / (far - near);
  for (let i = 0; i < values.length; i++) {
    const shade = scale * (far - values[i] / 1000);
    pixels[i] = values[i] ? COLOURS[Math.min(255, Math.max(0, Math.round(shade)))] : HATCH[(i % width + Math.floor(i / width)) % 8 < 4 ? 0 : 1];
  }
  return new ImageData(new Uint8ClampedArray(pixels.buffer), width, height);
}
