// Other computers: what each sees, how old that is, and how its clock stands to that of this one.

import { element } from "../reading/reading.js";

export class SharingPanel {
  constructor(root) {
    this.root = root;
    this.title = element("h2", "", "");
    this.nobody = element("p", "nobody", "nobody else is here yet");
    this.table = element("table", "");
    this.table.append(headOf(["partner", "target", "x", "y", "z, m", "age", "clock", "missed"]));
    this.body = document.createElement("tbody");
    this.table.append(this.body);
    root.append(this.title, this.nobody, this.table);
  }

  update(state) {
    this.title.textContent = `Shared as ${state.name} (${state.key})`;
    const partners = state.partners || [];
    this.nobody.hidden = partners.length > 0;
    this.table.hidden = !partners.length;
    this.body.replaceChildren(...partners.flatMap(rowsOf));
  }
}

function headOf(words) {
  const head = document.createElement("thead");
  const row = document.createElement("tr");
  row.append(...words.map((each) => element("th", "", each)));
  head.append(row);
  return head;
}

function rowsOf(partner) {
  const targets = partner.targets?.length ? partner.targets : [{ name: "–", reason: partner.here ? "sees nothing" : "" }];
  return targets.map((target, index) => {
    const row = document.createElement("tr");
    row.dataset.usable = String(!target.reason && Boolean(target.position));
    row.append(element("td", "", index ? "" : partner.name), element("td", "", target.name), ...placeOf(target));
    const words = index ? ["", "", ""] : [ageOf(partner), clockOf(partner), `${partner.missed || 0}`];
    row.append(...words.map((each) => element("td", "", each)));
    return row;
  });
}

function placeOf(target) {
  if (target.position) return target.position.map((each) => element("td", "", each.toFixed(3)));
  const cell = element("td", "why", target.reason || "no pose");
  cell.colSpan = 3;
  return [cell];
}

function ageOf(partner) {
  if (!partner.here) return "gone";
  if (partner.silent) return "silent";
  return partner.age_ms === undefined ? "–" : `${partner.age_ms} ms`;
}

function clockOf(partner) {
  if (partner.offset === undefined || partner.offset === null) return "not known";
  const ahead = -partner.offset;
  const words = Math.abs(ahead) < 1 ? `${(1000 * ahead).toFixed(1)} ms` : `${ahead.toFixed(3)} s`;
  return `${ahead < 0 ? "" : "+"}${words} ±${(partner.offset_uncertainty_ms || 0).toFixed(2)} ms`;
}
