// The camera's settings: what was asked for, and what the camera says it does.

import { element } from "../reading/reading.js";

const NAMES = { exposure: "exposure", gain: "gain", white_balance: "white balance", fps: "rate" };

export class SettingsPanel {
  constructor(root, send) {
    this.root = root;
    this.send = send;
    this.rows = new Map();
    this.part = element("details", "");
    this.part.append(element("summary", "", "camera settings"));
    this.list = element("div", "settings");
    this.missing = element("p", "soft");
    this.part.append(this.list, this.missing);
    root.append(this.part);
  }

  update(state) {
    const names = (state.settings || []).map((setting) => setting.name);
    if (state.size) names.push("size");
    for (const [name, row] of this.rows) if (!names.includes(name)) { row.remove(); this.rows.delete(name); }
    for (const setting of state.settings || []) this.updateRow(setting);
    if (state.size) this.updateSize(state);
    const missing = state.missing || [];
    this.missing.textContent = !state.opened ? "The camera is not open." : missing.length ? `This camera has no setting of its ${missing.join(", ")}.` : "";
  }

  updateRow(setting) {
    let row = this.rows.get(setting.name);
    if (!row) {
      row = this.makeRow(setting);
      this.rows.set(setting.name, row);
      this.list.append(row);
    }
    const input = row.querySelector("input[type=text]");
    const own = row.querySelector("input[type=checkbox]");
    row.dataset.value = setting.value;
    if (document.activeElement !== input && !row.dataset.wrong) input.value = `${setting.asked ?? setting.value}`;
    if (own) own.checked = Boolean(setting.automatic);
    if (row.dataset.wrong && row.dataset.wrong === input.value) return; // what was typed is no number: that stays to be read
    row.dataset.wrong = "";
    const says = setting.automatic ? `the camera chooses: ${setting.value}` : `the camera says ${setting.value}`;
    say(row, setting.words || says, Boolean(setting.words));
  }

  makeRow(setting) {
    const row = element("form", "setting");
    row.dataset.name = setting.name;
    const label = element("label", "", `${NAMES[setting.name]} `);
    const input = element("input", "");
    input.type = "text";
    input.inputMode = "decimal";
    input.size = 7;
    input.autocomplete = "off";
    label.append(input);
    row.append(label, element("span", "soft", setting.unit || ""), element("button", "", "set"));
    if ("automatic" in setting) {
      const box = element("label", "", "");
      const own = element("input", "");
      own.type = "checkbox";
      own.addEventListener("change", () => {
        row.dataset.wrong = "";
        this.send({ type: "set_camera", name: setting.name, value: own.checked ? null : parseFloat(row.dataset.value) });
      });
      box.append(own, " automatic");
      row.append(box);
    }
    row.append(element("output", ""));
    row.addEventListener("submit", (event) => {
      event.preventDefault();
      const text = input.value.trim().replace(",", ".");
      if (!/^-?\d+(\.\d+)?$/.test(text)) {
        row.dataset.wrong = input.value;
        say(row, `"${input.value}" is no number`, true);
        return;
      }
      row.dataset.wrong = "";
      this.send({ type: "set_camera", name: setting.name, value: parseFloat(text) });
      input.blur();
    });
    return row;
  }

  updateSize(state) {
    let row = this.rows.get("size");
    if (!row) {
      row = element("form", "setting");
      row.dataset.name = "size";
      const label = element("label", "", "size ");
      const select = element("select", "");
      for (const [width, height] of state.sizes) {
        const option = element("option", "", `${width} × ${height}`);
        option.value = `${width}x${height}`;
        select.append(option);
      }
      select.addEventListener("change", () => {
        const [width, height] = select.value.split("x").map(Number);
        this.send({ type: "set_camera_size", width, height });
      });
      label.append(select);
      row.append(label, element("output", ""));
      this.rows.set("size", row);
      this.list.append(row);
    }
    const select = row.querySelector("select");
    if (document.activeElement !== select) select.value = state.size.join("x");
    say(row, state.size_words || `the camera says ${state.size.join(" × ")}`, Boolean(state.size_words));
  }
}

function say(row, words, isFault) {
  const output = row.querySelector("output");
  if (output.textContent !== words) output.textContent = words;
  output.classList.toggle("refused", isFault);
}
