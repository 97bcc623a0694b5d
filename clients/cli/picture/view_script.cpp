#include "clients/cli/picture/bank_page.h"

namespace ringdown::cli {

// Turns the surface, shows mode shapes on it, and plays the sound of a blow where the surface is pressed. Places are
// projected here, so that a press finds its triangle in the same numbers; WebGL fills the triangles.
const char* const kViewScript = R"js("use strict";
(function () {
  const { data, points, triangles, places } = ringdown;
  const view = document.getElementById("view");
  if (!data.modes) { view.textContent = "The surface has too many triangles for this view."; return; }
  const canvas = view.querySelector("canvas"), gl = canvas.getContext("webgl2");
  if (!gl) { view.textContent = "This view needs a browser with WebGL 2."; return; }
  const rows = Array.from(document.querySelectorAll("tbody tr"));
  const box = name => document.getElementById(name);
  const count = points.length / 3, depth = 100000;
  let mode = 0, turn = -0.55, tilt = 0.5, zoom = 1, drag = null, struck = -1, asked = false, before = 0;
  const screen = new Float32Array(4 * count);  // x, y, z of each point in pixels, and how far it moves: 0 to 1
  const bend = new Float32Array(3 * count), amount = new Float32Array(count);

  // The four places nearest to each point, with weights; a point that is a place has itself.
  const near = [], weight = [];
  if (places.length < count) {
    for (let p = 0; p < count; ++p) {
      const best = [];
      for (let k = 0; k < places.length; ++k) {
        let d = 0;
        for (let c = 0; c < 3; ++c) d += (points[3 * p + c] - points[3 * places[k] + c]) ** 2;
        if (best.length < 4 || d < best[best.length - 1][0]) {
          best.push([d, k]);
          best.sort((a, b) => a[0] - b[0]);
          if (best.length > 4) best.pop();
        }
      }
      const sum = best.reduce((s, [d]) => s + 1 / (d + 1e-6), 0);
      near.push(best.map(b => b[1]));
      weight.push(best.map(b => 1 / (b[0] + 1e-6) / sum));
    }
  }

  function showMode() {
    let most = 1e-30;
    for (let p = 0; p < count; ++p) {
      const among = near.length ? near[p] : [p], by = near.length ? weight[p] : [1];
      const sum = [0, 0, 0];
      among.forEach((k, i) => ringdown.shape(mode, k).forEach((v, c) => { sum[c] += by[i] * v; }));
      bend.set(sum, 3 * p);
      amount[p] = Math.hypot(...sum);
      most = Math.max(most, amount[p]);
    }
    for (let p = 0; p < count; ++p) amount[p] /= most;
    for (let n = 0; n < bend.length; ++n) bend[n] *= 32000 * 0.08 / most;
  }

  function program() {
    const made = gl.createProgram();
    const parts = [[gl.VERTEX_SHADER, `#version 300 es
      in vec4 place; uniform vec3 size; out vec3 at; out float moves;
      void main() {
        at = place.xyz; moves = place.w;
        gl_Position = vec4(2.0 * place.x / size.x - 1.0, 1.0 - 2.0 * place.y / size.y, -place.z / size.z, 1.0);
        gl_PointSize = 9.0;
      }`], [gl.FRAGMENT_SHADER, `#version 300 es
      precision highp float; in vec3 at; in float moves; uniform vec4 flat_colour; out vec4 colour;
      const vec3 stops[6] = vec3[6](vec3(68, 1, 84), vec3(65, 68, 135), vec3(42, 120, 142), vec3(34, 168, 132),
                                    vec3(122, 209, 81), vec3(253, 231, 37));
      void main() {
        if (flat_colour.a > 0.0) { colour = flat_colour; return; }
        float v = clamp(moves, 0.0, 1.0) * 5.0; int below = min(int(v), 4);
        vec3 n = cross(dFdx(at), dFdy(at));
        float light = 0.55 + 0.45 * abs(n.z) / max(length(n), 1e-9);
        colour = vec4(light * mix(stops[below], stops[below + 1], v - float(below)) / 255.0, 1.0);
      }`]];
    for (const [kind, text] of parts) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    gl.useProgram(made);
    return made;
  }
  const shaders = program();
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(gl.getAttribLocation(shaders, "place"));
  gl.vertexAttribPointer(gl.getAttribLocation(shaders, "place"), 4, gl.FLOAT, false, 0, 0);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(1, 1, 1, 1);

  function project(phase) {
    const size = zoom * Math.min(canvas.width, canvas.height) / 32000 * 0.62;
    const c = Math.cos(turn), s = Math.sin(turn), ct = Math.cos(tilt), st = Math.sin(tilt);
    for (let p = 0; p < count; ++p) {
      const [x, y, z] = [0, 1, 2].map(k => points[3 * p + k] + phase * bend[3 * p + k]);
      const away = s * x + c * y;
      screen[4 * p] = canvas.width / 2 + size * (c * x - s * y);
      screen[4 * p + 1] = canvas.height / 2 - size * (ct * z + st * away);
      screen[4 * p + 2] = size * (st * z - ct * away);
      screen[4 * p + 3] = amount[p];
    }
  }

  function draw(time) {
    asked = false;
    const vibrates = box("move").checked, turns = box("turn").checked && !drag;
    if (turns && before) turn += Math.min(time - before, 100) / 4000;
    before = turns ? time : 0;
    project(vibrates ? Math.sin(time / 250) : 0);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.bufferData(gl.ARRAY_BUFFER, screen, gl.DYNAMIC_DRAW);
    gl.uniform3f(gl.getUniformLocation(shaders, "size"), canvas.width, canvas.height, depth);
    const flat = gl.getUniformLocation(shaders, "flat_colour");
    gl.uniform4f(flat, 0, 0, 0, 0);
    if (triangles.length) {
      gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_SHORT, 0);
    } else {
      gl.uniform4f(flat, 0.13, 0.47, 0.56, 1);
      gl.drawArrays(gl.POINTS, 0, count);
    }
    if (struck >= 0) {
      gl.disable(gl.DEPTH_TEST);
      gl.uniform4f(flat, 0.84, 0.37, 0, 1);
      gl.drawArrays(gl.POINTS, places[struck], 1);
      gl.enable(gl.DEPTH_TEST);
    }
    if (vibrates || turns) redraw();
  }
  function redraw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(draw);
  }

