// The list of targets: name, color, diameter, marker, and a cross to drop one. A row stays while its target does.

import { colorOf } from "../colors.js";
import { element } from "./reading.js";
import { parseMeasured } from "../units.js";

export class TargetList {
  // `askPoint(words, take)` waits for a click in the picture and hands it to take({sequence, x, y}).
  constructor(root, send, askPoint) {
    this.root = root;
    this.send = send;
    this.askPoint = askPoint;
    this.rows = new Map();
    this.chosen = null;
  }

  choose(id) {
    this.chosen = id;
    for (const [number, row] of this.rows) {
      row.classList.toggle("chosen", number === id);
      row.querySelector(".name").setAttribute("aria-pressed", number === id);
    }
  }

  update(targets) {
    const ids = new Set(targets.map((target) => target.id));
    for (const [id, row] of this.rows) if (!ids.has(id)) { row.remove(); this.rows.delete(id); }
    let chosen = ids.has(this.chosen) ? this.chosen : null;
    for (const target of targets) {
      if (this.rows.has(target.id)) continue;
      const row = this.makeRow(target);
      this.rows.set(target.id, row);
      this.root.append(row);
      chosen = target.id;
    }
    if (chosen === null && targets.length) chosen = targets[targets.length - 1].id;
    if (chosen !== this.chosen || !this.rows.get(chosen)?.classList.contains("chosen")) this.choose(chosen);
    for (const target of targets) {
      this.showReadings(target);
      const state = this.rows.get(target.id).querySelector(".state");
      const words = target.found || target.pending ? "" : "lost";
      if (state.textContent !== words) state.textContent = words;
    }
    return targets.find((target) => target.id === this.chosen) || null;
  }

  makeRow(target) {
    const row = element("li", "");
    const dot = element("span", "dot");
    dot.style.background = colorOf(target.id);
    const name = element("button", "name", target.name);
    name.type = "button";
    name.append(" ", element("span", "state"));
    name.addEventListener("click", () => this.choose(target.id));
    const drop = element("button", "drop", "×");
    drop.type = "button";
    drop.setAttribute("aria-label", `drop ${target.name}`);
    drop.addEventListener("click", () => this.send({ type: "drop", target: target.id }));
    row.append(dot, name, drop, element("div", "readings"));
    if ((target.shape || "circle") === "circle") row.append(this.makeDiameter(target), this.makeMarker(target));
    return row;
  }

  // What the click may mean, one button each; the one that was taken is pressed.
  showReadings(target) {
    const root = this.rows.get(target.id).querySelector(".readings");
    const readings = target.readings || [];
    const shown = JSON.stringify([readings, target.reading]);
    if (root.dataset.shown === shown) return;
    root.dataset.shown = shown;
    root.replaceChildren(...(readings.length > 1 ? readings : []).map((words, k) => {
      const button = element("button", "", words);
      button.type = "button";
      button.setAttribute("aria-pressed", k + 1 === target.reading);
      button.addEventListener("click", () => this.send({ type: "reread", target: target.id, reading: k + 1 }));
      return button;
    }));
  }

  makeDiameter(target) {
    const spread = target.diameter_sigma ? ` ± ${target.diameter_sigma}` : "";
    const value = target.diameter ? `${target.diameter}${spread} m` : "";
    return lengthForm(`diameter of ${target.name}`, "diameter", value, "28 cm", (meters, sigma) => {
      this.send({ type: "diameter", target: target.id, meters, sigma });
    });
  }

  makeMarker(target) {
    const details = element("details", "");
    details.append(element("summary", "", "marker on the ball"));
    details.append(lengthForm(`width of the marker of ${target.name}`, "marker-width", "6 cm", "6 cm", (meters) => {
      this.askPoint("Click the marker on the ball.", (point) => {
        this.send({ type: "marker", target: target.id, ...point, meters: meters ?? 0.06 });
      });
    }, "click it …"));
    return details;
  }
}

// A field for a length, in words where it is none. An empty field stands for "not known".
function lengthForm(label, name, value, example, take, action = "set") {
  const form = element("form", "length");
  const field = element("label", "", name === "diameter" ? "diameter " : "width ");
  const input = element("input", name);
  const error = element("output", "");
  Object.assign(input, { size: 8, placeholder: example, autocomplete: "off", value });
  input.setAttribute("aria-label", label);
  field.append(input);
  form.append(field, element("button", "", action), error);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    error.textContent = "";
    input.removeAttribute("aria-invalid");
    try {
      take(...(input.value.trim() ? parseMeasured(input.value) : [null, 0]));
    } catch (wrong) {
      error.textContent = wrong.message;
      input.setAttribute("aria-invalid", "true");
    }
  });
  return form;
}
