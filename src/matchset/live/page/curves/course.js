// The course of the chosen target over a whole video: x, y, z (or x, y, r) and the way from above, with the frame that is
// shown. A click on a curve goes to that frame.

import { palette, Surface } from "../canvas.js";
import { colorOf } from "../colors.js";
import { BAND, drawDepths, drawGrid, frameOf, LEFT, NAMES, rangeOf, strokeIn, UNITS } from "./grid.js";
import { Inspected } from "./inspected.js";

const WAIT = 500; // ms between two questions for the course while it grows

export class Courses {
  // `seek(share)` goes to a share of the video, 0 ... 1.
  constructor(root, seek) {
    this.root = root;
    this.course = null;
    this.share = 0;
    const canvases = [0, 1, 2, 3].map((number) => {
      const canvas = document.createElement("canvas");
      if (number < 3) canvas.addEventListener("click", (event) => seek(shareAt(canvas, event)));
      return canvas;
    });
    root.append(...canvases);
    this.inspected = canvases.map((canvas, number) => new Inspected(canvas, () => this.draw(), {
      valued: number < 3, go: (share) => seek(shareOf(canvas, share * canvas.clientWidth)),
    }));
    this.surfaces = canvases.map((canvas) => {
      const surface = new Surface(canvas);
      surface.redraw = () => this.draw();
      return surface;
    });
    this.draw();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  // `version` is another one whenever more is known of the target.
  async update(target, version) {
    const wanted = `${target} ${version}`;
    if (target === null) { this.wanted = this.shown = ""; this.course = null; this.draw(); return; }
    this.wanted = wanted;
    if (this.asking || wanted === this.shown) return;
    this.asking = true;
    try {
      const answer = await fetch(`course.json?target=${target}`);
      if (answer.ok) {
        this.course = await answer.json();
        this.shown = this.course.whole ? wanted : "";
      }
      this.draw();
      await new Promise((done) => setTimeout(done, WAIT));
    } catch { /* the server is gone: asked again with the next state */ } finally { this.asking = false; }
    if (this.wanted && this.wanted !== this.shown) this.update(...this.wanted.split(" ").map(Number));
  }

  showAt(share) {
    if (share === this.share) return;
    this.share = share;
    this.draw();
  }

  draw() {
    const { course } = this;
    const some = Boolean(course && course.names.length);
    this.root.dataset.some = some;
    this.surfaces[3].canvas.hidden = !some || !course.placed;
    if (!some) { for (const surface of this.surfaces) surface.begin(); return; }
    course.names.forEach((name, index) => this.drawCurve(this.surfaces[index], name, index));
    if (course.placed) this.drawAbove(this.surfaces[3]);
  }

  drawCurve(surface, name, index) {
    const { course } = this;
    const context = surface.begin();
    const { ratio, text } = surface;
    const frame = frameOf(surface);
    if (frame.right - frame.left < 10 || frame.bottom - frame.top < 10) return;
    const [low, high, sigma] = [course.low[index], course.high[index], course.sigma[index]];
    const [least, most] = rangeOf(low.map((each, i) => ({ low: each, high: high[i], sigma: sigma[i] })));
    const count = low.length;
    const x = (column) => frame.left + (column + 0.5) / count * (frame.right - frame.left);
    const y = (value) => frame.top + (most - value) / (most - least) * (frame.bottom - frame.top);
    context.fillStyle = palette.ink;
    context.fillText(`${NAMES[name] ?? name}, ${course.placed ? "m" : UNITS[name] ?? "px"}`, 0, text);
    const ends = [course.times[0], course.times[count - 1]].map((time) => `${time.toFixed(1)} s`);
    drawGrid(context, frame, surface, [least, most], y, ends);
    context.fillStyle = palette.warn;
    const step = (frame.right - frame.left) / count;
    course.lost.forEach((lost, column) => {
      if (lost) context.fillRect(x(column) - step / 2, frame.bottom - 4 * ratio, Math.max(step, ratio), 4 * ratio);
    });
    const color = colorOf(course.target);
    context.fillStyle = color;
    for (let i = 0; i < count; i++) {
      if (low[i] === null) continue;
      const spread = BAND * (sigma[i] || 0);
      const [top, bottom] = [y(high[i] + spread), y(low[i] - spread)];
      context.globalAlpha = 0.28;
      context.fillRect(x(i) - step / 2, top, Math.max(step, ratio), bottom - top);
    }
    context.beginPath();
    for (let i = 0, pen = false; i < count; i++) {
      if (low[i] === null) { pen = false; continue; }
      context[pen ? "lineTo" : "moveTo"](x(i), y(high[i]));
      if (low[i] < high[i]) context.lineTo(x(i), y(low[i]));
      pen = true;
    }
    strokeIn(context, color, 2 * ratio);
    context.fillStyle = palette.ink;
    context.fillRect(frame.left + this.share * (frame.right - frame.left) - ratio, frame.top, 2 * ratio, frame.bottom - frame.top);
    this.mark(context, surface, frame, index, x, y);
  }

  // The value in the column under the pointer.
  mark(context, { width, ratio }, frame, index, x, y) {
    const { course } = this;
    const wanted = this.inspected[index].at(width);
    if (wanted === null) return;
    const count = course.times.length;
    const column = Math.min(Math.max(Math.floor((wanted - frame.left) / (frame.right - frame.left) * count), 0), count - 1);
    const [low, high] = [course.low[index][column], course.high[index][column]];
    const value = low === null ? null : (low + high) / 2;
    const name = course.names[index];
    this.inspected[index].mark(context, frame, ratio, {
      name: NAMES[name] ?? name, unit: course.placed ? "m" : UNITS[name] ?? "px", x: x(column), y: value === null ? 0 : y(value),
      value, sigma: course.sigma[index][column], when: `${course.times[column].toFixed(2)} s`,
    });
  }

  drawAbove(surface) {
    const { course } = this;
    const context = surface.begin();
    const { width, height, ratio, text } = surface;
    const middle = (index) => course.low[index].map((low, column) => (low === null ? null : (low + course.high[index][column]) / 2));
    const [across, along] = [middle(0), middle(2)];
    const deep = 1.12 * along.reduce((most, z) => Math.max(most, z ?? 0), 0.2);
    const wide = 1.12 * across.reduce((most, x) => Math.max(most, Math.abs(x ?? 0)), 0.1);
    const foot = height - 1.2 * text;
    const scale = Math.min((foot - 1.6 * text) / deep, width / 2 / wide);
    const place = (column) => [width / 2 + across[column] * scale, foot - along[column] * scale];
    context.fillStyle = palette.ink;
    context.fillText("from above, m", 0, text);
    drawDepths(context, surface, deep, foot, scale);
    context.fillText("▲ camera", width / 2 - 0.4 * text, height - 0.2 * text);
    context.beginPath();
    for (let i = 0, pen = false; i < across.length; i++) {
      if (across[i] === null || along[i] === null) { pen = false; continue; }
      context[pen ? "lineTo" : "moveTo"](...place(i));
      pen = true;
    }
    strokeIn(context, colorOf(course.target), 2 * ratio);
    const now = Math.min(Math.floor(this.share * across.length), across.length - 1);
    if (across[now] === null || along[now] === null) return;
    context.fillStyle = palette.ink;
    context.beginPath();
    context.arc(...place(now), 0.42 * text, 0, 2 * Math.PI);
    context.fill();
  }
}

const shareAt = (canvas, event) => shareOf(canvas, event.clientX - canvas.getBoundingClientRect().left);

// The share of the video at a place on a canvas, CSS px from its left.
function shareOf(canvas, at) {
  const left = LEFT * palette.text;
  return Math.min(Math.max((at - left) / (canvas.clientWidth - left - 1), 0), 1);
}
