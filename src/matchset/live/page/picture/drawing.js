// What is drawn over the picture, as SVG in pixels of the picture: sharp at any zoom.

import { palette } from "../canvas.js";
import { shortened } from "../units.js";

const SVG = "http://www.w3.org/2000/svg";
const AXES = ["#ff6b6b", "#69db7c", "#74a9ff"]; // x, y, z, as everywhere in matchset
const NAMES = ["x", "y", "z"];
const [HIGH, LETTER] = [16, 8.6]; // CSS px, about, of a name

// `width`: of the picture, where it is drawn with its name, since there are several.
export function drawTarget(target, color, show, chosen, width = 0) {
  const parts = [];
  if (target.found && show.outline) {
    parts.push(shape("polygon", target.outline, { stroke: "#000", "stroke-width": chosen ? 5 : 4, "stroke-opacity": 0.55 }));
    parts.push(shape("polygon", target.outline, { stroke: color, "stroke-width": chosen ? 2.5 : 1.5, class: "outline" }));
  }
  if (!target.found && show.outline && target.predicted) {
    parts.push(shape("polygon", target.predicted, { stroke: "#000", "stroke-width": 3.5, "stroke-opacity": 0.45 }));
    parts.push(shape("polygon", target.predicted, { stroke: color, "stroke-width": 1.5, "stroke-dasharray": "5 5", class: "predicted" }));
  }
  if (target.found && show.matchSet && target.match_set) parts.push(...dots(target.match_set, color));
  if (target.found && show.marker) {
    for (const marker of target.markers || []) {
      parts.push(shape("polygon", marker, { stroke: "#000", "stroke-width": 3.5, "stroke-opacity": 0.5 }));
      parts.push(shape("polygon", marker, { stroke: "#fff", "stroke-width": 1.5, class: "marker" }));
    }
  }
  if (target.found && show.axes && target.axes) parts.push(...axes(target.axes));
  const outline = target.found ? target.outline : target.predicted;
  if (width && show.name && outline?.length) parts.push(nameAt(outline, target, color, width));
  return parts;
}

// What may be a ball as well: dashed and white; its words are read out.
export function drawDoubtful(outline) {
  const mark = made("g", { role: "img", class: "doubtful" });
  const words = document.createElementNS(SVG, "title");
  const [x, y] = [0, 1].map((first) => outline.reduce((sum, value, index) => sum + (index % 2 === first ? value : 0), 0) / (outline.length / 2));
  words.textContent = `doubtful: may be a ball, at ${Math.round(x)}, ${Math.round(y)}; a click follows it`;
  const back = shape("polygon", outline, { stroke: "#000", "stroke-width": 4, "stroke-opacity": 0.6, "stroke-dasharray": "4 6" });
  const front = shape("polygon", outline, { stroke: "#fff", "stroke-width": 1.8, "stroke-dasharray": "4 6" });
  const sign = made("text", { x, y, "text-anchor": "middle", "dominant-baseline": "central", fill: "#fff", stroke: "#000" });
  sign.textContent = "?";
  mark.append(words, back, front, sign);
  return mark;
}

// The name of a target at the upper right of its outline, or at the upper left where the picture ends.
function nameAt(outline, target, color, width) {
  const xs = outline.filter((_, index) => index % 2 === 0);
  const ys = outline.filter((_, index) => index % 2);
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const aside = 0.12 * (right - left);
  const before = left + right > 1.3 * width;
  const name = made("text", {
    x: before ? left + aside : right - aside, y: Math.max(top + 0.12 * (bottom - top), 0.05 * width), "text-anchor": before ? "end" : "start",
    fill: color, stroke: "#000", class: "target-name",
  });
  name.textContent = shortened(target.name) + (target.alternatives?.length ? "?" : "");
  return name;
}

// Names that would lie on others are put below them; `pixel`: px of the picture in a CSS px.
export function spread(names, pixel) {
  const [high, wide] = [HIGH * pixel, LETTER * pixel];
  const taken = [];
  for (const name of names) {
    const width = wide * name.textContent.length;
    const left = Number(name.getAttribute("x")) - (name.getAttribute("text-anchor") === "end" ? width : 0);
    const lies = ([x, y, w]) => left < x + w && x < left + width && Math.abs(top - y) < high;
    let top = Number(name.getAttribute("y"));
    for (let other = taken.find(lies); other; other = taken.find(lies)) top = other[1] + 1.05 * high;
    taken.push([left, top, width]);
    name.setAttribute("y", top);
  }
}

// A trail is a list of [time, x, y]; where it was lost there is a gap.
export function drawTrail(trail, color) {
  let data = "";
  let pen = false;
  for (const point of trail) {
    if (!point[1]) { pen = false; continue; }
    data += `${pen ? "L" : "M"}${point[1]} ${point[2]}`;
    pen = true;
  }
  return made("path", { d: data, fill: "none", stroke: color, "stroke-width": 2, "stroke-opacity": 0.75, "stroke-linejoin": "round", class: "trail" });
}

export const drawTrace = (points) => [
  shape("polyline", points.flat(), { stroke: "#000", "stroke-width": 4, "stroke-opacity": 0.6 }),
  shape("polyline", points.flat(), { stroke: "#fff", "stroke-width": 2, "stroke-dasharray": "6 4", class: "trace" }),
];

// The cross that the arrow keys move; `reach` is half its size in pixels of the picture.
export function drawCross([x, y], reach) {
  const gap = reach / 4;
  const data = `M${x - reach} ${y}H${x - gap}M${x + gap} ${y}H${x + reach}M${x} ${y - reach}V${y - gap}M${x} ${y + gap}V${y + reach}`;
  return [
    made("path", { d: data, stroke: "#000", "stroke-width": 5, "stroke-opacity": 0.7 }),
    made("path", { d: data, stroke: "#fff", "stroke-width": 2, class: "cross" }),
  ];
}

function shape(kind, points, attributes) {
  return made(kind, { points: points.join(" "), fill: "none", "stroke-linejoin": "round", ...attributes });
}

function dots(points, color) {
  let data = "";
  for (let i = 0; i < points.length; i += 2) data += `M${points[i]} ${points[i + 1]}h0`;
  return [["#000", 5], ["#fff", 3.5], [color, 1.5]].map(([stroke, width]) => made("path", {
    d: data, stroke, "stroke-width": width, "stroke-linecap": "round", class: "match-set",
  }));
}

function axes(points) {
  const parts = [];
  const [x, y] = points;
  for (let axis = 0; axis < 3; axis++) {
    const [toX, toY] = points.slice(2 + 2 * axis, 4 + 2 * axis);
    const data = `M${x} ${y}L${toX} ${toY}`;
    parts.push(made("path", { d: data, stroke: "#000", "stroke-width": 5, "stroke-opacity": 0.5 }));
    parts.push(made("path", { d: data, stroke: AXES[axis], "stroke-width": 2.5, class: "axis" }));
    const name = made("text", { x: toX, y: toY, fill: AXES[axis], stroke: "#000", class: "axis-name" });
    name.textContent = NAMES[axis];
    parts.push(name);
  }
  return parts;
}

function made(kind, attributes) {
  const element = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, name === "stroke-width" ? value * pen() : value);
  element.setAttribute("vector-effect", "non-scaling-stroke");
  return element;
}

// Lines are as much wider as words are larger: on a screen of 4K.
const pen = () => palette.text / 12.8;
