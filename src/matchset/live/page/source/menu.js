// The menu of sources: the start page while nothing is shown, and behind a button of the header afterwards.

import { Brought } from "./brought.js";
import { element } from "../reading/reading.js";

const AGAIN = 2000; // ms between two looks while the start page is seen: a camera that is plugged in appears
const KINDS = [["given", "From the command line"], ["address", "What was brought here"], ["upload", "What was brought here"], ["camera", "Cameras"], ["file", "Videos of this folder"], ["demo", "To try it"], ["flight", "To try it"]];

export class Menu {
  constructor(send) {
    this.send = send;
    this.root = element("section", "menu");
    this.root.id = "sources";
    this.root.setAttribute("aria-label", "what is shown");
    this.button = element("button", "", "other source");
    this.button.id = "other-source";
    this.button.type = "button";
    this.button.setAttribute("aria-controls", "sources");
    this.button.addEventListener("click", () => this.toggle());
    this.list = element("div", "groups");
    this.words = element("p", "soft");
    const again = element("button", "", "look again");
    again.type = "button";
    again.addEventListener("click", () => send({ type: "look_again" }));
    this.heading = element("h2", "", "What do you want to see?");
    this.heading.setAttribute("aria-live", "polite");
    this.brought = new Brought(send, () => { this.asked = true; });
    const last = element("p", "last");
    last.append(again, this.words);
    this.fault = element("p", "fault");
    this.fault.setAttribute("role", "alert");
    this.root.append(this.heading, this.fault, this.list, this.brought.root, last);
    this.root.addEventListener("keydown", (event) => { if (event.key === "Escape") this.close(); });
    document.getElementById("source").after(this.button);
    document.querySelector("main").before(this.root);
    this.isOpen = false;
    this.shown = null;
    setInterval(() => { if (this.shown === "" && !document.hidden) send({ type: "look_again" }); }, AGAIN);
  }

  update(state) {
    const starts = !state.shown;
    const opened = this.asked && !state.opening && !state.fault; // also where it is what was shown before
    if (opened || (this.shown !== null && state.shown !== this.shown)) this.isOpen = this.asked = false;
    this.shown = state.shown || "";
    this.brought.allow(state.room || 0);
    this.words.textContent = state.words || "";
    const heading = state.opening ? `Opening ${state.opening} …` : "What do you want to see?";
    if (this.heading.textContent !== heading) this.heading.textContent = heading;
    if (this.fault.textContent !== (state.fault || "")) this.fault.textContent = state.fault || "";
    this.root.classList.toggle("starts", starts);
    document.body.classList.toggle("nothing-shown", starts);
    this.button.hidden = starts;
    if (state.fault && state.fault !== this.toldFault) this.isOpen = true;
    this.toldFault = state.fault;
    this.show(starts || this.isOpen);
    const written = JSON.stringify([state.entries, state.shown]);
    if (written !== this.written) this.fill(state.entries, this.shown);
    this.written = written;
  }

  // The list is made again only where it changed, so that the focus stays.
  fill(entries, shown) {
    const groups = new Map();
    for (const [kind, title] of KINDS) {
      for (const entry of entries.filter((each) => each.kind === kind)) {
        if (!groups.has(title)) groups.set(title, []);
        groups.get(title).push(this.makeEntry(entry, entry.key === shown));
      }
    }
    this.list.replaceChildren(...[...groups].map(([title, buttons]) => {
      const group = element("div", "group");
      group.append(element("h3", "", title), ...buttons);
      return group;
    }));
  }

  makeEntry(entry, isShown) {
    const button = element("button", "entry");
    button.type = "button";
    button.dataset.kind = entry.kind;
    if (isShown) button.setAttribute("aria-current", "true");
    const words = element("span", "about");
    words.append(element("span", "name", entry.name), element("span", "soft", entry.words));
    if (entry.pictured) button.append(thumbnail(entry.key));
    button.append(words);
    button.addEventListener("click", () => { this.asked = true; this.send({ type: "show", key: entry.key }); });
    return button;
  }

  toggle() {
    this.isOpen = !this.isOpen;
    if (this.isOpen) this.send({ type: "look_again" });
    this.show(this.isOpen);
    if (this.isOpen) this.list.querySelector("button")?.focus();
  }

  close() {
    if (!this.shown) return;
    this.isOpen = false;
    this.show(false);
    this.button.focus();
  }

  // The section is hidden by the page, too, while the server offers nothing.
  show(visible) {
    this.root.classList.toggle("closed", !visible);
    this.button.setAttribute("aria-expanded", String(visible));
  }
}

// The first picture of a video; where there is none, nothing.
function thumbnail(key) {
  const image = document.createElement("img");
  Object.assign(image, { alt: "", loading: "lazy", decoding: "async" });
  image.addEventListener("error", () => image.remove());
  image.src = `thumbnail.jpg?key=${encodeURIComponent(key)}`;
  return image;
}
