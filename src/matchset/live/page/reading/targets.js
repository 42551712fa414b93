// The list of targets: name, color, diameter, marker, all like one, and a cross to drop it. A row stays while its target does.

import { colorOf } from "../colors.js";
import { element } from "./reading.js";
import { parseMeasured } from "../units.js";

const LONGEST = 60; // letters of a name
const CALM = 1000; // ms for which a sentence about all that is like one stays: it is read out
const MANY = 3; // targets, with more of which only the chosen one shows its fields

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
      if (!target.finds) chosen = target.id; // what a person clicked; not what was found since it looks like that
    }
    if (chosen === null && targets.length) chosen = targets[targets.length - 1].id;
    if (chosen !== this.chosen || !this.rows.get(chosen)?.classList.contains("chosen")) this.choose(chosen);
    this.root.dataset.many = targets.length > MANY;
    for (const target of targets) {
      this.showReadings(target);
      this.showName(target, targets);
    }
    return targets.find((target) => target.id === this.chosen) || null;
  }

  // How many are followed, doubtful and left out, while all like one are looked for.
  showCrowd(root, crowd) {
    const words = crowd ? crowdWords(crowd) : "";
    const now = performance.now();
    if (words === root.textContent || (words && root.textContent && now - this.saidAt < CALM)) return;
    this.saidAt = now;
    root.textContent = words;
    root.hidden = !words;
  }

  // Its name, which may change, and in words what is in doubt.
  showName(target, targets) {
    const row = this.rows.get(target.id);
    const others = (target.alternatives || []).map((id) => targets.find((each) => each.id === id)?.name).filter(Boolean);
    const words = target.pending ? "" : target.found ? others.map((name) => `or ${name}?`).join(" ") : "lost";
    const state = row.querySelector(".state");
    if (state.textContent !== words) state.textContent = words;
    const finds = String(Boolean(target.finds));
    const all = row.querySelector(".all");
    if (all.getAttribute("aria-pressed") !== finds) all.setAttribute("aria-pressed", finds);
    if (row.dataset.name === target.name) return;
    row.dataset.name = target.name;
    row.querySelector(".name .words").textContent = target.name;
    row.querySelector(".drop").setAttribute("aria-label", `drop ${target.name}`);
    row.querySelector(".rename").setAttribute("aria-label", `rename ${target.name}`);
    all.setAttribute("aria-label", `find all like ${target.name}`);
    row.querySelector(".diameter")?.setAttribute("aria-label", `diameter of ${target.name}`);
    row.querySelector(".marker-width")?.setAttribute("aria-label", `width of the marker of ${target.name}`);
  }

  makeRow(target) {
    const row = element("li", "");
    const dot = element("span", "dot");
    dot.style.background = colorOf(target.id);
    const make = (classes, words, title, does) => {
      const button = element("button", classes, words);
      button.type = "button";
      button.title = title;
      button.addEventListener("click", does);
      return button;
    };
    const name = make("name", "", "double click: another name", () => this.choose(target.id));
    name.append(element("span", "words"), " ", element("span", "state"));
    name.addEventListener("dblclick", () => this.rename(row, target.id));
    const pencil = make("rename", "✎", "another name", () => this.rename(row, target.id));
    const drop = make("drop", "×", "follow it no more", () => this.send({ type: "drop", target: target.id }));
    const all = make("all", "find all like this one", "all that looks like it is followed, too", () => {
      this.send({ type: "find_all", target: target.id, on: all.getAttribute("aria-pressed") !== "true" });
    });
    row.append(dot, name, pencil, drop, element("div", "readings"), all);
    if ((target.shape || "circle") === "circle") row.append(this.makeDiameter(target), this.makeMarker(target));
    return row;
  }

  // A field in place of its name: Enter takes what is in it, Escape and leaving it do not.
  rename(row, id) {
    if (row.querySelector("form.naming")) return;
    this.choose(id);
    const [name, form, input] = [row.querySelector(".name"), element("form", "naming"), element("input", "")];
    Object.assign(input, { maxLength: LONGEST, value: row.dataset.name, autocomplete: "off" });
    input.setAttribute("aria-label", `another name for ${row.dataset.name}`);
    form.append(input);
    let open = true; // a form that goes loses the focus, too
    const end = () => { if (open) { open = false; form.remove(); name.hidden = false; } };
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const words = input.value.trim();
      if (words && words !== row.dataset.name) this.send({ type: "rename", target: id, name: words });
      end();
      name.focus();
    });
    input.addEventListener("keydown", (event) => { if (event.key === "Escape") { event.stopPropagation(); end(); name.focus(); } });
    input.addEventListener("blur", end);
    name.hidden = true;
    name.after(form);
    input.select();
    input.focus();
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
    return lengthForm("diameter", value, "28 cm", (meters, sigma) => {
      this.send({ type: "diameter", target: target.id, meters, sigma });
    });
  }

  makeMarker(target) {
    const details = element("details", "");
    details.append(element("summary", "", "marker on the ball"));
    details.append(lengthForm("marker-width", "6 cm", "6 cm", (meters) => {
      this.askPoint("Click the marker on the ball.", (point) => {
        this.send({ type: "marker", target: target.id, ...point, meters: meters ?? 0.06 });
      });
    }, "click it …"));
    return details;
  }
}

const crowdWords = ({ followed, doubtful = [], left_out = 0, most }) =>
  `${followed} followed, ${doubtful.length} doubtful, ${left_out} left out (most ${most})`;

// A field for a length, in words where it is none. An empty field stands for "not known".
function lengthForm(name, value, example, take, action = "set") {
  const form = element("form", "length");
  const field = element("label", "", name === "diameter" ? "diameter " : "width ");
  const input = element("input", name);
  const error = element("output", "");
  Object.assign(input, { size: 8, placeholder: example, autocomplete: "off", value });
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
