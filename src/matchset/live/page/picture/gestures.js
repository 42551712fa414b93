// What fingers, mouse and keys do on a picture. One finger or the left button: a press is a click, a drag draws along a
// rim, or moves a picture that is zoomed; while it is down the picture stands still, so that what is meant is what is seen. Two fingers, or the wheel: zoom; the middle button, or Shift: move.

const DRAG = 6; // CSS px, below which a press is a click
const SPACING = 3; // CSS px between points of a drawn line
const WHEEL = 400; // px of the wheel for a factor e
const STEP = 1 / 60; // of the picture's width, for an arrow key; with Shift a pixel

export class Gestures {
  // `view` has zoom, size, sequence, and is told: click(point, sequence), lineBegins(sequence) when a drag begins to draw,
  // trace(points, sequence), line, cross; goOn() when a picture that stood still need not any more.
  constructor(root, view) {
    this.root = root;
    this.view = view;
    this.pointers = new Map();
    this.moves = false; // a drag moves the picture
    for (const [name, listen] of Object.entries({
      pointerdown: this.press, pointermove: this.move, pointerup: this.release, pointercancel: this.cancel,
      keydown: this.key, focus: this.focus, blur: this.blur,
    })) root.addEventListener(name, listen.bind(this));
    root.addEventListener("wheel", this.wheel.bind(this), { passive: false });
    root.addEventListener("auxclick", (event) => event.preventDefault());
  }

  // Whether the picture must stand still.
  get holds() {
    return Boolean(this.begun && !this.begun.panning);
  }

  press(event) {
    this.byPointer = true;
    this.view.cross = null;
    if (!this.view.size || event.button > 1) return;
    if (event.button === 1) event.preventDefault();
    const at = [event.clientX, event.clientY];
    try { this.root.setPointerCapture(event.pointerId); } catch { /* a pointer that is gone already */ }
    this.pointers.set(event.pointerId, at);
    this.begun = { at, sequence: this.view.sequence, points: [this.toPicture(at)], panning: event.button === 1 || event.shiftKey || this.moves };
    if (this.pointers.size > 1) this.forget();
  }

  forget() {
    this.begun = null;
    this.view.line = null;
    this.view.redraw();
    this.view.goOn();
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    this.pointers.set(event.pointerId, now);
    if (this.pointers.size === 2) { this.pinch(event.pointerId, before, now); return; }
    const { begun } = this;
    if (!begun || (!begun.dragged && distance(begun.at, now) < DRAG)) return;
    if (!begun.dragged && !begun.panning) this.view.lineBegins(begun.sequence);
    begun.dragged = true;
    if (begun.panning) { this.view.zoom.pan(now[0] - before[0], now[1] - before[1]); return; }
    if (distance(begun.last || begun.at, now) < SPACING) return;
    begun.last = now;
    begun.points.push(this.toPicture(now));
    this.view.line = begun.points;
    this.view.redraw();
  }

  release(event) {
    if (!this.pointers.delete(event.pointerId) || !this.begun) return;
    const { begun } = this;
    this.forget();
    if (!begun.dragged) this.view.click(begun.points[0], begun.sequence);
    else if (!begun.panning) this.view.trace(begun.points, begun.sequence);
  }

  cancel(event) {
    this.pointers.delete(event.pointerId);
    this.forget();
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([number]) => number !== id)[1];
    this.view.zoom.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    this.view.zoom.about(middle, distance(now, other) / Math.max(distance(before, other), 1));
  }

  wheel(event) {
    event.preventDefault();
    const pixels = event.deltaMode ? 30 * event.deltaY : event.deltaY;
    this.view.zoom.about([event.clientX, event.clientY], Math.exp(-pixels / WHEEL));
  }

  // Who comes here by the Tab key gets a cross; after a click the arrow keys belong to others (a video's frames).
  focus() {
    if (!this.byPointer && this.view.size) this.view.cross = this.view.cross || this.view.size.map((length) => (length - 1) / 2);
    this.byPointer = false;
    this.view.redraw();
  }

  blur() {
    this.view.cross = null;
    this.byPointer = false;
    this.view.redraw();
  }

  key(event) {
    if (event.target !== this.root || event.ctrlKey || event.altKey || event.metaKey) return;
    const { zoom, size, cross } = this.view;
    const zoomed = { "+": 1.25, "=": 1.25, "-": 0.8 }[event.key];
    const [right, down] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] || [0, 0];
    if (zoomed) zoom.step(zoomed);
    else if (event.key === "0") zoom.whole();
    else if (event.key === "Enter" && size) {
      if (cross) this.view.click(cross, this.view.sequence); else this.view.cross = size.map((length) => (length - 1) / 2);
    } else if ((right || down) && cross) {
      const step = event.shiftKey ? 1 : Math.max(1, Math.round(STEP * size[0]));
      this.view.cross = [clamp(cross[0] + right * step, size[0] - 1), clamp(cross[1] + down * step, size[1] - 1)];
    } else if (event.key === "Escape" && (cross || this.begun)) { this.view.cross = null; this.forget(); } else return;
    event.preventDefault();
    event.stopPropagation();
    this.view.redraw();
  }

  toPicture(at) {
    return this.view.zoom.toPicture(at, this.view.size);
  }
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const clamp = (value, most) => Math.min(Math.max(value, 0), most);
