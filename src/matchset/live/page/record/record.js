// The button Record: how long and how large the recording is, and afterwards its files.

import { element } from "../reading/reading.js";

export class RecordPanel {
  constructor(root, send) {
    this.root = root;
    this.on = false;
    this.button = element("button", "record");
    this.button.type = "button";
    this.button.addEventListener("click", () => send({ type: "record", on: !this.on }));
    this.words = element("span", "record-words");
    this.list = element("div", "record-files");
    this.shown = "";
    root.append(element("h2", "", "Record"), this.button, this.words, this.list);
  }

  update(state) {
    this.on = Boolean(state.on);
    this.button.textContent = this.on ? "Stop recording" : "Record";
    this.button.setAttribute("aria-pressed", String(this.on));
    this.words.textContent = progress(state);
    const finished = state.finished || [];
    if (JSON.stringify(finished) === this.shown) return; // links must not be replaced while somebody clicks them
    this.shown = JSON.stringify(finished);
    this.list.replaceChildren(...finished.map((each, index) => filesOf(each, index === 0)));
  }
}

function progress(state) {
  if (state.finishing) return "finishing the files …";
  if (!state.on) return "";
  const parts = [clock(state.seconds || 0), sizeText(state.size || 0)];
  if (state.dropped) parts.push(`${state.dropped} pictures left out`);
  if (state.minutes !== undefined && state.minutes !== null && state.minutes < 120) parts.push(`room for ${state.minutes} min`);
  return parts.join(" · ");
}

function filesOf(recording, open) {
  const details = element("details", "");
  details.open = open;
  const summary = element("summary", "", recording.folder);
  details.append(summary);
  const left = recording.dropped ? `${recording.dropped} pictures were left out` : "";
  for (const words of [recording.ended, left]) if (words) details.append(element("p", "record-problem", words));
  const list = element("ul", "");
  for (const file of recording.files) {
    const link = element("a", "", file.name);
    link.href = `download/${encodeURIComponent(recording.folder)}/${file.name.split("/").map(encodeURIComponent).join("/")}`;
    link.download = `${recording.folder}-${file.name.replaceAll("/", "-")}`;
    const item = element("li", "");
    item.append(link, " ", element("span", "size", sizeText(file.size)));
    list.append(item);
  }
  details.append(list);
  return details;
}

function clock(seconds) {
  const [minutes, rest] = [Math.floor(seconds / 60), seconds % 60];
  return `${minutes}:${String(rest).padStart(2, "0")}`;
}

function sizeText(bytes) {
  if (bytes < 1e5) return `${Math.max(Math.round(bytes / 1e3), bytes ? 1 : 0)} kB`;
  return bytes < 1e9 ? `${(bytes / 1e6).toFixed(1)} MB` : `${(bytes / 1e9).toFixed(2)} GB`;
}
