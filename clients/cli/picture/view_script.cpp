#include "clients/cli/picture/bank_page.h"

namespace ringdown::cli {

// Turns and animates the surface in a 2-D canvas: far faces first, each in one colour.
const char* const kViewScript = R"js("use strict";
(function () {
  const data = JSON.parse(document.getElementById("view-data").textContent);
  const view = document.getElementById("view");
  if (!data.modes) { view.textContent = "The surface has too many triangles for this view."; return; }
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  const points = new Int16Array(bytes(data.points));
  const triangles = new Uint32Array(bytes(data.triangles));
  const shapes = new Int8Array(bytes(data.shapes));
  const count = points.length / 3;
  const canvas = view.querySelector("canvas"), pen = canvas.getContext("2d");
  const rows = Array.from(document.querySelectorAll("tbody tr"));
  const stops = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
  let mode = 0, turn = -0.55, tilt = 0.5, zoom = 1, moving = true, drag = null;
  const x = new Float32Array(count), y = new Float32Array(count), z = new Float32Array(count);
  const amount = new Float32Array(count);

  function heat(v, light) {
    const place = Math.max(0, Math.min(1, v)) * (stops.length - 1);
    const below = Math.min(Math.floor(place), stops.length - 2), share = place - below;
    const c = stops[below].map((a, i) => Math.round(light * (a + share * (stops[below + 1][i] - a))));
    return "rgb(" + c.join() + ")";
  }

  function project(phase) {
    const size = zoom * Math.min(canvas.width, canvas.height) / 32000 * 0.62;
    const bend = 32000 * 0.08 / 127 * phase, at = 3 * count * mode;
    const c = Math.cos(turn), s = Math.sin(turn), ct = Math.cos(tilt), st = Math.sin(tilt);
    let most = 1;
    for (let p = 0; p < count; ++p) {
      const [u, v, w] = [0, 1, 2].map(k => shapes[at + 3 * p + k]);
      amount[p] = Math.hypot(u, v, w);
      most = Math.max(most, amount[p]);
      const px = points[3 * p] + bend * u, py = points[3 * p + 1] + bend * v, pz = points[3 * p + 2] + bend * w;
      const right = c * px - s * py, away = s * px + c * py;
      x[p] = canvas.width / 2 + size * right;
      y[p] = canvas.height / 2 - size * (ct * pz + st * away);
      z[p] = st * pz - ct * away;
    }
    for (let p = 0; p < count; ++p) amount[p] /= most;
    return size;
  }

  function draw(time) {
    const size = project(moving ? Math.sin(time / 250) : 1);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    if (!triangles.length) {
      for (let p = 0; p < count; ++p) {
        pen.fillStyle = heat(amount[p], 1);
        pen.beginPath(); pen.arc(x[p], y[p], 6, 0, 7); pen.fill();
      }
    }
    const faces = [];
    for (let t = 0; t < triangles.length; t += 3) {
      const a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
      faces.push([z[a] + z[b] + z[c], a, b, c]);
    }
    faces.sort((f, g) => f[0] - g[0]);
    for (const [, a, b, c] of faces) {
      const ux = x[b] - x[a], uy = y[b] - y[a], uz = size * (z[b] - z[a]);
      const vx = x[c] - x[a], vy = y[c] - y[a], vz = size * (z[c] - z[a]);
      const n = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) || 1;
      const light = 0.62 + 0.38 * Math.abs(ux * vy - uy * vx) / n;
      pen.fillStyle = pen.strokeStyle = heat((amount[a] + amount[b] + amount[c]) / 3, light);
      pen.beginPath(); pen.moveTo(x[a], y[a]); pen.lineTo(x[b], y[b]); pen.lineTo(x[c], y[c]); pen.closePath();
      pen.fill(); pen.stroke();
    }
    if (moving) requestAnimationFrame(draw);
  }
  const redraw = () => { if (!moving) requestAnimationFrame(draw); };

  function choose(m) {
    if (m < 0 || m >= data.modes) return;
    rows[mode].classList.remove("chosen");
    mode = m;
    rows[mode].classList.add("chosen");
    document.getElementById("view-title").textContent =
      "mode " + m + ", " + rows[m].cells[1].textContent + " Hz, T60 " + rows[m].cells[3].textContent + " s";
    redraw();
  }
  rows.forEach((row, m) => row.addEventListener("click", () => choose(m)));
  canvas.addEventListener("pointerdown", e => { drag = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointermove", e => {
    if (!drag) return;
    turn += (e.clientX - drag[0]) / 150;
    tilt = Math.max(-1.57, Math.min(1.57, tilt + (e.clientY - drag[1]) / 150));
    drag = [e.clientX, e.clientY];
    redraw();
  });
  canvas.addEventListener("pointerup", () => { drag = null; });
  canvas.addEventListener("wheel", e => { e.preventDefault(); zoom *= Math.exp(-e.deltaY / 800); redraw(); });
  document.getElementById("move").addEventListener("change", e => {
    moving = e.target.checked;
    requestAnimationFrame(draw);
  });
  document.addEventListener("keydown", e => {
    if (e.key === "ArrowRight" || e.key === "ArrowDown") choose(mode + 1);
    else if (e.key === "ArrowLeft" || e.key === "ArrowUp") choose(mode - 1);
    else return;
    e.preventDefault();
  });
  choose(0);
  requestAnimationFrame(draw);
})();
)js";

}  // namespace ringdown::cli
