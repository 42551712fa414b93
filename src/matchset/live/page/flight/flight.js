// A flight: what every follower sees, the map, the table; arm, land, and the switch that stops the motors.
//
// The server holds the vehicles' safety. This page says ten times a second that it is in view, if it commands; when it
// falls silent (hidden, locked, closed, no connection) the server holds and lands them. It never arms by itself.

import { FlightMap } from "./flight_map.js";
import { FollowerPicture } from "./flight_pictures.js";
import { element } from "../reading/reading.js";

const HOLD = 1000; // ms that the button must be held to take off
const BEAT = 100; // ms between two signs of life
const HEADS = ["", "state", "age", "lost", "distance", "off", "why"];

export class FlightPanel {
  constructor(root, send) {
    this.root = root;
    this.send = send;
    this.pictures = [];
    this.state = {};
    this.me = "";
    this.names = new Set(); // of this page: another one after each new connection
    this.painted = 0;
    this.asked = -Infinity; // when this page asked to take off
    this.banner = element("p", "flight-banner");
    this.banner.setAttribute("role", "status");
    this.views = element("div", "follower-pictures");
    const map = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    map.setAttribute("id", "flight-map");
    map.setAttribute("role", "img");
    map.setAttribute("aria-label", "the chain from above");
    this.map = new FlightMap(map);
    this.table = this.makeTable();
    const below = element("div", "flight-below");
    const figure = element("figure", "flight-map-figure");
    this.legend = element("figcaption", "");
    figure.append(map, this.legend);
    const place = element("div", "flight-table-place");
    place.append(this.table);
    below.append(figure, place);
    root.append(this.banner, this.views, below, this.makeBar());
    this.guardSpace();
    setInterval(() => this.beat(), BEAT);
    setInterval(() => this.pictures.forEach((picture) => picture.refresh()), 100);
  }

  get shown() { return !this.root.hidden; }

  get commands() { return Boolean(this.me) && this.state.page === this.me; }

  update(state, session = {}) {
    this.state = { duty: "idle", followers: [], ...state };
    this.me = session.page || "";
    if (this.me) this.names.add(this.me);
    while (this.pictures.length < (session.streams || 0)) this.addPicture();
    while (this.pictures.length > (session.streams || 0)) this.pictures.pop().root.remove();
    if (!this.state.ready) this.map.clear();
    const said = words(this.state, this.commands, this.names);
    if (this.banner.textContent !== said) this.banner.textContent = said;
    this.legend.textContent = legend(this.state.map || {});
    this.banner.dataset.duty = this.state.fault ? "stopped" : this.state.duty;
    this.map.draw(this.state.map || {});
    this.showRows(this.state.followers);
    this.showButtons();
  }

  addPicture() {
    const picture = new FollowerPicture(this.pictures.length);
    this.pictures.push(picture);
    this.views.append(picture.root);
  }

  // A picture of a follower; it is acknowledged when it is on the screen.
  async receive(packet) {
    const picture = this.pictures[packet.stream];
    const acknowledge = () => this.send({ type: "ack", sequence: packet.sequence, stream: packet.stream });
    if (!picture || !await picture.paint(packet)) { acknowledge(); return; }
    requestAnimationFrame(() => {
      this.painted = Math.max(this.painted, packet.sequence);
      acknowledge();
    });
  }

  // Another source, or another server: its pictures begin at their own numbers.
  restart() {
    this.painted = 0;
    this.map.clear();
    for (const picture of this.pictures) picture.arrived = picture.shown = 0;
  }

  beat() {
    const commands = this.commands && (this.state.duty === "flying" || this.state.duty === "holding");
    const asked = performance.now() - this.asked < HOLD; // the answer may be on its way
    if (this.shown && (commands || asked) && !document.hidden) this.send({ type: "alive", sequence: this.painted });
  }

  // By two ways at once: the socket may be the one that does not get through.
  kill() {
    this.send({ type: "kill" });
    fetch("do/kill", { method: "POST", body: "{}", keepalive: true }).catch(() => {
      this.banner.textContent = "The order did not get through: no connection. Who commanded is silent now, so the server lands everybody.";
    });
  }

  // The space bar stops the motors and does nothing else, whatever has the focus.
  guardSpace() {
    const guard = (event) => {
      if (event.key !== " " || !this.shown) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      if (event.type === "keydown" && !event.repeat) this.kill();
    };
    for (const kind of ["keydown", "keypress", "keyup"]) window.addEventListener(kind, guard, { capture: true });
  }

  makeBar() {
    const bar = element("div", "flight-bar");
    this.arm = button("arm", "");
    this.fill = element("span", "fill");
    this.armWords = element("span", "words", "Hold 1 s to take off");
    this.arm.append(this.fill, this.armWords);
    this.wireHold();
    this.again = button("again", "Put back at the start");
    this.again.addEventListener("click", () => this.send({ type: "again" }));
    this.land = button("land", "Land");
    this.land.addEventListener("click", () => this.send({ type: "land" }));
    const stop = button("kill", "Stop the motors");
    stop.append(element("kbd", "", "space"));
    stop.addEventListener("pointerdown", () => this.kill()); // not when the finger leaves: at once
    stop.addEventListener("click", (event) => { if (!event.detail) this.kill(); }); // by Enter
    bar.append(this.arm, this.again, this.land, stop);
    return bar;
  }

