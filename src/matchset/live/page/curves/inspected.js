// A curve that shows its values under the pointer, or under a line that the arrow keys move, and that can be enlarged.

import { palette } from "../canvas.js";
import { element } from "../reading/reading.js";
import { measured } from "../units.js";

const STEP = 1 / 100; // of the width, for an arrow key; with Shift ten times as much

export class Inspected {
  // `redraw()` draws the curve again; `go()`, if there is one, is what Enter does at the line. Without values
  // (`valued` false) the picture can only be enlarged.
  constructor(canvas, redraw, { go = null, valued = true } = {}) {
    Object.assign(this, { canvas, redraw, go, share: null });
    const here = canvas.parentElement?.classList.contains("curve") ? canvas.parentElement : null;
    this.figure = here || element("figure", "curve");
    if (!here) { canvas.replaceWith(this.figure); this.figure.append(canvas, element("output", "value"), element("button", "enlarge", "⤢")); }
    this.output = this.figure.querySelector("output");
    this.button = this.figure.querySelector("button");
    this.button.type = "button";
    this.button.addEventListener("click", () => this.enlarge(!this.large));
    this.figure.addEventListener("keydown", (event) => { if (event.key === "Escape" && this.large) { this.enlarge(false); event.preventDefault(); } });
    this.enlarge(false);
    if (!valued) return;
    canvas.tabIndex = 0;
    canvas.addEventListener("pointermove", (event) => this.moveTo((event.clientX - canvas.getBoundingClientRect().left) / Math.max(canvas.clientWidth, 1)));
    canvas.addEventListener("pointerleave", () => this.moveTo(null));
    canvas.addEventListener("blur", () => this.moveTo(null));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  enlarge(large) {
    this.large = large;
    this.figure.classList.toggle("large", large);
    this.button.textContent = large ? "×" : "⤢";
    this.button.setAttribute("aria-label", large ? "as small as before" : "enlarge");
    this.button.title = large ? "as small as before (Escape)" : "enlarge";
    this.button.setAttribute("aria-expanded", String(large));
  }

  moveTo(share) {
    this.share = share;
    if (share === null) this.say("");
    this.redraw();
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key];
    if (step) this.moveTo(Math.min(Math.max((this.share ?? 1) + step * (event.shiftKey ? 10 : 1), 0), 1));
    else if (event.key === "Enter" && this.go && this.share !== null) this.go(this.share);
    else if (event.key === "Escape" && this.share !== null && !this.large) this.moveTo(null);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // Where the line is on a canvas that is so wide, px; null: there is none.
  at(width) {
    return this.share === null ? null : this.share * width;
  }

  say(words) {
    if (this.output.textContent !== words) this.output.textContent = words;
  }

  // Draws the line at x, with a dot on the curve where it is known, and says the value there.
  mark(context, frame, ratio, { x, y, value, sigma, name, unit, when }) {
    context.fillStyle = palette.ink;
    context.globalAlpha = 0.6;
    context.fillRect(Math.round(x - ratio / 2), frame.top, ratio, frame.bottom - frame.top);
    context.globalAlpha = 1;
    if (value === null) { this.say(`${when}: not found`); return; }
    context.beginPath();
    context.arc(x, y, 4 * ratio, 0, 2 * Math.PI);
    context.fill();
    const [number, spread] = measured(value, sigma);
    this.say(`${when}: ${name} ${number}${spread ? ` ${spread}` : ""}${unit ? ` ${unit}` : ""}`);
  }
}
