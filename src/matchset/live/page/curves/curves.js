// The curves of the chosen target, x, y, z where it is placed and otherwise x, y, r; and all targets from above. What was
// seen of each target is kept for 30 s, so that choosing another one shows its past.

import { colorOf } from "../colors.js";
import { ViewFromAbove } from "./above.js";
import { Curve } from "./curve.js";
import { NAMES, UNITS } from "./grid.js";
import { LifeLines, Lives } from "./lives.js";
import { Samples } from "./samples.js";

const PARAMETERS = 3; // curves

export class Curves {
  // `choose(id)` is told of a target whose line was clicked.
  constructor(root, choose = () => {}) {
    this.root = root;
    this.words = root.querySelector("p");
    const canvases = [...root.querySelectorAll("canvas")];
    this.above = new ViewFromAbove(canvases.pop());
    this.curves = canvases.map((canvas) => new Curve(canvas));
    this.pasts = new Map();
    this.lives = new Lives(new LifeLines(root.querySelector("#lives"), choose));
  }

  clear() {
    this.pasts.clear();
    this.lives.clear();
    this.above.forget(() => false);
  }

  note(targets, time) {
    this.lives.note(targets, time);
    const there = new Set(targets.map((target) => target.id));
    for (const id of this.pasts.keys()) if (!there.has(id)) this.pasts.delete(id);
    this.above.forget((id) => there.has(id));
    for (const target of targets) {
      if (target.pending) continue;
      const past = this.pastOf(target);
      const values = valuesOf(target);
      past.names.forEach((name, index) => {
        const [value, sigma] = values[name] || [NaN, 0];
        past.samples[index].add(time, value, sigma ?? 0);
      });
      if (isPlaced(target)) this.above.add(target.id, time, target.position.x[0], target.position.z[0]);
    }
  }

  // Begins anew where other numbers come: meters instead of pixels.
  pastOf(target) {
    const past = this.pasts.get(target.id);
    const placed = isPlaced(target);
    if (past && (!target.found || past.placed === placed)) return past;
    const names = Object.keys(valuesOf(target)).slice(0, PARAMETERS);
    const made = { names, placed, samples: names.map(() => new Samples()) };
    this.pasts.set(target.id, made);
    return made;
  }

  draw(chosen) {
    const past = this.pasts.get(chosen);
    const some = Boolean(past && past.names.length);
    const flat = !this.above.paths.size;
    if (this.words.hidden !== some) this.words.hidden = some;
    if (this.above.surface.canvas.hidden !== flat) this.above.surface.canvas.hidden = flat;
    this.curves.forEach((curve, index) => {
      const there = some && index < past.names.length;
      if (curve.surface.canvas.hidden === there) curve.surface.canvas.hidden = !there;
      const name = there ? past.names[index] : "";
      if (there) curve.draw(past.samples[index], NAMES[name] ?? name, past.placed ? "m" : UNITS[name] ?? "px", colorOf(chosen));
    });
    if (!flat) this.above.draw();
    this.lives.draw(chosen);
  }
}

const isPlaced = (target) => Boolean(target.found && target.position && target.position.distance);

function valuesOf(target) {
  if (!isPlaced(target)) return target.values || {};
  const { x, y, z } = target.position;
  return { x, y, z };
}
