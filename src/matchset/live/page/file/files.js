// A recorded video: play, pause, step, scrub; what was found on a time line; corrections and downloads.

import { colorOf } from "../colors.js";
import { Courses } from "../curves/course.js";
import { LifeLines, lifeOfVideo } from "../curves/lives.js";
import { element } from "../reading/reading.js";
import { times } from "../units.js";
import { drawLine } from "./timeline.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
const FAR = 10; // frames of a step with Shift
const PAGE = 0.05; // of the video, for the keys Page Up and Page Down
const TYPING = "input:not([type=checkbox]):not([type=radio]), select, textarea";
const PRESSING = "button, a, summary, input[type=checkbox], input[type=radio]"; // what the space bar presses

export class FilePanel {
  // `results` is the place for corrections and downloads, `courses` for curves. `chosen()` is the number of the target that the reading shows; `askPoint(words, take)` waits for a click in the picture, `choose(id)` is told of a target that was clicked.
  constructor(root, results, courses, send, chosen, askPoint, choose) {
    Object.assign(this, { root, results, send, chosen, askPoint, state: null, wanted: null });
    this.canvas = element("canvas", "timeline");
    this.canvas.tabIndex = 0;
    for (const [name, value] of [["role", "slider"], ["aria-label", "time line"], ["aria-valuemin", 0]]) this.canvas.setAttribute(name, value);
    this.time = element("output", "time");
    this.work = element("p", "work");
    this.files = element("p", "files");
    this.lives = element("div", "lives");
    this.lives.append(document.createElementNS("http://www.w3.org/2000/svg", "svg"));
    this.lives.firstChild.setAttribute("aria-label", "where each target was first seen, found, and seen last");
    this.lines = new LifeLines(this.lives.firstChild, choose, (share) => this.seek(share * this.state.end));
    this.root.replaceChildren(this.canvas, this.lives, this.makeButtons());
    this.part = element("p", "part");
    this.results.append(this.work, this.makeExports(), this.part, this.files);
    this.courses = new Courses(courses, (share) => this.state && this.seek(share * this.state.end));
    this.canvas.addEventListener("pointerdown", (event) => this.grab(event));
    this.canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const name of ["pointerup", "pointercancel"]) this.canvas.addEventListener(name, () => this.letGo());
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  makeButtons() {
    const row = element("div", "transport");
    const make = (classes, words, name, does) => {
      const button = element("button", classes, words);
      button.type = "button";
      button.title = name;
      button.setAttribute("aria-label", name);
      button.addEventListener("click", does);
      return button;
    };
    this.play = make("play", "▶", "play (space)", () => this.toggle());
    this.speed = element("select", "speed");
    this.speed.setAttribute("aria-label", "speed");
    for (const factor of SPEEDS) {
      const option = element("option", "", `${factor} ×`);
      option.value = factor;
      this.speed.append(option);
    }
    this.speed.value = 1;
    this.speed.addEventListener("change", () => this.send({ type: "speed", factor: Number(this.speed.value) }));
    row.append(
      make("back", "◀❙", "one frame back (left arrow)", () => this.step(-1)), this.play,
      make("forward", "❙▶", "one frame forward (right arrow)", () => this.step(1)), this.time, this.speed,
    );
    return row;
  }

  makeExports() {
    const row = element("div", "exports");
    const make = (words, does) => {
      const button = element("button", "", words);
      button.type = "button";
      button.addEventListener("click", does);
      return button;
    };
    const write = (what) => () => this.send({ type: "export", target: this.chosen(), what });
    this.correct = make("correct …", () => this.askCorrection());
    this.correct.title = "click where the target is: it is followed anew from this picture on";
    this.tables = make("CSV tables", write("tables"));
    this.film = make("annotated video", write("film"));
    this.stop = make("stop", () => this.send({ type: "stop_export" }));
    this.working = element("output", "working");
    row.append(this.correct, this.tables, this.film, this.working, this.stop);
    return row;
  }

  // What the server says of the file, ten times a second at most.
  update(state) {
    this.state = "last" in state ? state : null;
    if (!this.state) return;
    const playing = Boolean(state.playing);
    if (this.play.textContent !== (playing ? "❚❚" : "▶")) {
      this.play.textContent = playing ? "❚❚" : "▶";
      this.play.setAttribute("aria-label", playing ? "pause (space)" : "play (space)");
    }
    if (document.activeElement !== this.speed) this.speed.value = state.speed || 1;
    if (this.wanted === null) this.index = state.index;
    this.showWork();
    this.showExports();
    const line = this.line();
    this.courses.update(line ? line.id : null, line ? line.version || 0 : 0);
    this.draw();
  }

  // A picture is on the screen.
  painted(picture) {
    if (!this.state) return;
    this.state.index = picture.index;
    this.state.time = picture.time;
    if (this.wanted === null) this.index = picture.index;
    this.draw();
  }

  line() {
    const targets = this.state.targets || [];
    return targets.find((target) => target.id === this.chosen()) || targets[0] || null;
  }

