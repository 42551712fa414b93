// A picture with vector drawings on top. Clicks mean the picture that was on the screen when the finger came down.

import { colorOf } from "../colors.js";
import { Clicks } from "./clicks.js";
import { drawCross, drawDoubtful, drawTarget, drawTrace, drawTrail, spread } from "./drawing.js";
import { Gestures } from "./gestures.js";
import { Zoom } from "./zoom.js";

const TRAIL = 3; // s
const POINTS = 120; // of a drawn line that is sent
const CROSS = 18; // CSS px, half the size of the cross of the keys
const MASK_WAIT = 1000; // ms; a mask that takes longer is left out

export class PictureView {
  // onPick and onOutline get what was done in the picture `sequence`, and answer whether it was sent; onHold gets that of
  // a picture in which a line is begun, onSelect the number of a target that was clicked.
  constructor(root, { onPick, onOutline, onHold = () => {}, onSelect = () => {} }) {
    this.root = root;
    [this.canvas, this.maskCanvas] = root.querySelectorAll("canvas");
    this.drawing = root.querySelector("#drawing");
    this.doubts = root.querySelector("#doubtful");
    this.doubtful = [];
    this.clicks = new Clicks(...["#clicks", "#hint", "#said"].map((name) => root.querySelector(name)));
    this.context = this.canvas.getContext("2d");
    this.show = { outline: true, matchSet: false, trail: true, marker: true, axes: true, name: true };
    this.trails = new Map();
    this.targets = [];
    this.chosen = null;
    this.wantsMask = false;
    this.maskOf = null; // number of the target whose mask is on the screen
    this.sequence = 0;
    this.arrived = this.shown = 0;
    this.stream = 0;
    this.cross = this.line = null;
    Object.assign(this, { onPick, onOutline, onHold, onSelect });
    this.next = null; // a picture that came while another one stands still under a finger
    const layers = [this.canvas, this.maskCanvas, this.drawing, this.doubts, this.clicks.drawing].filter(Boolean);
    this.zoom = new Zoom(root, layers, (scale) => { this.redraw(); if (this.onZoom) this.onZoom(scale); });
    this.gestures = new Gestures(root, this);
  }

  // Answers whether it was painted: a newer picture may be there already.
  async paint(packet) {
    const { state } = packet;
    if (packet.feed !== this.feed) this.forget(packet.feed);
    if (this.gestures.holds) { this.next = packet; return true; }
    const turn = ++this.arrived; // decoding takes longer for some than for others
    if (packet.jpeg) {
      const masked = this.targetOfMask(state.targets || []);
      const [bitmap, mask] = await Promise.all([createImageBitmap(packet.jpeg), this.fetchMask(packet.sequence, masked)]);
      if (packet.feed !== this.feed || turn < this.shown) { bitmap.close(); return false; }
      if (this.gestures.holds) { bitmap.close(); this.next = packet; return true; } // pressed while it was decoded
      paintOn(this.canvas, this.context, bitmap);
      this.paintMask(mask, masked);
      this.fit(state.width, state.height);
    }
    this.shown = turn;
    this.sequence = packet.sequence;
    this.targets = state.targets || [];
    this.doubtful = state.crowd?.doubtful || [];
    this.note(state.time, state.stretch || 0);
    this.redraw();
    return true;
  }

  // Something else is shown from here on: its pictures begin at their own numbers.
  forget(feed) {
    this.feed = feed;
    this.gestures.begun = null;
    this.sequence = 0;
    this.size = this.take = this.cross = this.line = null;
    this.next = null;
    this.targets = [];
    this.doubtful = [];
    this.trails.clear();
    this.context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.paintMask(null);
    this.drawing.replaceChildren();
    this.doubts?.replaceChildren();
    this.clicks.forget();
    this.zoom.whole();
  }

  // The finger is up: the newest picture follows.
  goOn() {
    const { next } = this;
    this.next = null;
    if (next) this.paint(next);
  }

  fit(width, height) {
    if (this.size && this.size[0] === width && this.size[1] === height) return;
    this.size = [width, height];
    this.root.style.aspectRatio = `${width} / ${height}`;
    this.root.style.setProperty("--aspect", width / height);
    for (const each of [this.drawing, this.doubts, this.clicks.drawing].filter(Boolean)) each.setAttribute("viewBox", `-0.5 -0.5 ${width} ${height}`);
  }

  // The target that the reading shows, if it is in the picture; else the newest.
  targetOfMask(targets) {
    if (!this.wantsMask || !targets.length) return null;
    return (targets.find((target) => target.id === this.chosen) || targets[targets.length - 1]).id;
  }

  // The mask was switched on or off, or another target was chosen: a picture that stands gets it without a new one.
  async remask() {
    if (this.remasking) return;
    const [sequence, masked] = [this.sequence, this.targetOfMask(this.targets)];
    this.remasking = true;
    const mask = await this.fetchMask(sequence, masked);
    this.remasking = false;
    if (sequence === this.sequence && masked === this.targetOfMask(this.targets)) this.paintMask(mask, masked); else mask?.close();
  }

