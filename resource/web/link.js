// SPDX-FileCopyrightText: 2026 The mhri authors
// SPDX-License-Identifier: BSD-3-Clause
// The socket to mhri: JSON both ways, pictures as binary frames. It is opened again for as long as the page is there.
import {bitmapOf} from './pictures.js';

const SILENT_MS = 2500, AGAIN_MS = [300, 1000, 2000];

export function open(store) {
  let socket, tries = 0, bye = '', heard = 0;

  function send(object) {
    // What waits in here is old when it leaves: the stick has no use for it.
    if (socket?.readyState !== WebSocket.OPEN || ('stick' in object && socket.bufferedAmount > 4096)) return;
    socket.send(JSON.stringify(object));
  }

  function connect() {
    heard = performance.now();
    const mine = socket = new WebSocket(`${location.protocol.replace('http', 'ws')}//${location.host}/ws`);
    mine.binaryType = 'arraybuffer';
    mine.onopen = () => {
      [tries, bye, heard] = [0, '', performance.now()];
      store.put('events', []);
      store.put('connection', {up: true, why: ''});
      send({visible: !document.hidden});
    };
    mine.onmessage = ({data}) => {
      if (socket !== mine) return;
      heard = performance.now();
      if (!store.connection.up) store.put('connection', {up: true, why: ''});
      if (typeof data === 'string') receive(JSON.parse(data));
      else picture(data);
    };
    mine.onclose = () => { if (socket === mine) lost(); };
  }

  function receive(message) {
    for (const [kind, value] of Object.entries(message)) {
      if (kind === 'bye') bye = value;
      else if (kind === 'map') fetchMap(value);
      else if (['hello', 'state', 'event', 'places', 'drive'].includes(kind)) store.put(kind, value);
    }
  }

  async function picture(frame) {
    const length = new DataView(frame).getUint32(0);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(frame, 4, length)));
    const received = performance.now(), at = received - 1000 * (header.age_s ?? Infinity);
    try {
      const drawn = await bitmapOf(header.topic, header.format, new Uint8Array(frame, 4 + length));
      const shown = store.pictures.get(header.topic);
      if (shown?.at > at) drawn.bitmap.close();
      else store.put('picture', {...header, ...drawn, at, received});
    } catch (error) {
      console.warn(`${header.topic}: ${error}`);
    }
    send({ack: header.n});
  }

  async function fetchMap(map) {
    if (!map) return store.put('map', null);
    try {
      const image = await createImageBitmap(await (await fetch(`map.png?v=${map.version}`)).blob());
      store.put('map', {...map, image});
    } catch (error) {
      console.warn(`map: ${error}`);
    }
  }

  async function lost() {
    store.put('drive', {active: false, holder: '', you: false, why: 'no connection to mhri'});
    store.put('connection', {up: false, why: bye || 'no connection to mhri'});
    // A refused socket does not say why; a page does.
    const status = await fetch('.', {cache: 'no-store'}).then(answer => answer.status, () => 0);
    if (status === 403) store.put('connection', {up: false, why: 'this link is not valid any more: ask the operator for a new one'});
    setTimeout(connect, AGAIN_MS[Math.min(tries++, AGAIN_MS.length - 1)]);
  }

  setInterval(() => {
    if (store.connection.up && performance.now() - heard > SILENT_MS) {
      socket.onclose = null;
      socket.close();
      lost();
    }
  }, 250);
  document.addEventListener('visibilitychange', () => send({visible: !document.hidden}));
  connect();
  return send;
}
