// A canvas that knows its size in pixels of the screen, and the colors of the page, without asking for them each frame.

const NAMES = ["ink", "soft", "line", "accent", "warn", "panel"];
export const palette = {};

function readPalette() {
  const style = getComputedStyle(document.documentElement);
  for (const name of NAMES) palette[name] = style.getPropertyValue(`--${name}`).trim();
  palette.text = parseFloat(style.fontSize) * 0.8; // CSS px
}

readPalette();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", readPalette);
addEventListener("resize", readPalette);

export class Surface {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.width = this.height = 0;
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  resize() {
    this.ratio = devicePixelRatio || 1;
    this.width = this.canvas.width = Math.round(this.canvas.clientWidth * this.ratio);
    this.height = this.canvas.height = Math.round(this.canvas.clientHeight * this.ratio);
    if (this.redraw) this.redraw();
  }

  // Cleared, with the font set; in pixels of the screen.
  begin() {
    const { context, ratio } = this;
    context.clearRect(0, 0, this.width, this.height);
    this.text = Math.round(palette.text * ratio);
    context.font = `${this.text}px system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif`;
    context.textAlign = "left";
    context.lineJoin = "round";
    context.globalAlpha = 1;
    return context;
  }
}

// Round numbers between two values, about as many as `count`, with as many digits as their step needs.
export function ticks(least, most, count) {
  const raw = (most - least) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((each) => each >= raw * 0.999);
  const digits = Math.max(0, -Math.floor(Math.log10(step * 1.001)));
  const found = [];
  for (let i = Math.ceil(least / step); i * step <= most; i++) found.push({ value: i * step, words: (i * step).toFixed(digits) });
  return found;
}
