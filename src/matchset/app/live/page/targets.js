// The list of targets: name, color, diameter, and a cross to drop one. A row stays while its target does.

import { colorOf } from "./colors.js";
import { element } from "./reading.js";
import { parseLength } from "./units.js";

export class TargetList {
  constructor(root, send) {
    this.root = root;
    this.send = send;
    this.rows = new Map();
    this.chosen = null;
  }

  update(targets) {
    const ids = new Set(targets.map((target) => target.id));
    for (const [id, row] of this.rows) if (!ids.has(id)) { row.remove(); this.rows.delete(id); }
    for (const target of targets) {
      if (this.rows.has(target.id)) continue;
      const row = this.makeRow(target);
      this.rows.set(target.id, row);
      this.root.append(row);
      this.chosen = target.id;
    }
    if (!ids.has(this.chosen)) this.chosen = targets.length ? targets[targets.length - 1].id : null;
    for (const target of targets) {
      const row = this.rows.get(target.id);
      row.classList.toggle("chosen", target.id === this.chosen);
      row.querySelector(".state").textContent = target.found ? "" : "lost";
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
    name.addEventListener("click", () => { this.chosen = target.id; });
    const drop = element("button", "drop", "×");
    drop.type = "button";
    drop.setAttribute("aria-label", `drop ${target.name}`);
    drop.addEventListener("click", () => this.send({ type: "drop", target: target.id }));
    row.append(dot, name, drop, this.makeForm(target));
    return row;
  }

  makeForm(target) {
    const form = element("form", "");
    const label = element("label", "", "diameter ");
    const input = element("input", "diameter");
    input.size = 8;
    input.placeholder = "28 cm";
    input.autocomplete = "off";
    if (target.diameter) input.value = `${target.diameter} m`;
    label.append(input);
    const error = element("output", "");
    form.append(label, element("button", "", "set"), error);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      error.textContent = "";
      try {
        const meters = input.value.trim() ? parseLength(input.value) : null;
        this.send({ type: "diameter", target: target.id, meters });
      } catch (wrong) {
        error.textContent = wrong.message;
      }
    });
    return form;
  }
}
