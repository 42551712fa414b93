// One line for each target, in its color: where it was first seen, where it was found and lost, and where it ended.

import { colorOf } from "../colors.js";
import { shortened } from "../units.js";
import { SECONDS } from "./samples.js";

const SVG = "http://www.w3.org/2000/svg";
const HIGH = 16; // CSS px, of a line
const ASIDE = 12; // CSS px, of a name from where its line begins
const LETTER = 6.6; // CSS px, about
const MARK = 6; // CSS px, that a mark stays inside of the ends
const GAP = 0.5; // s without a picture, after which a stretch begins anew
const EVERY = 200; // ms between two drawings

// `choose(id)` is told of a target whose line was clicked, `go(share)` where.
export class LifeLines {
  constructor(root, choose, go = () => {}) {
    Object.assign(this, { root, choose, go, shown: "" });
    root.setAttribute("role", "group");
    new ResizeObserver(() => { this.shown = ""; if (this.last) this.show(...this.last); }).observe(root);
  }

  // Each line: { id, name, runs: [{ from, to, found }], marks: [{ at, kind, words }] }, all in shares of the width, 0 ... 1.
  show(lines, chosen) {
    this.last = [lines, chosen];
    this.root.parentElement.hidden = !lines.length;
    const width = this.root.clientWidth;
    const key = JSON.stringify([lines, chosen, width]);
    if (key === this.shown || !width) return;
    this.shown = key;
    this.root.setAttribute("height", HIGH * lines.length);
    this.root.replaceChildren(...lines.map((line, index) => this.makeLine(line, index, width, line.id === chosen)));
  }

  makeLine({ id, name, runs, marks }, index, width, chosen) {
    const [color, middle] = [colorOf(id), (index + 0.5) * HIGH];
    const x = (share) => share * width;
    const group = made("g", { class: chosen ? "life chosen" : "life", "data-id": id });
    group.append(made("rect", { x: 0, y: index * HIGH, width, height: HIGH, class: "ground" }));
    for (const { from, to, found } of runs) {
      const line = { x1: x(from), x2: Math.max(x(to), x(from) + 1.5), y1: middle, y2: middle, stroke: color };
      if (found) group.append(made("line", { ...line, class: "edge" }));
      group.append(made("line", { ...line, class: found ? "found" : "lost" }));
    }
    for (const { at: share, kind, words: said } of marks) {
      const at = Math.min(Math.max(x(share), MARK), width - MARK);
      const mark = made("g", { class: `mark ${kind}`, "data-kind": kind });
      if (kind === "born") mark.append(made("circle", { cx: at, cy: middle, r: 5, fill: color }));
      else mark.append(...["under", "over"].map((part) => made("path", { d: crossAt(at, middle), stroke: color, class: part })));
      mark.append(made("title", {}, `${name}: ${said}`));
      group.append(mark);
    }
    const begin = Math.min(...runs.map((run) => run.from), ...marks.map((mark) => mark.at), 1);
    group.append(...nameAt(shortened(name), Math.max(x(begin), MARK), middle, width));
    group.addEventListener("click", (event) => {
      this.choose(id);
      this.go(Math.min(Math.max((event.clientX - this.root.getBoundingClientRect().left) / width, 0), 1));
    });
    return group;
  }
}

// The last 30 s before a camera, from what each picture says.
export class Lives {
  constructor(lines) {
    this.lines = lines;
    this.lives = new Map();
    this.drawn = 0;
  }

  clear() {
    this.lives.clear();
  }

  note(targets, time) {
    for (const life of this.lives.values()) life.there = false;
    for (const { id, name = "", found, since, pending } of targets) {
      if (pending) continue;
      const life = this.lives.get(id) || { id, since: since ?? time, runs: [] };
      this.lives.set(id, life);
      Object.assign(life, { name, there: true, last: time });
      life.since = since ?? life.since;
      const run = life.runs[life.runs.length - 1];
      if (run && run.found === found && time - run.to < GAP) run.to = time;
      else life.runs.push({ from: run && time - run.to < GAP ? run.to : time, to: time, found });
      while (life.runs[0].to < time - SECONDS) life.runs.shift();
    }
    for (const [id, life] of this.lives) if (life.last < time - SECONDS) this.lives.delete(id);
    this.time = time;
  }

  draw(chosen) {
    const now = performance.now();
    if (now - this.drawn < EVERY) return;
    this.drawn = now;
    const share = (time) => Math.max(1 - (this.time - time) / SECONDS, 0);
    const lines = [...this.lives.values()].map((life) => {
      const runs = life.runs.map(({ from, to, found }) => ({ from: share(from), to: share(to), found }));
      return { id: life.id, name: life.name, runs, marks: marksOf(life, this.time, share) };
    });
    this.lines.show(lines, chosen);
  }
}

function marksOf(life, now, share) {
  const marks = [];
  const ago = (time) => `${(now - time).toFixed(1)} s ago`;
  if (now - life.since < SECONDS) marks.push({ at: share(life.since), kind: "born", words: `first seen ${ago(life.since)}` });
  const last = life.runs[life.runs.length - 1];
  if (!life.there) marks.push({ at: share(last.found ? last.to : last.from), kind: "ended", words: `followed no more since ${ago(last.to)}` });
  else if (!last.found && now - last.from < SECONDS) marks.push({ at: share(last.from), kind: "lost", words: `lost ${ago(last.from)}` });
  return marks;
}

// The same over a whole video, from what the server says of each target: codes with how many columns each holds.
export function lifeOfVideo({ id, name, line, first, last, known }, end) {
  const share = (index) => (index + 0.5) / (end + 1);
  const count = (line || []).reduce((sum, value, at) => (at % 2 ? sum + value : sum), 0);
  const runs = [];
  let at = 0;
  for (let i = 0; i < (line || []).length; i += 2) {
    const from = at;
    at += line[i + 1];
    if (line[i]) runs.push({ from: from / count, to: at / count, found: line[i] === 1 });
  }
  const marks = [];
  if (first !== undefined) marks.push({ at: share(first), kind: "born", words: `first seen in frame ${first}` });
  if (last !== undefined && last < known) marks.push({ at: share(last), kind: "lost", words: `seen last in frame ${last}` });
  return { id, name, runs, marks };
}

// On its line, where that begins; before it where there is no room.
function nameAt(name, begin, middle, width) {
  const fits = begin + ASIDE + LETTER * name.length < width;
  const [at, wide] = [fits ? begin + ASIDE : begin - ASIDE, LETTER * name.length];
  return [
    made("rect", { x: fits ? at - 3 : at - wide, y: middle - HIGH / 2, width: wide, height: HIGH, class: "behind" }),
    made("text", { x: at, y: middle, "text-anchor": fits ? "start" : "end", class: "of" }, name),
  ];
}

const crossAt = (x, y) => `M${x - 4} ${y - 4}l8 8M${x - 4} ${y + 4}l8 -8`;

function made(kind, attributes, text = "") {
  const shape = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) shape.setAttribute(name, value);
  if (text) shape.textContent = text;
  return shape;
}