  // Press and hold, by finger, mouse or the Enter key; letting go, leaving or hiding the page takes it back.
  wireHold() {
    const begin = (event) => {
      if (this.arm.disabled || this.pressed || (event.type === "keydown" && (event.key !== "Enter" || event.repeat))) return;
      if (event.button) return;
      event.preventDefault();
      this.arm.focus();
      this.pressed = performance.now();
      this.showHold();
    };
    const cancel = () => { this.pressed = 0; this.fill.style.width = ""; };
    this.arm.addEventListener("pointerdown", begin);
    this.arm.addEventListener("keydown", begin);
    for (const kind of ["pointerup", "pointerleave", "pointercancel", "keyup", "blur"]) this.arm.addEventListener(kind, cancel);
    this.arm.addEventListener("contextmenu", (event) => event.preventDefault());
    document.addEventListener("visibilitychange", cancel);
    this.letGo = cancel;
  }

  showHold() {
    if (!this.pressed) return;
    const past = performance.now() - this.pressed;
    if (this.arm.disabled) { this.letGo(); return; }
    if (past >= HOLD) {
      this.letGo();
      this.send({ type: "arm" });
      this.asked = performance.now();
      return;
    }
    this.fill.style.width = `${100 * past / HOLD}%`;
    requestAnimationFrame(() => this.showHold());
  }

  showButtons() {
    const { duty, ready, fault } = this.state;
    const over = Boolean(fault) || duty === "stopped";
    this.again.hidden = !over;
    this.again.disabled = !fault && !ready;
    this.arm.hidden = over;
    this.arm.disabled = !ready || duty !== "idle";
    this.armWords.textContent = duty === "idle" || over ? "Hold 1 s to take off" : this.commands ? "You command" : `${other(this.state.page, this.names)} commands`;
    this.land.disabled = !this.commands || (duty !== "flying" && duty !== "holding");
  }

  makeTable() {
    const table = element("table", "flight-table");
    const head = document.createElement("thead");
    const row = document.createElement("tr");
    row.append(...HEADS.map((name) => element("th", "", name)));
    head.append(row);
    this.rows = document.createElement("tbody");
    table.append(head, this.rows);
    return table;
  }

  showRows(followers) {
    const rows = followers.map((follower, index) => {
      const row = document.createElement("tr");
      this.pictures[index]?.showPhase(follower.phase);
      const phase = element("td", "phase", follower.phase);
      phase.dataset.phase = follower.phase;
      const cells = [`${index + 1} → ${index + 2}`, phase, unit(1000, follower.age, 0, "ms"), `${follower.losses}`,
        unit(1, follower.distance, 2, "m"), unit(100, follower.off, 0, "cm"), follower.reason];
      row.append(...cells.map((cell) => (cell instanceof Element ? cell : element("td", "", cell))));
      row.lastChild.className = "why";
      return row;
    });
    this.rows.replaceChildren(...rows);
  }
}

// What is on the map.
function legend({ vehicles = [], cameras = [], places = [] }) {
  if (!vehicles.length) return "";
  const parts = [places.length && "cross: where the camera should be", cameras.some(Boolean) && "ring: where the chain sees it"].filter(Boolean);
  return `From above, squares of 0.5 m.${parts.length ? ` ${parts.join("; ").replace(/^./, (letter) => letter.toUpperCase())}.` : ""}`;
}

// A page by what a person knows of it: this one, or another. Its number says nothing.
const other = (words, names) => (words || "").replace(/^page \d+/, (name) => (names.has(name) ? "this page" : "another page"));

// How far it is with getting ready.
function preparing({ kernels = 0, preparing: seconds = 0 }) {
  const past = seconds >= 1 ? `, ${seconds.toFixed(0)} s so far` : "";
  if (!kernels) return `Getting ready${past}: seconds, or a minute or two at the first time.`;
  return `Getting ready${past}: compiling, only once on this machine, ${kernels} ${kernels === 1 ? "piece" : "pieces"} done.`;
}

// What there is to say, in a sentence.
export function words(state, commands, names = new Set()) {
  const { duty, fault, ready, silent = 0, time = 0, stop_delay: delay } = state;
  const [page, reason] = [other(state.page, names), other(state.reason, names)];
  if (fault) return `Nothing flies: ${fault}`;
  if (duty === "stopped") {
    if (!ready) return "Everybody is put back at the start …";
    return `Motors off: ${reason}.${delay || delay === 0 ? ` They were off ${delay.toFixed(2)} s after the order.` : ""}`;
  }
  if (duty === "descending") return `Landing: ${reason}.`;
  if (duty === "holding") {
    return commands ? `This page was not heard for ${silent.toFixed(1)} s: everybody holds.` : `${sentence(page)} is silent for ${silent.toFixed(1)} s: everybody holds, and lands after 1 s.`;
  }
  if (duty === "flying") {
    return commands ? `You command. In flight for ${time.toFixed(0)} s.` : `${sentence(page)} commands, in flight for ${time.toFixed(0)} s. You may watch, and stop the motors.`;
  }
  return ready ? "Nobody flies. Hold the button for a second to take off." : preparing(state);
}

const sentence = (text) => text.replace(/^./, (letter) => letter.toUpperCase());

function button(name, text) {
  const made = element("button", `flight-${name}`, text);
  made.type = "button";
  made.id = `flight-${name}`;
  return made;
}

const unit = (factor, value, digits, name) => (value === null || value === undefined ? "–" : `${(factor * value).toFixed(digits)} ${name}`);
