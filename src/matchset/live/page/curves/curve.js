// One curve of the last 30 s with its band of two standard deviations; lost stretches are marked.

import { palette, Surface } from "../canvas.js";
import { BAND, drawGrid, frameOf, rangeOf, strokeIn } from "./grid.js";
import { Inspected } from "./inspected.js";
import { PER_SECOND, SECONDS } from "./samples.js";

const GAP = 1.5; // s without a sample, after which the line begins anew

export class Curve {
  constructor(canvas) {
    this.surface = new Surface(canvas);
    this.surface.redraw = () => this.again && this.again();
    this.inspected = new Inspected(canvas, this.surface.redraw);
  }

  draw(samples, name, unit, color) {
    this.again = () => this.draw(samples, name, unit, color);
    const { surface } = this;
    const context = surface.begin();
    const { ratio, text } = surface;
    const frame = frameOf(surface);
    if (frame.right - frame.left < 10 || frame.bottom - frame.top < 10) return;
    context.fillStyle = palette.ink;
    context.fillText(`${name}, ${unit || "1"}`, 0, text);
    const points = collect(samples, frame);
    const [least, most] = rangeOf(points);
    const y = (value) => frame.top + (most - value) / (most - least) * (frame.bottom - frame.top);
    drawGrid(context, frame, surface, [least, most], y, [`${SECONDS} s ago`, "now"]);
    drawLost(context, frame, points, surface);
    context.save();
    context.beginPath();
    context.rect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
    context.clip();
    for (const run of runs(points)) drawRun(context, run, y, ratio, color);
    context.restore();
    this.mark(context, frame, points, y, { name, unit });
  }

  // The value at the point that is nearest to the pointer.
  mark(context, frame, points, y, of) {
    const wanted = this.inspected.at(this.surface.width);
    if (wanted === null || !points.length) return;
    const point = points.reduce((best, each) => (Math.abs(each.x - wanted) < Math.abs(best.x - wanted) ? each : best));
    const missing = Number.isNaN(point.low);
    const value = missing ? null : (point.low + point.high) / 2;
    const when = `${point.ago.toFixed(1)} s ago`;
    this.inspected.mark(context, frame, this.surface.ratio, { ...of, x: point.x, y: missing ? 0 : y(value), value, sigma: point.sigma, when });
  }
}

// One point for each pixel across: more cannot be seen, and each costs the browser time after the script has ended.
function collect(samples, frame) {
  const points = [];
  samples.each((ago, low, high, sigma, lost) => {
    const x = frame.right - ago / SECONDS * (frame.right - frame.left);
    const last = points[points.length - 1];
    if (last && Math.floor(last.x) === Math.floor(x) && Number.isNaN(last.low) === Number.isNaN(low)) {
      last.low = Math.min(last.low, low);
      last.high = Math.max(last.high, high);
      last.sigma = Math.max(last.sigma, sigma);
      last.ago = ago;
      last.lost ||= lost;
    } else if (x >= frame.left) points.push({ ago, x, low, high, sigma, lost });
  });
  return points;
}

// Stretches without a gap: where it was lost, or nothing came.
function runs(points) {
  const found = [];
  let run = null;
  let last = Infinity;
  for (const point of points) {
    if (Number.isNaN(point.low)) { run = null; continue; }
    if (!run || last - point.ago > GAP) found.push(run = []);
    run.push(point);
    last = point.ago;
  }
  return found;
}

function drawRun(context, run, y, ratio, color) {
  context.fillStyle = color;
  context.globalAlpha = 0.28;
  context.beginPath();
  for (const point of run) context.lineTo(point.x, y(point.high + BAND * point.sigma));
  for (let i = run.length - 1; i >= 0; i--) context.lineTo(run[i].x, y(run[i].low - BAND * run[i].sigma));
  context.closePath();
  context.fill();
  context.beginPath();
  for (const { x, low, high } of run) {
    context.lineTo(x, y(high));
    if (low < high) context.lineTo(x, y(low));
  }
  if (run.length === 1) context.lineTo(run[0].x + ratio, y(run[0].low));
  strokeIn(context, color, 2 * ratio);
}

// A tint over the whole height, a bar at the foot, and the word where there is room.
function drawLost(context, frame, points, { ratio, text }) {
  const step = (frame.right - frame.left) / SECONDS / PER_SECOND;
  context.fillStyle = palette.warn;
  let from = null;
  const end = (to) => {
    context.globalAlpha = 0.14;
    context.fillRect(from, frame.top, to - from, frame.bottom - frame.top);
    context.globalAlpha = 1;
    context.fillRect(from, frame.bottom - 3 * ratio, to - from, 3 * ratio);
    if (to - from > 2.6 * text) context.fillText("lost", from + 0.4 * text, frame.bottom - 0.5 * text);
    from = null;
  };
  for (let i = 0; i < points.length; i++) {
    const { x, low, lost } = points[i];
    const missing = lost && Number.isNaN(low);
    if (missing && from === null) from = Math.max(frame.left, x - step / 2);
    if (from !== null && (!missing || i === points.length - 1)) end(Math.max(missing ? frame.right : x, from + 2 * ratio));
  }
}