  const eye = () => [-Math.cos(tilt) * Math.sin(turn), -Math.cos(tilt) * Math.cos(turn), Math.sin(tilt)];
  const faces = (place, [x, y, z]) => {
    const n = ringdown.normals, p = 3 * places[place];
    return n[p] * x + n[p + 1] * y + n[p + 2] * z > 0;
  };

  // The place nearest to what is seen at a pixel, of those on surfaces that face the eye; -1 where nothing is.
  function placeAt(px, py) {
    let hit = null, top = -Infinity;
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map(k => 4 * triangles[t + k]);
      const ux = screen[b] - screen[a], uy = screen[b + 1] - screen[a + 1];
      const vx = screen[c] - screen[a], vy = screen[c + 1] - screen[a + 1], area = ux * vy - uy * vx;
      if (!area) continue;
      const qx = px - screen[a], qy = py - screen[a + 1];
      const s = (qx * vy - qy * vx) / area, r = (ux * qy - uy * qx) / area;
      if (s < 0 || r < 0 || s + r > 1) continue;
      const z = screen[a + 2] + s * (screen[b + 2] - screen[a + 2]) + r * (screen[c + 2] - screen[a + 2]);
      if (z > top) { top = z; hit = true; }
    }
    if (!hit && triangles.length) return -1;
    let best = -1, least = hit ? Infinity : 30 * 30;
    const from = eye();
    places.forEach((p, k) => {
      if (hit && !faces(k, from)) return;
      const d = (screen[4 * p] - px) ** 2 + (screen[4 * p + 1] - py) ** 2 + (hit ? (screen[4 * p + 2] - top) ** 2 : 0);
      if (d < least) { least = d; best = k; }
    });
    return best;
  }

  // All blows have one impulse, with which no place peaks above full scale.
  let audio = null, impulse = 0;
  function loudness() {
    let most = 1e-300;
    for (let k = 0; k < places.length; ++k) {
      const sum = ringdown.amplitudes(k, ringdown.inward(k), 1e-4).reduce((all, a) => all + Math.abs(a), 0);
      most = Math.max(most, sum);
    }
    return 0.9 / most;
  }
  function strike(place) {
    struck = place;
    impulse = impulse || loudness();
    const contact_s = 1e-4 * Math.pow(20, box("soft").value / 100), direction = ringdown.inward(place);
    const at = [0, 1, 2].map(k => (data.middle_m[k] + data.unit_m * points[3 * places[place] + k]).toPrecision(3));
    box("struck").textContent = "Struck at (" + at.join(", ") + ") m";
    audio = audio || new AudioContext();
    const blow = direction.map(v => impulse * v);
    const from = eye(), samples = ringdown.render(ringdown.amplitudes(place, blow, contact_s), from, audio.sampleRate);
    const fade = Math.min(samples.length, Math.round(0.05 * audio.sampleRate));
    const buffer = audio.createBuffer(1, samples.length, audio.sampleRate), out = buffer.getChannelData(0);
    for (let n = 0; n < samples.length; ++n) out[n] = samples[n] * Math.min(1, (samples.length - n) / fade);
    const source = audio.createBufferSource();
    source.buffer = buffer;
    source.connect(audio.destination);
    source.start();
    ringdown.last = { place, blow, contact_s, eye: from, buffer, audio };
    wake();
    redraw();
  }
  // A browser lets a page sound from its visitor's first click on, or from the end of the first touch.
  function wake() { if (audio && audio.state === "suspended") audio.resume(); }

  function choose(m) {
    if (m < 0 || m >= data.modes) return;
    rows[mode].classList.remove("chosen");
    mode = m;
    rows[mode].classList.add("chosen");
    box("view-title").textContent =
      "mode " + m + ", " + rows[m].cells[1].textContent + " Hz, T60 " + rows[m].cells[3].textContent + " s";
    showMode();
    redraw();
  }
  rows.forEach((row, m) => row.addEventListener("click", () => choose(m)));
  canvas.addEventListener("pointerdown", e => {
    drag = [e.clientX, e.clientY];
    canvas.setPointerCapture(e.pointerId);
    const at = canvas.getBoundingClientRect();
    const place = placeAt((e.clientX - at.left) * canvas.width / at.width, (e.clientY - at.top) * canvas.height / at.height);
    if (place >= 0) strike(place);
  });
  canvas.addEventListener("pointermove", e => {
    if (!drag) return;
    turn += (e.clientX - drag[0]) / 150;
    tilt = Math.max(-1.57, Math.min(1.57, tilt + (e.clientY - drag[1]) / 150));
    drag = [e.clientX, e.clientY];
    redraw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { drag = null; wake(); redraw(); });
  canvas.addEventListener("wheel", e => { e.preventDefault(); zoom *= Math.exp(-e.deltaY / 800); redraw(); });
  for (const name of ["move", "turn"]) box(name).addEventListener("change", redraw);
  document.addEventListener("keydown", e => {
    if (e.target && e.target.type === "range") return;
    if (e.key === "ArrowRight" || e.key === "ArrowDown") choose(mode + 1);
    else if (e.key === "ArrowLeft" || e.key === "ArrowUp") choose(mode - 1);
    else return;
    e.preventDefault();
  });
  choose(0);
})();
)js";

}  // namespace ringdown::cli
