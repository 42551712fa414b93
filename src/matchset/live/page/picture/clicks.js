// Where somebody has clicked: a ring that pulses from the click on until the server says what became of it, and, where
// nothing is followed, a cross and the words why. They stay until the next click.

import { element } from "../reading/reading.js";

const RING = 20; // CSS px, radius
const CROSS = 9; // CSS px, half the size of the cross of a click that was refused
const MOST = 4; // rings at a time; the server tries no more clicks, older ones were given up
const SVG = "http://www.w3.org/2000/svg";

export class Clicks {
  // `drawing` is an SVG in pixels of the picture, `hint` and `said` are places for words.
  constructor(drawing, hint, said) {
    Object.assign(this, { drawing, hint, said, waiting: [], refused: null, asked: "", some: false });
    this.words = element("span", "");
    const close = element("button", "", "×");
    close.type = "button";
    close.setAttribute("aria-label", "close");
    close.addEventListener("pointerdown", (event) => event.stopPropagation()); // no click in the picture
    close.addEventListener("click", () => { this.refused = null; this.show(); });
    said.replaceChildren(this.words, close);
    this.show();
  }

  // The number of the next click: of this page alone, so that no answer to another one is taken for its own.
  next() {
    this.last = (this.last ?? Math.floor(Math.random() * 2 ** 30)) + 1;
    return this.last;
  }

  // A click of this number, or the first point of a drawn line; sent: whether the server can hear of it.
  begin(click, x, y, sent) {
    this.refused = null;
    if (sent) this.waiting = [...this.waiting, { click, x, y, ring: this.makeRing(x, y) }].slice(-MOST);
    else this.refused = { x, y, words: "no connection: click again when it is back" };
    this.show();
  }

  // What the server says of the last clicks.
  answered(answers) {
    for (const { click, x, y, words } of answers || []) {
      const index = this.waiting.findIndex((each) => each.click === click);
      if (index < 0) continue;
      this.waiting.splice(index, 1);
      if (words) this.refused = { x, y, words };
    }
    this.show();
  }

  // Other pictures: what was clicked in the ones before is over.
  forget() {
    this.waiting = [];
    this.refused = null;
    this.show();
  }

  // Whether something is followed: then nobody needs to be told what to do.
  follows(some) {
    if (some === this.some) return;
    this.some = some;
    this.show();
  }

  // The next click is for somebody who asked for a point; empty: it is for a ball again.
  ask(words) {
    this.asked = words;
    this.show();
  }

  show() {
    const words = this.asked || (this.waiting.length ? "finding it …" : this.some || this.refused ? "" : "Click the ball.");
    if (this.hint.textContent !== words) this.hint.textContent = words;
    this.hint.hidden = !words;
    this.said.hidden = !this.refused;
    if (this.words.textContent !== (this.refused?.words || "")) this.words.textContent = this.refused?.words || "";
    const marks = this.waiting.map((each) => each.ring);
    if (this.refused) marks.push(this.makeCross(this.refused));
    if (marks.length !== this.drawing.childElementCount || marks.some((mark, at) => mark !== this.drawing.children[at])) {
      this.drawing.replaceChildren(...marks); // a ring that stays goes on pulsing
    }
  }

  // `pixel`: of the picture in a CSS px.
  resize(pixel) {
    if (pixel === this.pixel) return;
    this.pixel = pixel;
    for (const { ring } of this.waiting) for (const circle of ring.children) circle.setAttribute("r", RING * pixel);
    if (this.refused) this.show();
  }

  makeRing(x, y) {
    const ring = made("g", { class: "ring" });
    for (const name of ["back", "front"]) ring.append(made("circle", { cx: x, cy: y, r: RING * (this.pixel || 1), class: name }));
    return ring;
  }

  makeCross({ x, y }) {
    const arm = CROSS * (this.pixel || 1);
    const data = `M${x - arm} ${y - arm}l${2 * arm} ${2 * arm}M${x - arm} ${y + arm}l${2 * arm} ${-2 * arm}`;
    const cross = made("g", { class: "refused" });
    for (const name of ["back", "front"]) cross.append(made("path", { d: data, class: name }));
    return cross;
  }
}

function made(kind, attributes) {
  const shape = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) shape.setAttribute(name, value);
  return shape;
}
