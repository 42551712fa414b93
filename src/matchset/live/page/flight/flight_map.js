// The chain from above, in meters: it looks to the right. Drawn as vectors, anew with each state.

import { vehicleColor } from "./flight_pictures.js";

const SVG = "http://www.w3.org/2000/svg";
const SQUARE = 0.5; // m
const BALL = 0.14; // m, radius
const TRAIL = 40; // states: 4 s
const MARGIN = 0.5; // m

export class FlightMap {
  constructor(root) {
    this.root = root;
    this.clear();
  }

  clear() {
    this.trails = [];
    this.box = null;
  }

  draw({ vehicles = [], cameras = [], places = [] }) {
    if (!vehicles.length) { this.root.replaceChildren(); return; }
    this.fit(vehicles.length > 1 ? vehicles.map(({ at }) => at) : [vehicles[0].at, ...cameras.filter(Boolean)]);
    const parts = [this.grid()];
    vehicles.forEach(({ at }, index) => {
      const trail = this.trails[index] ||= [];
      trail.push(at);
      if (trail.length > TRAIL) trail.shift();
      parts.push(shape("polyline", { points: trail.map(place).join(" "), class: "trail" }, this.color(index, vehicles)));
    });
    vehicles.forEach((vehicle, index) => parts.push(...this.vehicle(vehicle, this.name(index, vehicles, cameras), this.color(index, vehicles))));
    cameras.forEach((at, index) => {
      if (!at) return;
      const [x, y] = place(at);
      parts.push(shape("circle", { cx: x, cy: y, r: 0.075, class: "estimate" }, vehicleColor(index)));
    });
    places.forEach((at) => parts.push(shape("path", { d: cross(at), class: "set-place" }))); // last: balls would hide them
    this.root.replaceChildren(...parts);
  }

  // Where no truth is known only the last vehicle is drawn as one.
  name(index, vehicles, cameras) { return index + 1 + (vehicles.length === 1 ? cameras.length : 0); }

  color(index, vehicles) { return vehicleColor(vehicles.length === 1 ? 5 : index); }

  fit(points) {
    const xs = points.map(([, z]) => z);
    const ys = points.map(([x]) => x);
    const box = this.box || [Infinity, Infinity, -Infinity, -Infinity];
    this.box = [Math.min(box[0], ...xs), Math.min(box[1], ...ys), Math.max(box[2], ...xs), Math.max(box[3], ...ys)];
    const [middle, center] = [(this.box[0] + this.box[2]) / 2, (this.box[1] + this.box[3]) / 2];
    const aspect = Math.max(this.root.clientWidth, 1) / Math.max(this.root.clientHeight, 1); // the map fills its place
    const wide = Math.max(this.box[2] - this.box[0] + 2 * MARGIN, (this.box[3] - this.box[1] + 2 * MARGIN) * aspect);
    this.edges = [middle - wide / 2, center - wide / aspect / 2, middle + wide / 2, center + wide / aspect / 2];
    this.root.setAttribute("viewBox", `${this.edges[0]} ${this.edges[1]} ${wide} ${wide / aspect}`);
  }

  grid() {
    const [left, top, right, bottom] = this.edges;
    let data = "";
    for (let x = Math.ceil(left / SQUARE) * SQUARE; x <= right; x += SQUARE) data += `M${x} ${top}V${bottom}`;
    for (let y = Math.ceil(top / SQUARE) * SQUARE; y <= bottom; y += SQUARE) data += `M${left} ${y}H${right}`;
    return shape("path", { d: data, class: "grid" });
  }

  vehicle({ at, nose }, name, color) {
    const [x, y] = place(at);
    const [ahead, aside] = place(nose);
    const disc = shape("circle", { cx: x, cy: y, r: BALL, class: "ball" }, color);
    const words = shape("text", { x, y: y - 0.18, class: "name" });
    words.textContent = name;
    return [shape("path", { d: `M${x} ${y}l${0.3 * ahead} ${0.3 * aside}`, class: "nose" }, color), disc, words];
  }
}

// To the right is ahead, down is to the right of the vehicles.
const place = ([x, z]) => [z, x];

function cross(at) {
  const [x, y] = place(at);
  return `M${x - 0.05} ${y}h.1M${x} ${y - 0.05}v.1`;
}

function shape(kind, attributes, color = "") {
  const made = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (color) made.style.setProperty("--color", color);
  return made;
}
