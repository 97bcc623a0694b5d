#include "clients/cli/picture/bank_page.h"

namespace ringdown::cli {

// Makes the object `ringdown` from the page's numbers: places, their normals, and the sound of a blow by the equation
// of docs/how/physics.md, section 5. It touches no canvas and no loudspeaker, so tests run it alone.
const char* const kSoundScript = R"js(
const ringdown = (function () {
  const data = JSON.parse(document.getElementById("view-data").textContent);
  if (!data.modes) return { data };
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  const points = new Int16Array(bytes(data.points)), triangles = new Uint16Array(bytes(data.triangles));
  const places = new Uint16Array(bytes(data.places)), shapes = new Int16Array(bytes(data.shapes));
  const radiation = data.radiation ? readRadiation(bytes(data.radiation)) : null;
  const maxSeconds = 8, inaudible = 1e-5;

  // A mode's displacement at a place [kg^-1/2].
  function shape(mode, place) {
    const at = 3 * (mode * places.length + place), unit = data.shape_unit[mode];
    return [unit * shapes[at], unit * shapes[at + 1], unit * shapes[at + 2]];
  }
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  // The unit normal of each sample point, from the areas of its triangles; 0, 0, 0 without triangles.
  const normals = new Float64Array(points.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map(k => 3 * triangles[t + k]);
    const u = [0, 1, 2].map(k => points[b + k] - points[a + k]), v = [0, 1, 2].map(k => points[c + k] - points[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) normals[corner + k] += n[k];
  }
  for (let p = 0; p < normals.length; p += 3) {
    const size = Math.hypot(normals[p], normals[p + 1], normals[p + 2]) || 1;
    for (let k = 0; k < 3; ++k) normals[p + k] /= size;
  }

  // The direction of a blow at a place: into the surface, or, without triangles, along the axis that answers loudest.
  function inward(place) {
    const n = [0, 1, 2].map(k => -normals[3 * places[place] + k]);
    if (dot(n, n) > 0) return n;
    const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const answer = axes.map(axis => amplitudes(place, axis, 0).reduce((sum, a) => sum + a * a, 0));
    return axes[answer.indexOf(Math.max(...answer))];
  }

  // The spectrum of a half-sine of unit impulse that lasts `contact_s`.
  function pulse(frequency_hz, contact_s) {
    const x = 2 * frequency_hz * contact_s, u = Math.PI / 2 * (1 - x);
    return Math.PI / 2 * (Math.abs(u) < 1e-6 ? 1 : Math.sin(u) / u) / (1 + x);
  }

  // The amplitude of each mode after a blow of an impulse [N s, a vector] at a place; full scale is 1.
  function amplitudes(place, impulse, contact_s) {
    return data.frequency_hz.map((f, m) => data.output[m] * dot(shape(m, place), impulse) * pulse(f, contact_s));
  }

  // The samples of modes that a blow has set going at the first sample, as they are heard in a direction of the object's
  // frame. A mode ends when it is 100 dB below the loudest one's beginning; modes at or above half the rate are silent.
  function render(amplitude, toward, rate, seconds = maxSeconds) {
    const gains = radiation ? radiation.toward(toward) : amplitude.map(() => [1, 0]);
    const size = amplitude.map((a, m) => data.frequency_hz[m] >= rate / 2 ? 0 : Math.abs(a) * Math.hypot(...gains[m]));
    const least = inaudible * Math.max(1e-30, ...size);
    const lengths = size.map((s, m) => s <= least ? 0 :
      Math.ceil(rate * Math.min(seconds, Math.log(s / least) / Math.max(data.decay_per_s[m], 1e-3))));
    const samples = new Float64Array(Math.max(1, ...lengths));
    lengths.forEach((length, m) => {
      const w = 2 * Math.PI * data.frequency_hz[m] / rate, r = Math.exp(-data.decay_per_s[m] / rate);
      const turn = 2 * r * Math.cos(w), loss = r * r, sine = amplitude[m] * gains[m][0], cosine = amplitude[m] * gains[m][1];
      let now = cosine, next = r * (sine * Math.sin(w) + cosine * Math.cos(w));
      for (let n = 0; n < length; ++n) {
        const after = turn * next - loss * now;
        samples[n] += now;
        now = next;
        next = after;
      }
    });
    return samples;
  }

  return { data, points, triangles, places, normals, radiation, shape, inward, amplitudes, render };
})();
)js";

}  // namespace ringdown::cli
