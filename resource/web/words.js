// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// Numbers as words, and elements. Whatever comes from elsewhere is text, never markup.

export function el(tag, className = '', ...children) {
  const element = document.createElement(tag);
  element.className = className;
  element.append(...children);
  return element;
}

// Changes the text only if it is another: what is the same is not laid out anew.
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function age(ms) {
  const s = Math.max(0, ms) / 1000;
  return !Number.isFinite(s) ? 'no time' : s < 10 ? `${s.toFixed(1)} s` : s < 120 ? `${s.toFixed(0)} s` : `${Math.floor(s / 60)} min`;
}

export function speed({linear_mps, angular_rad_s}) {
  const turn = angular_rad_s ?? NaN, side = turn > 0.005 ? 'left ' : turn < -0.005 ? 'right ' : '';
  return [number(linear_mps, 'm/s'), number(turn === null ? null : Math.abs(turn), 'rad/s', side)].filter(Boolean).join('   ');
}

export function number(value, unit, before = '') {
  return Number.isFinite(value) ? `${before}${value.toFixed(2)} ${unit}` : '';
}

export function clock(time_s = Date.now() / 1000) {
  return new Date(1000 * time_s).toLocaleTimeString('en-GB');
}

// Robots of one colour have different shapes: those of mhri.base.robot_colours.
export function shapeOf(number) {
  const place = Math.max(0, number - 1);
  return ['disc', 'square', 'pentagon'][(place + Math.floor(place / 12)) % 3];
}

export function sign(robot) {
  const element = el('span', `sign ${shapeOf(robot.number)}`, String(robot.number || '?'));
  element.style.backgroundColor = robot.colour;
  return element;
}
