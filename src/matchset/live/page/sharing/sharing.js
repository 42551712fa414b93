// Other computers: what each sees, how old that is, and how its clock stands to that of this one.

import { element } from "../reading/reading.js";

export class SharingPanel {
  constructor(root) {
    this.root = root;
    this.title = element("h2", "", "");
    this.nobody = element("p", "nobody", "nobody else is here yet");
    this.list = element("div", "");
    root.append(this.title, this.nobody, this.list);
  }

  update(state) {
    this.title.textContent = `Shared as ${state.name} (${state.key})`;
    const partners = state.partners || [];
    this.nobody.hidden = partners.length > 0;
    this.list.replaceChildren(...partners.map(partnerOf));
  }
}

function partnerOf(partner) {
  const root = element("div", "partner");
  const name = element("strong", "", partner.name);
  const facts = [ageOf(partner), clockOf(partner)];
  if (partner.missed) facts.push(`${partner.missed} missed`);
  const line = element("p", "", "");
  line.append(name, ` ${facts.filter(Boolean).join(" · ")}`);
  const table = element("table", "");
  table.append(...(partner.targets || []).map(targetOf));
  root.append(line, table);
  return root;
}

function targetOf(target) {
  const row = document.createElement("tr");
  row.append(element("td", "", target.name));
  if (target.position) {
    const places = target.position.map((each, index) => element("td", "place", `${"xyz"[index]} ${each.toFixed(3)}`));
    row.append(...places, element("td", "", `±${target.sigma.toFixed(3)} m`));
    return row;
  }
  const why = element("td", "why", target.reason || "no pose");
  why.colSpan = 4;
  row.append(why);
  return row;
}

function ageOf(partner) {
  if (!partner.here) return "gone";
  if (partner.silent) return "silent";
  return partner.age_ms === undefined || partner.age_ms === null ? "" : `${partner.age_ms} ms old`;
}

// How far its clock is ahead of this computer's, and by how much that may be wrong.
function clockOf(partner) {
  if (partner.offset === undefined || partner.offset === null) return "clock not known";
  const ahead = -partner.offset;
  const words = Math.abs(ahead) < 1 ? `${(1000 * ahead).toFixed(1)} ms` : `${ahead.toFixed(3)} s`;
  return `clock ${ahead < 0 ? "" : "+"}${words} ±${(partner.offset_uncertainty_ms || 0).toFixed(2)} ms`;
}
