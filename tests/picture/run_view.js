// Runs the scripts of a page that `ringdown picture` wrote, with a document, a canvas and a loudspeaker of wood, and
// prints what they did: how many triangles were drawn, one title for each chosen mode, and which place a press struck.
// node run_view.js FILE.html
"use strict";
const page = require("./page.js").read(process.argv[2]);
const modes = JSON.parse(page.data).modes || 0;

const handlers = {}, drawn = { faces: 0, points: 0, place: null };
const listen = name => (type, handler) => { handlers[name + " " + type] = handler; };
const calls = {
  bufferData(kind, values) {
    if (values instanceof Float32Array) drawn.place = values;
    if (!values.every(isFinite)) throw Error("no place");
  },
  drawElements(kind, corners) { drawn.faces += corners / 3; },
  drawArrays(kind, first, count) { drawn.points += count; },
};
const gl = new Proxy({}, { get: (_, name) => calls[name] || (() => 0) });
const canvas = { width: 900, height: 600, getContext: () => gl, addEventListener: listen("canvas"), setPointerCapture() {},
  getBoundingClientRect: () => ({ left: 0, top: 0, width: 900, height: 600 }) };
const rows = Array.from({ length: modes }, (_, m) => ({ classList: { add() {}, remove() {} },
  cells: [0, 1, 2, 3].map(c => ({ textContent: m + "/" + c })), addEventListener: listen("row " + m) }));
const elements = { "view-data": { textContent: page.data }, view: { querySelector: () => canvas }, "view-title": {}, struck: {},
  soft: { value: 23 }, move: { checked: true, addEventListener: listen("move") },
  turn: { checked: false, addEventListener: listen("turn") } };
const frames = [], sounds = [];
class AudioContext {
  sampleRate = 44100;
  state = "running";
  createBuffer(channels, length) { const samples = new Float32Array(length); return { getChannelData: () => samples }; }
  createBufferSource() { return { connect() {}, start() { sounds.push(this.buffer.getChannelData(0)); } }; }
}
const document = { getElementById: id => elements[id], querySelectorAll: () => rows, addEventListener: listen("document") };
const run = new Function("document", "requestAnimationFrame", "atob", "AudioContext", page.sound + page.view);
run(document, f => frames.push(f), text => Buffer.from(text, "base64").toString("binary"), AudioContext);
if (modes) {
  frames.shift()(400);
  console.log("faces", drawn.faces, "points", drawn.points);
  handlers["row " + (modes - 1) + " click"]();
  handlers["canvas pointerdown"]({ clientX: 1, clientY: 1 });  // beside the object
  console.log("sounds", sounds.length);
  handlers["canvas pointermove"]({ clientX: 51, clientY: 21 });
  handlers["canvas pointerup"]({});
  handlers["canvas wheel"]({ deltaY: 100, preventDefault() {} });
  handlers["document keydown"]({ key: "ArrowLeft", preventDefault() {} });
  frames.shift()(800);
  const corner = drawn.place.reduce((top, v, n) => n % 4 === 2 && v > drawn.place[top] ? n : top, 2) - 2;  // nearest the eye
  handlers["canvas pointerdown"]({ clientX: drawn.place[corner] , clientY: drawn.place[corner + 1] });
  console.log("struck", elements.struck.textContent, "nearest", corner / 4);
  if (sounds.length) console.log("peak", sounds[0].reduce((peak, v) => Math.max(peak, Math.abs(v)), 0) > 0.01);
  console.log("title", elements["view-title"].textContent);
}
