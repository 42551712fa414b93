// What the followers see, side by side: one picture for each, with the outline of the ball that it follows.

import { drawTarget } from "../picture/drawing.js";
import { element } from "../reading/reading.js";

const SVG = "http://www.w3.org/2000/svg";
const OLD = 500; // ms without a new picture, after which a veil says so
const COLORS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]; // those of the flight's report

const DRAWN = { outline: true, marker: true, axes: true };

export const vehicleColor = (index) => COLORS[index % COLORS.length];

export class FollowerPicture {
  constructor(index) {
    this.root = element("figure", "follower");
    this.canvas = document.createElement("canvas");
    this.context = this.canvas.getContext("2d");
    this.drawing = document.createElementNS(SVG, "svg");
    this.drawing.setAttribute("aria-hidden", "true");
    this.color = vehicleColor(index + 1);
    this.veil = element("p", "veil");
    this.view = element("div", "follower-view");
    this.view.append(this.canvas, this.drawing, this.veil);
    this.phase = element("span", "phase");
    const caption = element("figcaption", "");
    const dot = element("span", "dot");
    dot.style.background = vehicleColor(index);
    caption.append(dot, element("span", "", `${index + 1} follows ${index + 2}`), this.phase);
    this.root.append(caption, this.view);
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `what vehicle ${index + 1} sees`);
    this.arrived = this.shown = 0;
    this.fault = "getting ready …"; // until a picture comes, or the server says something else
    this.painted = performance.now();
  }

  // Answers whether it was painted: a newer one may be there already.
  async paint({ jpeg, state }) {
    const turn = ++this.arrived;
    if (jpeg) {
      const bitmap = await createImageBitmap(jpeg);
      if (turn < this.shown) { bitmap.close(); return false; }
      if (this.canvas.width !== bitmap.width || this.canvas.height !== bitmap.height) {
        [this.canvas.width, this.canvas.height] = [bitmap.width, bitmap.height];
      }
      this.context.drawImage(bitmap, 0, 0);
      bitmap.close();
      this.view.style.aspectRatio = `${state.width} / ${state.height}`;
      this.drawing.setAttribute("viewBox", `-0.5 -0.5 ${state.width} ${state.height}`);
    }
    this.shown = turn;
    this.fault = state.fault || "";
    if (!this.fault) this.painted = performance.now();
    const [ball] = state.targets || [];
    this.drawing.replaceChildren(...(ball ? drawTarget(ball, this.color, DRAWN, true) : []));
    this.lost = ball && !ball.found ? `lost: ${ball.reason}` : "";
    return true;
  }

  // Says what is wrong with the picture, if something is.
  refresh() {
    const age = performance.now() - this.painted;
    this.veil.textContent = this.fault || (age > OLD ? `no new picture for ${(age / 1000).toFixed(1)} s` : this.lost);
    this.veil.dataset.kind = this.fault || age > OLD ? "old" : "lost";
    this.veil.hidden = !this.veil.textContent;
  }

  showPhase(phase) {
    this.phase.textContent = phase;
    this.phase.dataset.phase = phase;
  }
}