  // The mask of just this picture; pictures wait for it, so that both are of the same moment.
  async fetchMask(sequence, masked) {
    if (masked === null || !this.maskCanvas) return null;
    try {
      const query = `stream=${this.stream}&target=${masked}&sequence=${sequence}`;
      const answer = await fetch(`mask.png?${query}`, { signal: AbortSignal.timeout(MASK_WAIT) });
      return answer.ok ? await createImageBitmap(await answer.blob()) : null;
    } catch { return null; } // a slow link, or none: the picture is shown without
  }

  paintMask(bitmap, masked = null) {
    if (!this.maskCanvas) return;
    this.maskOf = bitmap ? masked : null;
    this.maskCanvas.hidden = !bitmap;
    if (!bitmap) return;
    const context = this.maskCanvas.getContext("2d");
    paintOn(this.maskCanvas, context, bitmap);
    context.globalCompositeOperation = "multiply"; // white becomes the target's color, the rest stays black
    context.fillStyle = colorOf(masked || 1);
    context.fillRect(0, 0, this.maskCanvas.width, this.maskCanvas.height);
    context.globalCompositeOperation = "source-over";
  }

  note(time, stretch) {
    const apart = stretch !== this.stretch; // somebody has gone to another frame of a video
    this.stretch = stretch;
    const ids = new Set(this.targets.map((target) => target.id));
    for (const id of this.trails.keys()) if (!ids.has(id)) this.trails.delete(id);
    for (const target of this.targets) {
      const trail = this.trails.get(target.id) || [];
      const last = trail.length ? trail[trail.length - 1][0] : time;
      if (apart || time < last || time > last + TRAIL) trail.length = 0; // the video went back, or jumped
      if (target.pending) continue;
      if (target.found) trail.push([time, target.values.x[0], target.values.y[0]]); else trail.push([time, null, null]);
      while (trail.length && trail[0][0] < time - TRAIL) trail.shift();
      this.trails.set(target.id, trail);
    }
  }

  redraw() {
    if (!this.size) return;
    const parts = [];
    for (const target of this.targets) {
      const color = colorOf(target.id);
      if (this.show.trail) parts.push(drawTrail(this.trails.get(target.id) || [], color));
      parts.push(...drawTarget(target, color, this.show, target.id === this.chosen, this.targets.length > 1 ? this.size[0] : 0));
    }
    if (this.wantsMask && this.maskOf !== null && this.maskOf !== this.targetOfMask(this.targets)) this.remask();
    if (this.line) parts.push(...drawTrace(this.line));
    const pixel = this.size[0] / Math.max(this.root.clientWidth, 1) / this.zoom.scale; // picture px in a CSS px
    for (const each of [this.drawing, this.doubts].filter(Boolean)) each.style.setProperty("--pixel", `${pixel}px`);
    this.doubts?.replaceChildren(...(this.show.outline ? this.doubtful.map(drawDoubtful) : []));
    this.clicks.resize(pixel);
    spread(parts.filter((part) => part.classList.contains("target-name")), pixel);
    if (this.cross) parts.push(...drawCross(this.cross, CROSS * pixel));
    this.drawing.replaceChildren(...parts);
  }

  // A click on what is followed selects it; any other begins something.
  click([x, y], sequence) {
    const target = this.targets.find((each) => each.found && inside(each.outline, x, y));
    if (this.take) this.take({ sequence, x, y }); // somebody waits for a point: a marker
    else if (target) this.onSelect(target.id);
    else this.begin(this.onPick, sequence, round(x), round(y), {});
  }

  lineBegins(sequence) {
    this.onHold({ sequence });
  }

  trace(points, sequence) {
    const every = Math.max(1, Math.ceil(points.length / POINTS));
    const kept = points.filter((_, index) => index % every === 0);
    const flat = kept.flat().map(round);
    if (kept.length > 2) this.begin(this.onOutline, sequence, flat[0], flat[1], { points: flat });
  }

  // Tells the server of a click; where it was shows it at once.
  begin(tell, sequence, x, y, line) {
    const click = this.clicks.next();
    this.clicks.begin(click, x, y, tell(line.points ? { sequence, click, ...line } : { sequence, click, x, y }));
  }
}

const round = (value) => Math.round(value * 10) / 10;

function paintOn(canvas, context, bitmap) {
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
  }
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
}

// Whether a point lies inside of a polygon (x0, y0, x1, y1, ...): rays to the right cross it an odd number of times.
export function inside(polygon, x, y) {
  let odd = false;
  for (let i = 0, j = polygon.length - 2; i < polygon.length; j = i, i += 2) {
    const [ax, ay, bx, by] = [polygon[i], polygon[i + 1], polygon[j], polygon[j + 1]];
    if ((ay > y) !== (by > y) && x < (bx - ax) * (y - ay) / (by - ay) + ax) odd = !odd;
  }
  return odd;
}
