// Curves of the last 30 s with their band of two standard deviations, and the view from above.
// Samples lie in ring buffers; a curve is drawn by the least and the largest of each column of pixels, so the cost of a
// frame is that of the columns and not of the samples.

const SECONDS = 30;
const CAPACITY = 16384; // samples: 30 s at 500/s
const BAND = 2; // standard deviations

export class Samples {
  constructor() {
    this.time = new Float64Array(CAPACITY);
    this.value = new Float32Array(CAPACITY);
    this.sigma = new Float32Array(CAPACITY);
    this.clear();
  }

  clear() { this.count = 0; }

  add(time, value, sigma) {
    const slot = this.count++ % CAPACITY;
    this.time[slot] = time;
    this.value[slot] = value;
    this.sigma[slot] = sigma;
  }

  * since(time) {
    for (let i = Math.max(0, this.count - CAPACITY); i < this.count; i++) {
      const slot = i % CAPACITY;
      if (this.time[slot] >= time) yield slot;
    }
  }
}

// Least and largest value of each column; NaN where it was lost all along.
export function columns(samples, now, width) {
  const low = new Float32Array(width).fill(NaN);
  const high = new Float32Array(width).fill(NaN);
  const spread = new Float32Array(width);
  for (const slot of samples.since(now - SECONDS)) {
    const value = samples.value[slot];
    const column = Math.min(width - 1, Math.max(0, Math.floor((samples.time[slot] - now + SECONDS) / SECONDS * width)));
    if (Number.isNaN(value)) continue;
    if (!(low[column] <= value)) low[column] = value;
    if (!(high[column] >= value)) high[column] = value;
    spread[column] = Math.max(spread[column], samples.sigma[slot] || 0);
  }
  return { low, high, spread };
}

export class Curve {
  constructor(canvas) {
    this.canvas = canvas;
    this.samples = new Samples();
    this.name = "";
  }

  add(name, unit, time, value, sigma) {
    if (name !== this.name) this.samples.clear();
    this.name = name;
    this.unit = unit;
    this.samples.add(time, value, sigma ?? 0);
    this.last = time;
  }

  draw() {
    const { context, width, height, ratio } = prepare(this.canvas);
    if (!this.samples.count) return;
    const style = getComputedStyle(document.documentElement);
    const [ink, soft, lineColor, accent] = ["--ink", "--soft", "--line", "--accent"].map((name) => style.getPropertyValue(name));
    const left = 52 * ratio;
    const bottom = 18 * ratio;
    const top = 22 * ratio;
    const plot = Math.max(1, Math.floor(width - left));
    const { low, high, spread } = columns(this.samples, this.last, plot);
    const finite = [...low].some((value) => !Number.isNaN(value));
    let least = Infinity;
    let most = -Infinity;
    for (let i = 0; i < plot; i++) {
      if (Number.isNaN(low[i])) continue;
      least = Math.min(least, low[i] - BAND * spread[i]);
      most = Math.max(most, high[i] + BAND * spread[i]);
    }
    if (!finite) { least = 0; most = 1; }
    const margin = Math.max((most - least) * 0.08, 1e-6);
    least -= margin;
    most += margin;
    const y = (value) => top + (most - value) / (most - least) * (height - top - bottom);
    context.font = `${13 * ratio}px system-ui, sans-serif`;
    context.fillStyle = ink;
    context.fillText(`${this.name}, ${this.unit}`, 0, 14 * ratio);
    context.strokeStyle = lineColor;
    context.fillStyle = soft;
    context.lineWidth = ratio;
    for (const tick of ticks(least, most)) {
      context.beginPath();
      context.moveTo(left, y(tick.value));
      context.lineTo(width, y(tick.value));
      context.stroke();
      context.textAlign = "right";
      context.fillText(tick.words, left - 6 * ratio, y(tick.value) + 4 * ratio);
    }
    context.textAlign = "left";
    context.fillText(`${SECONDS} s ago`, left, height - 3 * ratio);
    context.textAlign = "right";
    context.fillText("now", width, height - 3 * ratio);
    context.textAlign = "left";
    context.fillStyle = accent;
    context.globalAlpha = 0.25;
    for (let i = 0; i < plot; i++) {
      if (Number.isNaN(low[i])) continue;
      const from = y(high[i] + BAND * spread[i]);
      context.fillRect(left + i, from, 1, Math.max(1, y(low[i] - BAND * spread[i]) - from));
    }
    context.globalAlpha = 1;
    context.strokeStyle = accent;
    context.lineWidth = 1.5 * ratio;
    context.beginPath();
    let pen = false;
    let gap = 0;
    for (let i = 0; i < plot; i++) {
      if (Number.isNaN(low[i])) { if (++gap > 40 * ratio) pen = false; continue; }
      gap = 0;
      if (!pen) context.moveTo(left + i, y(high[i]));
      context.lineTo(left + i, y(high[i]));
      context.lineTo(left + i, y(low[i]));
      pen = true;
    }
    context.stroke();
    this.drawLost(context, left, plot, top, height - bottom, ratio, style.getPropertyValue("--warn"));
  }

