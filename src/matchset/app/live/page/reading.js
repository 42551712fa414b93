// The reading of the chosen target, large enough for two meters away.

import { measured } from "./units.js";

const UNITS = { distance: "m", x: "m", y: "m", z: "m" };
const PIXELS = { angle: "rad", scale: "" };

export function showReading(root, target) {
  if (!target) { root.replaceChildren(); return; }
  if (!target.found) {
    const lost = element("p", "lost", `Lost: ${target.reason}`);
    const since = target.lost_for ? element("p", "", `for ${target.lost_for.toFixed(1)} s`) : "";
    root.replaceChildren(lost, since);
    return;
  }
  const placed = target.position && target.position.distance;
  const values = placed ? target.position : target.values;
  const names = placed ? ["distance", "x", "y", "z"] : Object.keys(values);
  root.replaceChildren(...names.map((name, index) => number(name, values[name], placed ? UNITS[name] : PIXELS[name] ?? "px", !index && placed)));
}

function number(name, [value, sigma], unit, first) {
  const row = element("div", first ? "number first" : "number");
  row.dataset.name = name;
  const [words, spread] = measured(value, sigma);
  const figure = element("span", "", words);
  figure.append(" ", element("span", "sigma", `${spread} ${unit}`.trim()));
  row.append(element("span", "", first ? "" : name), figure);
  return row;
}

export function element(kind, classes, text = "") {
  const made = document.createElement(kind);
  if (classes) made.className = classes;
  made.textContent = text;
  return made;
}
