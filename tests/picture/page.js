// What tests know of a page that `ringdown picture` wrote: its scripts, and how the sound of a blow that the page
// computed differs from what `ringdown render` makes of that blow.
"use strict";
const fs = require("fs"), os = require("os"), path = require("path"), { execFileSync } = require("child_process");

// The page's numbers as text, and its two scripts.
exports.read = function (file) {
  const html = fs.readFileSync(file, "utf8");
  const [sound, view] = [...html.matchAll(/<script>([\s\S]*?)<\/script>/g)].map(match => match[1]);
  return { html, data: html.match(/id="view-data">([^<]*)</)[1], sound, view };
};

// Runs the page's script of sounds alone, without a window.
exports.sound = function (page) {
  const document = { getElementById: () => ({ textContent: page.data }) };
  const decoded = text => Buffer.from(text, "base64").toString("binary");
  return new Function("document", "atob", page.sound + "; return ringdown;")(document, decoded);
};

function text(value) {  // OSC: ended by zeros, up to a multiple of four bytes
  return Buffer.concat([Buffer.from(value), Buffer.alloc(4 - value.length % 4)]);
}

// A message at a time: [address, types, numbers].
function bundle(time_s, [address, types, numbers]) {
  const body = Buffer.alloc(4 * numbers.length);
  numbers.forEach((n, i) => types[i] === "i" ? body.writeInt32BE(n, 4 * i) : body.writeFloatBE(n, 4 * i));
  const message = Buffer.concat([text(address), text("," + types), body]);
  const head = Buffer.concat([Buffer.alloc(4), text("#bundle"), Buffer.alloc(12)]);
  head.writeInt32BE(16 + 4 + message.length, 0);
  head.writeUInt32BE(time_s * 2 ** 32, 16);
  head.writeInt32BE(message.length, 20);
  return Buffer.concat([head, message]);
}

// A listener a metre from `origin` in the direction `eye`, who looks there; the object is not turned.
function places(origin, eye) {
  const size = Math.hypot(...eye), [x, y, z] = eye.map(v => v / size);
  const half = Math.sqrt((1 - x) / 2), turn = half > 1e-6 ? [half, 0, z / (2 * half), -y / (2 * half)] : [0, 0, 0, 1];
  return [bundle(0, ["/object/it/pose", "fffffff", [0, 0, 0, 1, 0, 0, 0]]),
    bundle(0, ["/listener", "fffffff", [origin[0] + x, origin[1] + y, origin[2] + z, ...turn]])];
}

// The left channel of a WAV of 32-bit floats.
function left(file) {
  const wav = fs.readFileSync(file);
  let at = 12, channels = 0;
  while (wav.toString("latin1", at, at + 4) !== "data") {
    if (wav.toString("latin1", at, at + 4) === "fmt ") channels = wav.readUInt16LE(at + 10);
    at += 8 + wav.readUInt32LE(at + 4);
  }
  const samples = new Float64Array(wav.readUInt32LE(at + 4) / 4 / channels);
  for (let n = 0; n < samples.length; ++n) samples[n] = wav.readFloatLE(at + 8 + 4 * channels * n);
  return samples;
}

// How far the samples of a page's blow are from those of `ringdown render`, in dB of all that is heard in `seconds`. An
// object in front is heard from each side at sqrt(1/2) of its level.
exports.error = function (ringdown, bank, { vertex, blow, contact_s, origin_m, eye, samples, rate }, seconds) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "page-"));
  try {
    const sound = path.join(folder, "it.wav"), blows = path.join(folder, "it.osc");
    fs.writeFileSync(blows, Buffer.concat([...places(origin_m, eye),
      bundle(1 / 4, ["/object/it/strike_vertex", "iffff", [vertex, ...blow, contact_s]])]));
    execFileSync(ringdown, ["render", "--object", "it=" + bank, "--events", blows, "--seconds", seconds + 0.5, "--rate", rate,
      "--limiter", "off", "--floor", "300", "-o", sound], { stdio: ["ignore", "ignore", "inherit"] });
    const rendered = left(sound), from = rate / 4;
    let all = 0, wrong = 0;
    for (let n = 0; n < from; ++n) wrong += rendered[n] ** 2;
    for (let n = 0; n < rate * seconds; ++n) {
      const expected = rendered[from + n];
      all += expected ** 2;
      wrong += (expected - Math.SQRT1_2 * (n < samples.length ? samples[n] : 0)) ** 2;
    }
    return 10 * Math.log10(wrong / all);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
};