  // Lost stretches: a bar along the bottom.
  drawLost(context, left, plot, top, bottom, ratio, color) {
    context.fillStyle = color;
    for (const slot of this.samples.since(this.last - SECONDS)) {
      if (!Number.isNaN(this.samples.value[slot])) continue;
      const x = left + (this.samples.time[slot] - this.last + SECONDS) / SECONDS * plot;
      context.fillRect(x, bottom - 3 * ratio, Math.max(2, ratio), 3 * ratio);
    }
  }
}

export class ViewFromAbove {
  constructor(canvas) {
    this.canvas = canvas;
    this.points = [];
  }

  clear() { this.points = []; }

  add(time, x, z) {
    this.points.push([time, x, z]);
    while (this.points.length && this.points[0][0] < time - SECONDS) this.points.shift();
  }

  draw() {
    const { context, width, height, ratio } = prepare(this.canvas);
    if (!this.points.length) return;
    const style = getComputedStyle(document.documentElement);
    const farthest = Math.max(0.5, ...this.points.map(([, , z]) => z)) * 1.15;
    const scale = (height - 30 * ratio) / farthest;
    const place = (x, z) => [width / 2 + x * scale, height - 8 * ratio - z * scale];
    context.font = `${13 * ratio}px system-ui, sans-serif`;
    context.fillStyle = style.getPropertyValue("--ink");
    context.fillText("from above", 0, 14 * ratio);
    context.fillStyle = style.getPropertyValue("--soft");
    context.strokeStyle = style.getPropertyValue("--line");
    context.lineWidth = ratio;
    for (const { value, words } of ticks(0, farthest)) {
      if (!value) continue;
      const [, y] = place(0, value);
      context.beginPath();
      context.moveTo(0, y);
      context.lineTo(width, y);
      context.stroke();
      context.fillText(`${words} m`, 2, y - 3 * ratio);
    }
    context.fillText("▲ camera", ...place(0, 0));
    context.strokeStyle = style.getPropertyValue("--accent");
    context.lineWidth = 1.5 * ratio;
    context.beginPath();
    this.points.forEach(([, x, z], index) => context[index ? "lineTo" : "moveTo"](...place(x, z)));
    context.stroke();
    const [, x, z] = this.points[this.points.length - 1];
    context.fillStyle = style.getPropertyValue("--accent");
    context.beginPath();
    context.arc(...place(x, z), 5 * ratio, 0, 2 * Math.PI);
    context.fill();
  }
}

function prepare(canvas) {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, width, height);
  return { context, width, height, ratio };
}

function ticks(least, most) {
  const raw = (most - least) / 4;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((each) => each >= raw);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  const found = [];
  for (let value = Math.ceil(least / step) * step; value <= most; value += step) found.push({ value, words: value.toFixed(digits) });
  return found;
}
