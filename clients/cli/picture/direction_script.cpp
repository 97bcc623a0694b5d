#include "clients/cli/picture/bank_page.h"

namespace ringdown::cli {

// Reads maps of radiation (docs/reference/bank-format.md) and finds how loud, and with which phase, each mode is heard
// in a direction. The harmonics are those of Holmes & Featherstone (J. Geodesy 2002), degree after degree.
const char* const kDirectionScript = R"js("use strict";
function readRadiation(bytes) {
  const view = new DataView(bytes), modes = view.getUint32(4, true);
  let at = 20;
  function short() {  // seven bits in each byte, the lowest first
    const low = view.getUint8(at++);
    return low < 128 ? low : (low & 127) | view.getUint8(at++) << 7;
  }
  const unfold = value => value % 2 ? -(value + 1) / 2 : value / 2;

  // Of each mode its terms, turned to its main phase, as multiples of its rms over all directions. A mode of the mixer
  // goes as exp(+i w t), so that phases are those of the map with the other sign.
  function readMode() {
    const terms = view.getUint16(at + 8, true), levels = view.getUint8(at + 10), harmonics = [], re = [], im = [];
    at += 11 + 6 * levels;
    let harmonic = -1, power = 0, squareRe = 0, squareIm = 0;
    for (let t = 0; t < terms; ++t) {
      harmonic += short();
      const a = unfold(short()), b = unfold(short());
      harmonics.push(harmonic);
      re.push(a);
      im.push(-b);
      power += a * a + b * b;
      squareRe += a * a - b * b;
      squareIm += 2 * a * b;
    }
    const scale = power > 0 ? 1 / Math.sqrt(power / (4 * Math.PI)) : 0, phase = Math.atan2(squareIm, squareRe) / 2;
    const c = scale * Math.cos(phase), s = scale * Math.sin(phase);
    return { harmonics, re: re.map((a, t) => a * c - im[t] * s), im: re.map((a, t) => a * s + im[t] * c) };
  }
  const maps = Array.from({ length: modes }, readMode);
  const degree = Math.floor(Math.sqrt(Math.max(0, ...maps.map(map => map.harmonics[map.harmonics.length - 1] || 0))));

  function harmonicsToward([x, y, z]) {
    const size = Math.hypot(x, y, z), values = new Float64Array((degree + 1) ** 2);
    [x, y, z] = [x / size, y / size, z / size];
    let diagonal = 0.5 / Math.sqrt(Math.PI), re = 1, im = 0;
    for (let m = 0; m <= degree; ++m) {
      if (m > 0) {
        diagonal *= Math.sqrt((2 * m + 1) / (2 * m));
        [re, im] = [re * x - im * y, re * y + im * x];
      }
      let before = 0, now = diagonal;
      for (let l = m; l <= degree; ++l) {
        if (l > m) {
          const a = Math.sqrt((4 * l * l - 1) / (l * l - m * m));
          const b = Math.sqrt(((l - 1) ** 2 - m * m) / (4 * (l - 1) ** 2 - 1));
          [before, now] = [now, a * (z * now - (l > m + 1 ? b * before : 0))];
        }
        values[l * l + l + m] = (m > 0 ? Math.SQRT2 : 1) * now * re;
        if (m > 0) values[l * l + l - m] = Math.SQRT2 * now * im;
      }
    }
    return values;
  }

  // The complex gain of each mode towards a direction of the object's frame, as [real, imaginary].
  function toward(direction) {
    const values = harmonicsToward(direction);
    const sum = (terms, parts) => parts.reduce((all, part, t) => all + part * values[terms[t]], 0);
    return maps.map(map => [sum(map.harmonics, map.re), sum(map.harmonics, map.im)]);
  }
  return { origin_m: [8, 12, 16].map(byte => view.getFloat32(byte, true)), toward };
}
)js";

}  // namespace ringdown::cli
