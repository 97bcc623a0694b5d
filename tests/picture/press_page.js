// Opens a page that `ringdown picture` wrote in Chromium without a window, presses the object with a mouse and touches
// it with a finger, and prints what both did: node press_page.js FILE.html RINGDOWN BANK CHROMIUM [PICTURE.png]
"use strict";
const fs = require("fs"), os = require("os"), path = require("path"), { spawn } = require("child_process");
const page = require("./page.js");
const [file, program, bank, chromium, picture] = process.argv.slice(2);

// Chromium's DevTools protocol over two pipes: JSON texts that end with a zero.
function browse(browser) {
  let number = 0, rest = "", session;
  const waiting = new Map();
  browser.stdio[4].on("data", bytes => {
    const texts = (rest + bytes).split("\0");
    rest = texts.pop();
    for (const text of texts) {
      const { id, result, error } = JSON.parse(text);
      if (waiting.has(id)) waiting.get(id)(error ? Promise.reject(Error(error.message)) : result);
      waiting.delete(id);
    }
  });
  const call = (method, params = {}) => new Promise(resolve => {
    waiting.set(++number, resolve);
    browser.stdio[3].write(JSON.stringify({ id: number, method, params, sessionId: session }) + "\0");
  });
  return { call, attach: id => { session = id; } };
}

async function main(call, attach) {
  const { targetId } = await call("Target.createTarget", { url: "about:blank" });
  attach((await call("Target.attachToTarget", { targetId, flatten: true })).sessionId);
  const ask = async expression => {
    const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw Error(expression + ": " + exceptionDetails.exception.description);
    return result.value;
  };
  await call("Emulation.setTouchEmulationEnabled", { enabled: true });
  await call("Page.navigate", { url: "file://" + path.resolve(file) });
  await ask(`new Promise(done => { const wait = () => document.readyState === "complete" && document.getElementById("view") ?
    requestAnimationFrame(() => requestAnimationFrame(done)) : setTimeout(wait, 20); wait(); })`);
  // The second press is where the first was, and hits another place because the object has turned by a quarter.
  const at = await ask(`(() => { document.getElementById("turn").checked = false;
    const box = document.querySelector("canvas").getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2, width: box.width }; })()`);
  const presses = {  // the touch first, which must let the page sound by itself
    touch: async (x, y) => {
      await call("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [{ x, y }] });
      await call("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    },
    mouse: async (x, y) => {
      for (const type of ["mousePressed", "mouseReleased"])
        await call("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: 1, clickCount: 1 });
    },
  };
  for (const [how, press] of Object.entries(presses)) {
    await ask("ringdown.last = null");
    for (const share of [0, 0.05, -0.05, 0.1, -0.1, 0.15, -0.15, 0.2, -0.2]) {  // a bell's mouth may be in the middle
      await press(at.x + share * at.width, at.y - Math.abs(share) * at.width / 2);
      if (await ask("ringdown.last !== null")) break;
    }
    const last = await ask(`ringdown.last && ({ vertex: ringdown.places[ringdown.last.place], blow: ringdown.last.blow,
      contact_s: ringdown.last.contact_s, eye: ringdown.last.eye,
      origin_m: ringdown.radiation ? ringdown.radiation.origin_m : ringdown.data.middle_m, rate: ringdown.last.buffer.sampleRate,
      samples: Array.from(ringdown.last.buffer.getChannelData(0)) })`);
    if (!last) throw Error(how + ": nothing sounds where the object was pressed");
    console.log(how, "audio", await ask(`new Promise(done => { const { audio } = ringdown.last;
      const tell = () => done(audio.state);
      if (audio.state === "running") tell(); else { audio.onstatechange = tell; setTimeout(tell, 10000); } })`));
    const seconds = Math.min(1, Math.floor(10 * (last.samples.length / last.rate - 0.06)) / 10);
    const error = page.error(program, bank, last, seconds);
    console.log(how, "error", error.toFixed(1), "dB at point", last.vertex);
    await call("Input.dispatchMouseEvent", { type: "mousePressed", x: at.x, y: at.y, button: "left", buttons: 1 });
    await call("Input.dispatchMouseEvent", { type: "mouseMoved", x: at.x + 235, y: at.y, button: "left", buttons: 1 });
    await call("Input.dispatchMouseEvent", { type: "mouseReleased", x: at.x + 235, y: at.y, button: "left" });
  }
  const shot = Buffer.from((await call("Page.captureScreenshot")).data, "base64");
  if (picture) fs.writeFileSync(picture, shot);
}

const home = fs.mkdtempSync(path.join(os.tmpdir(), "chromium-"));
process.on("exit", () => fs.rmSync(home, { recursive: true, force: true, maxRetries: 5 }));
const browser = spawn(chromium, ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe", "--enable-unsafe-swiftshader",
  "--use-angle=swiftshader", "--autoplay-policy=user-gesture-required", "--window-size=1000,900", "--user-data-dir=" + home],
  { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const fail = what => { console.log(what); process.exit(1); };
browser.on("error", error => fail(error.message));
browser.stdio[3].on("error", () => {});  // the browser has ended, which is reported below
browser.on("exit", code => process.exitCode === undefined ? fail("chromium ended by itself, with " + code) : process.exit());
const { call, attach } = browse(browser);
main(call, attach).then(() => { process.exitCode = 0; }, error => { console.log(error.message); process.exitCode = 1; })
  .finally(() => call("Browser.close"));
