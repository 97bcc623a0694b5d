// Runs the script of a page that `ringdown picture` wrote, with a document of wood, and prints what it drew: as many
// faces as the surface has triangles, one title for each chosen mode. node run_view.js FILE.html
"use strict";
const fs = require("fs");
const html = fs.readFileSync(process.argv[2], "utf8");
const data = html.match(/id="view-data">([^<]*)</)[1];
const script = html.match(/<\/script>\s*<script>([\s\S]*?)<\/script>/)[1];
const modes = JSON.parse(data).modes || 0;

const handlers = {}, drawn = { faces: 0, colours: new Set() };
const listen = name => (type, handler) => { handlers[name + " " + type] = handler; };
const pen = { clearRect() {}, beginPath() {}, moveTo(x, y) { if (!isFinite(x + y)) throw Error("no place"); }, lineTo() {},
  closePath() {}, arc() {}, stroke() {}, fill() { ++drawn.faces; drawn.colours.add(this.fillStyle); } };
const canvas = { width: 900, height: 600, getContext: () => pen, addEventListener: listen("canvas"), setPointerCapture() {} };
const rows = Array.from({ length: modes }, (_, m) => ({ classList: { add() {}, remove() {} },
  cells: [0, 1, 2, 3].map(c => ({ textContent: m + "/" + c })), addEventListener: listen("row " + m) }));
const elements = { "view-data": { textContent: data }, view: { querySelector: () => canvas },
  "view-title": { textContent: "" }, move: { addEventListener: listen("move") } };
const frames = [];
const document = { getElementById: id => elements[id], querySelectorAll: () => rows, addEventListener: listen("document") };
const run = new Function("document", "requestAnimationFrame", "atob", script);
run(document, f => frames.push(f), text => Buffer.from(text, "base64").toString("binary"));
if (modes) {
  frames.shift()(400);
  console.log("faces", drawn.faces, "colours", drawn.colours.size > 3);
  handlers["row " + (modes - 1) + " click"]();
  handlers["canvas pointerdown"]({ clientX: 0, clientY: 0 });
  handlers["canvas pointermove"]({ clientX: 50, clientY: 20 });
  handlers["canvas wheel"]({ deltaY: 100, preventDefault() {} });
  handlers["document keydown"]({ key: "ArrowLeft", preventDefault() {} });
  frames.shift()(800);
  console.log("title", elements["view-title"].textContent);
}
