// The picture with vector drawings on top; clicks, drags, zoom.

import { colorOf } from "./colors.js";

const SVG = "http://www.w3.org/2000/svg";
const TRAIL = 90; // points
const DRAG = 6; // CSS px, below which a press is a click
const CLOSEST = 16; // largest zoom

export class PictureView {
  constructor(root, onPick, onOutline) {
    this.root = root;
    this.canvas = root.querySelector("canvas");
    this.drawing = root.querySelector("svg");
    this.context = this.canvas.getContext("2d");
    this.show = { outline: true, matchSet: false, trail: true };
    this.trails = new Map();
    this.zoom = { scale: 1, x: 0, y: 0 };
    this.sequence = 0;
    this.pointers = new Map();
    this.onPick = onPick;
    this.onOutline = onOutline;
    root.addEventListener("pointerdown", (event) => this.press(event));
    root.addEventListener("pointermove", (event) => this.move(event));
    root.addEventListener("pointerup", (event) => this.release(event));
    root.addEventListener("pointercancel", (event) => this.pointers.delete(event.pointerId));
    root.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  async paint(packet) {
    const { state } = packet;
    if (packet.feed !== this.feed) this.forget(packet.feed);
    if (packet.jpeg) {
      const bitmap = await createImageBitmap(packet.jpeg);
      if (packet.feed !== this.feed || packet.sequence < this.sequence) { bitmap.close(); return false; }
      if (this.canvas.width !== bitmap.width || this.canvas.height !== bitmap.height) {
        this.canvas.width = bitmap.width;
        this.canvas.height = bitmap.height;
      }
      this.context.drawImage(bitmap, 0, 0);
      bitmap.close();
      this.root.style.aspectRatio = `${state.width} / ${state.height}`;
      this.root.style.setProperty("--aspect", state.width / state.height);
      this.drawing.setAttribute("viewBox", `-0.5 -0.5 ${state.width} ${state.height}`);
    }
    if (state.width) this.size = [state.width, state.height];
    this.sequence = packet.sequence;
    this.draw(state.targets || []);
    return true;
  }

  // Something else is shown from here on: its pictures begin at their own numbers.
  forget(feed) {
    this.feed = feed;
    this.sequence = 0;
    this.size = null;
    this.trails.clear();
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.drawing.replaceChildren();
    this.whole();
  }

  draw(targets) {
    const parts = [];
    const ids = new Set(targets.map((target) => target.id));
    for (const id of this.trails.keys()) if (!ids.has(id)) this.trails.delete(id);
    for (const target of targets) {
      const trail = this.trails.get(target.id) || [];
      this.trails.set(target.id, trail);
      if (target.found && target.values.x) {
        trail.push([target.values.x[0], target.values.y[0]]);
        if (trail.length > TRAIL) trail.shift();
      }
      const color = colorOf(target.id);
      if (this.show.trail && trail.length > 1) parts.push(line("polyline", trail.flat(), color, 1.5, 0.7));
      if (target.found && this.show.outline) {
        parts.push(line("polygon", target.outline, "#000", 4, 0.45), line("polygon", target.outline, color, 2, 1));
      }
      if (target.found && this.show.matchSet && target.match_set) parts.push(dots(target.match_set));
    }
    if (this.rim) parts.push(circle(this.rim));
    this.drawing.replaceChildren(...parts);
  }

  toPicture(event) {
    const box = this.root.getBoundingClientRect();
    const x = (event.clientX - box.left - this.zoom.x) / this.zoom.scale;
    const y = (event.clientY - box.top - this.zoom.y) / this.zoom.scale;
    return [x / box.width * this.size[0] - 0.5, y / box.height * this.size[1] - 0.5];
  }

  press(event) {
    if (!this.size || event.button) return;
    this.root.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.begun = { at: [event.clientX, event.clientY], point: this.toPicture(event), sequence: this.sequence };
    if (this.pointers.size === 2) { this.begun = null; this.rim = null; }
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    if (this.pointers.size === 2) this.pinch(event.pointerId, before, now);
    this.pointers.set(event.pointerId, now);
    if (this.begun && distance(this.begun.at, now) > DRAG) {
      this.rim = [...this.begun.point, distance(this.begun.point, this.toPicture(event))];
    }
  }

  release(event) {
    if (!this.pointers.delete(event.pointerId) || !this.begun) return;
    const { point: [x, y], sequence } = this.begun;
    if (this.rim) this.onOutline({ sequence, x: this.rim[0], y: this.rim[1], radius: this.rim[2] });
    else this.onPick({ sequence, x, y });
    this.begun = this.rim = null;
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([number]) => number !== id)[1];
    this.zoomAt(other, distance(now, other) / Math.max(distance(before, other), 1));
  }

  wheel(event) {
    event.preventDefault();
    this.zoomAt([event.clientX, event.clientY], Math.exp(-event.deltaY / 400));
  }

  zoomAt([clientX, clientY], factor) {
    const box = this.root.getBoundingClientRect();
    const scale = Math.min(Math.max(this.zoom.scale * factor, 1), CLOSEST);
    const [x, y] = [clientX - box.left, clientY - box.top];
    const place = (offset, at, length) => Math.min(0, Math.max(length * (1 - scale), at - (at - offset) * scale / this.zoom.scale));
    this.zoom = { scale, x: place(this.zoom.x, x, box.width), y: place(this.zoom.y, y, box.height) };
    this.applyZoom();
  }

  whole() {
    this.zoom = { scale: 1, x: 0, y: 0 };
    this.applyZoom();
  }

  applyZoom() {
    const { scale, x, y } = this.zoom;
    for (const each of [this.canvas, this.drawing]) each.style.transform = `translate(${x}px, ${y}px) scale(${scale})`;
    this.canvas.style.imageRendering = scale > 3 ? "pixelated" : "";
  }
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

function line(kind, points, color, width, opacity) {
  const element = document.createElementNS(SVG, kind);
  element.setAttribute("points", points.join(" "));
  element.setAttribute("fill", "none");
  element.setAttribute("stroke", color);
  element.setAttribute("stroke-width", width);
  element.setAttribute("stroke-opacity", opacity);
  element.setAttribute("vector-effect", "non-scaling-stroke");
  return element;
}

function dots(points) {
  const path = document.createElementNS(SVG, "path");
  let data = "";
  for (let i = 0; i < points.length; i += 2) data += `M${points[i]} ${points[i + 1]}h0`;
  path.setAttribute("d", data);
  path.setAttribute("stroke", "#fff");
  path.setAttribute("stroke-width", 3);
  path.setAttribute("stroke-linecap", "round");
  path.setAttribute("vector-effect", "non-scaling-stroke");
  return path;
}

function circle([x, y, radius]) {
  const element = document.createElementNS(SVG, "circle");
  for (const [name, value] of Object.entries({ cx: x, cy: y, r: radius, fill: "none", stroke: "#fff", "stroke-width": 2, "stroke-dasharray": "6 4" })) {
    element.setAttribute(name, value);
  }
  element.setAttribute("vector-effect", "non-scaling-stroke");
  return element;
}
