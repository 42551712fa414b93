// The reading of the chosen target, large enough for two meters away. The rows stay while their names do, so that
// nothing jumps and the page has little to lay out.

import { colorOf } from "../colors.js";
import { aligned, measured } from "../units.js";

const PIXELS = { angle: "rad", scale: "" }; // units of shapes' parameters that are no lengths

export class Reading {
  constructor(root) {
    this.root = root;
    this.kind = null;
  }

  // `all`: the targets that there are.
  show(target, all) {
    const kind = target ? kindOf(target) : "";
    if (kind !== this.kind) this.build(target, kind);
    if (!target) return;
    this.dot.style.background = colorOf(target.id);
    this.head.hidden = all.length < 2;
    const others = (target.alternatives || []).map((id) => all.find((each) => each.id === id)?.name).filter(Boolean);
    set(this.name, others.length ? `${target.name}, or ${others.join(" or ")}` : target.name);
    if (target.found) this.showNumbers(valuesOf(target)); else if (target.pending) set(this.since, target.reason); else {
      set(this.words, target.reason);
      set(this.since, target.lost_for ? `for ${target.lost_for.toFixed(1)} s` : "not found yet");
    }
  }

  showNumbers(values) {
    const words = new Map([...this.rows.keys()].map((name) => [name, measured(...values[name])]));
    const below = [...words].filter(([name]) => name !== "distance").map(([, [number]]) => (number.split(".")[1] || "").length);
    const decimals = Math.max(0, ...below);
    for (const [name, { value, sigma }] of this.rows) {
      const [number, spread] = words.get(name);
      set(value, name === "distance" ? number : aligned(number, decimals));
      set(sigma, name === "distance" ? spread : aligned(spread, decimals));
    }
  }

  build(target, kind) {
    this.kind = kind;
    this.rows = new Map();
    if (!target) { this.root.replaceChildren(); return; }
    this.head = element("p", "head");
    this.dot = element("span", "dot");
    this.name = element("span", "");
    this.head.append(this.dot, this.name);
    this.root.replaceChildren(this.head);
    if (!target.found) {
      const lost = element("p", target.pending ? "pending" : "lost", target.pending ? "" : "Lost ");
      this.since = element("span", "since");
      this.words = element("p", "why");
      lost.append(this.since);
      this.root.append(lost, this.words);
      return;
    }
    const placed = isPlaced(target);
    for (const name of Object.keys(valuesOf(target))) {
      const row = element("div", name === "distance" ? "number first" : "number");
      row.dataset.name = name;
      const figure = element("span", "figure");
      const parts = { value: element("span", "value"), sigma: element("span", "sigma") };
      figure.append(parts.value, " ", parts.sigma, " ", element("span", "unit", placed ? "m" : PIXELS[name] ?? "px"));
      row.append(element("span", "name", NAMES[name] ?? name), figure);
      this.rows.set(name, parts);
      this.root.append(row);
    }
    if (placed && target.left_out) this.root.append(element("p", "left-out", target.left_out));
  }
}

const NAMES = { radius: "r" };

const isPlaced = (target) => Boolean(target.position && target.position.distance);

function valuesOf(target) {
  if (!isPlaced(target)) return target.values;
  const { distance, x, y, z } = target.position;
  return { distance, x, y, z };
}

const kindOf = (target) => {
  if (!target.found) return target.pending ? "pending" : "lost";
  return Object.keys(valuesOf(target)).join() + isPlaced(target) + (target.left_out ?? "");
};

function set(node, words) {
  if (node.textContent !== words) node.textContent = words;
}

export function element(kind, classes, text = "") {
  const made = document.createElement(kind);
  if (classes) made.className = classes;
  made.textContent = text;
  return made;
}
