// The view from above: the camera at the foot looks up, x to the right, z away from it, both at one scale.

import { palette, Surface } from "../canvas.js";
import { colorOf } from "../colors.js";
import { drawDepths } from "./grid.js";
import { Inspected } from "./inspected.js";
import { PER_SECOND, SECONDS } from "./samples.js";

export class ViewFromAbove {
  constructor(canvas) {
    this.surface = new Surface(canvas);
    this.surface.redraw = () => this.draw();
    new Inspected(canvas, this.surface.redraw, { valued: false });
    this.paths = new Map(); // number of a target: its last [time, x, z]
  }

  forget(keep) {
    for (const id of this.paths.keys()) if (!keep(id)) this.paths.delete(id);
  }

  add(id, time, x, z) {
    const path = this.paths.get(id) || [];
    this.paths.set(id, path);
    if (path.length && time < path[path.length - 1][0]) path.length = 0;
    while (path.length && path[0][0] < time - SECONDS) path.shift();
    const before = path[path.length - 2];
    if (before && time - before[0] < 1 / PER_SECOND) path.pop();
    path.push([time, x, z]);
  }

  draw() {
    const { surface } = this;
    const context = surface.begin();
    const { width, height, ratio, text } = surface;
    if (!this.paths.size || height < 4 * text) return;
    const points = [...this.paths.values()].flat();
    const deep = points.reduce((most, [, , z]) => Math.max(most, z), 0.2) * 1.12;
    const wide = points.reduce((most, [, x]) => Math.max(most, Math.abs(x)), 0.1) * 1.12;
    const foot = height - 1.2 * text;
    const scale = Math.min((foot - 1.6 * text) / deep, width / 2 / wide);
    const place = (x, z) => [width / 2 + x * scale, foot - z * scale];
    context.fillStyle = palette.ink;
    context.fillText("from above, m", 0, text);
    drawDepths(context, surface, deep, foot, scale);
    drawCamera(context, place(0, 0), text);
    for (const [id, path] of this.paths) drawPath(context, path, colorOf(id), place, ratio, text);
  }
}

function drawCamera(context, [x, y], text) {
  context.fillStyle = palette.soft;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x - 0.5 * text, y + text);
  context.lineTo(x + 0.5 * text, y + text);
  context.fill();
  context.fillText("camera", x + 0.9 * text, y + 0.95 * text);
}

// Older thirds are paler. What is nearer than a pixel to what was drawn is left out.
function drawPath(context, path, color, place, ratio, text) {
  const newest = path[path.length - 1];
  context.lineWidth = 2 * ratio;
  for (let part = 0; part < 3; part++) {
    const [from, to] = [newest[0] - SECONDS * (3 - part) / 3, newest[0] - SECONDS * (2 - part) / 3];
    context.beginPath();
    let [last, before] = [-Infinity, [NaN, NaN]];
    for (const [time, x, z] of path) {
      if (time < from || time > to + 0.1) continue;
      const at = place(x, z);
      const begins = time - last > 0.5;
      last = time;
      if (!begins && Math.hypot(at[0] - before[0], at[1] - before[1]) < ratio) continue;
      context[begins ? "moveTo" : "lineTo"](...at);
      before = at;
    }
    context.globalAlpha = 0.3 + 0.35 * part;
    context.strokeStyle = color;
    context.stroke();
  }
  context.globalAlpha = 1;
  context.beginPath();
  context.arc(...place(newest[1], newest[2]), 0.42 * text, 0, 2 * Math.PI);
  context.fillStyle = color;
  context.fill();
  context.lineWidth = 1.5 * ratio;
  context.strokeStyle = palette.ink;
  context.stroke();
}