  showWork() {
    const { state } = this;
    const line = this.line();
    const parts = [];
    if (!state.complete) parts.push(`reading the file: ${(100 * (state.last + 1) / (state.end + 1)).toFixed(0)} %`);
    if (line) {
      parts.push(`${line.name}: ${Math.floor(line.percent || 0)} % tracked`, `found in ${line.found || 0}, lost in ${line.lost || 0} ${line.lost === 1 ? "frame" : "frames"}`);
      if (state.rate) parts.push(`${state.rate.toFixed(0)} frames/s`);
      if (times(state.computing)) parts.push(`computing a frame: ${times(state.computing)}`);
      if (state.left) parts.push(`${duration(state.left)} left`);
    } else if (state.complete) parts.push("Click the ball in any frame: it is followed from there to the end and back to the beginning.");
    if (state.same) parts.push(state.same);
    this.work.textContent = parts.join(" · ");
    this.work.dataset.percent = line ? line.percent || 0 : "";
  }

  showExports() {
    const { working, written } = this.state;
    const line = this.line();
    this.correct.disabled = !line;
    this.tables.disabled = this.film.disabled = !line || Boolean(working);
    const part = line?.part || "";
    this.part.hidden = !part;
    const share = Math.floor(line?.percent || 0);
    this.part.textContent = share < 100 ? `Written now: ${part} alone, ${share} % of the video.` : `Written: ${part}, in which it is known.`;
    const offer = part ? "CSV of this part" : "CSV tables";
    if (this.tables.textContent !== offer) this.tables.textContent = offer;
    this.stop.hidden = !working;
    this.working.textContent = working ? `${working.name}: ${Math.floor(working.percent || 0)} %${working.left ? `, ${duration(working.left)} left` : ""}` : "";
    const key = JSON.stringify(written || []);
    if (key === this.shownFiles) return;
    this.shownFiles = key;
    this.files.replaceChildren(...(written || []).map((file) => {
      const link = element("a", "", file.name);
      link.href = `download/${file.name}`;
      link.download = file.name;
      const entry = element("span", "file");
      entry.append(link, element("span", "holds", ` ${file.words}`));
      return entry;
    }));
  }

  askCorrection() {
    const line = this.line();
    this.send({ type: "pause" });
    this.askPoint(`Click the middle of ${line.name}: it is followed anew from here on.`, (point) => {
      this.send({ type: "correct", target: line.id, ...point });
    });
  }

  toggle() {
    this.send({ type: this.state && this.state.playing ? "pause" : "play" });
  }

  step(frames) {
    this.send({ type: "step", frames });
  }

  seek(index) {
    this.index = Math.min(Math.max(Math.round(index), 0), this.state.last);
    this.send({ type: "seek", index: this.index });
    this.draw();
  }

  grab(event) {
    if (!this.state || event.button) return;
    try { this.canvas.setPointerCapture(event.pointerId); } catch { /* a pointer that is gone already */ }
    this.wanted = this.at(event);
    this.resume = Boolean(this.state.playing);
    if (this.resume) this.send({ type: "pause" });
    this.seek(this.wanted);
  }

  // One message for each frame of the screen at most.
  drag(event) {
    if (this.wanted === null) return;
    const before = this.wanted;
    this.wanted = this.at(event);
    if (this.wanted === before || this.waiting) return;
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null;
      if (this.wanted !== null) this.seek(this.wanted);
    });
  }

  letGo() {
    if (this.wanted === null) return;
    if (this.wanted !== this.index) this.seek(this.wanted);
    this.wanted = null;
    if (this.resume) this.send({ type: "play" });
  }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const share = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
    return Math.min(Math.floor(share * (this.state.end + 1)), this.state.end);
  }

  key(event) {
    if (this.root.hidden || !this.state || event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    const on = event.target instanceof Element ? event.target : document.body;
    if (on.matches(TYPING) || document.querySelector("dialog[open]")) return;
    const far = Math.max(1, Math.round(PAGE * this.state.end));
    const here = on === this.canvas;
    if (event.key === "ArrowRight" || event.key === ".") this.step(event.shiftKey ? FAR : 1);
    else if (event.key === "ArrowLeft" || event.key === ",") this.step(event.shiftKey ? -FAR : -1);
    else if (event.key === " " && !on.matches(PRESSING)) { if (!event.repeat) this.toggle(); }
    else if (event.key === "Home") this.seek(0);
    else if (event.key === "End") this.seek(this.state.last);
    else if (here && event.key === "PageDown") this.step(far);
    else if (here && event.key === "PageUp") this.step(-far);
    else return;
    event.preventDefault();
  }

  draw() {
    const { state } = this;
    if (!state || this.root.hidden) return;
    const line = this.line();
    const shown = this.wanted === null ? state.index : this.index;
    drawLine(this.canvas, { end: state.end, last: state.last, shown, runs: line ? line.line || [] : [], color: colorOf(line?.id ?? 1) });
    this.lines.show((state.targets || []).map((target) => lifeOfVideo(target, state.end)), line?.id);
    this.courses.showAt((shown + 0.5) / (state.end + 1));
    const length = state.complete ? clock(state.duration || 0) : `${(100 * (state.last + 1) / (state.end + 1)).toFixed(0)} % read`;
    const words = `${clock(state.time || 0)} / ${length} · frame ${shown} of ${state.end}${state.waiting ? " · waits for the tracking" : ""}`;
    if (this.time.textContent === words) return;
    this.time.textContent = words;
    this.canvas.setAttribute("aria-valuemax", state.end);
    this.canvas.setAttribute("aria-valuenow", shown);
    this.canvas.setAttribute("aria-valuetext", words);
  }
}

const clock = (seconds) => `${Math.floor(seconds / 60)}:${(seconds % 60).toFixed(2).padStart(5, "0")}`;
const duration = (seconds) => (seconds < 90 ? `${Math.ceil(seconds)} s` : `${Math.ceil(seconds / 60)} min`);
