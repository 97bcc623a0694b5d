// Strikes the object of a page at three places, with a hard and a soft mallet, heard from three sides, and prints for
// each blow how far the page's samples are from those of `ringdown render`: node strike_page.js FILE.html RINGDOWN BANK
"use strict";
const page = require("./page.js");
const [file, program, bank] = process.argv.slice(2);
const ringdown = page.sound(page.read(file)), count = ringdown.places.length;
const origin_m = ringdown.radiation ? ringdown.radiation.origin_m : ringdown.data.middle_m;
[[0, 0, [0, 0, 1]], [Math.floor(count / 3), 0.0002, [-3, 1, 0.5]], [count - 1, 0.002, [1, 0, 0]]].forEach(([place, contact_s, eye]) => {
  const along = ringdown.inward(place);
  const unit = ringdown.amplitudes(place, along, contact_s).reduce((sum, a) => sum + Math.abs(a), 0);
  const blow = along.map(v => Math.fround(1e-4 * v / unit));  // as soft as an object without nonlinear terms needs
  const samples = ringdown.render(ringdown.amplitudes(place, blow, contact_s), eye, 48000, 1);
  const vertex = ringdown.places[place], error = page.error(program, bank, { vertex, blow, contact_s, origin_m, eye, samples, rate: 48000 }, 1);
  console.log("error", error.toFixed(1), "dB at point", vertex, "contact", contact_s, "heard from", eye.join());
});
