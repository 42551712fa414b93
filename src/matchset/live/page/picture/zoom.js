// Which part of the picture is seen: a scale, and where its upper left corner is, CSS px.

const CLOSEST = 16; // largest scale

export class Zoom {
  constructor(root, layers, onChange) {
    this.root = root;
    this.layers = layers;
    this.onChange = onChange;
    this.scale = 1;
    this.x = this.y = 0;
    new ResizeObserver(() => this.pan(0, 0)).observe(root);
  }

  // Larger by a factor about a point of the window, which stays where it is.
  about([clientX, clientY], factor) {
    const box = this.root.getBoundingClientRect();
    const scale = Math.min(Math.max(this.scale * factor, 1), CLOSEST);
    const [x, y] = [clientX - box.left, clientY - box.top];
    this.x = x - (x - this.x) * scale / this.scale;
    this.y = y - (y - this.y) * scale / this.scale;
    this.scale = scale;
    this.pan(0, 0);
  }

  step(factor) {
    const box = this.root.getBoundingClientRect();
    this.about([box.left + box.width / 2, box.top + box.height / 2], factor);
  }

  pan(x, y) {
    const { clientWidth, clientHeight } = this.root;
    this.x = Math.min(0, Math.max(clientWidth * (1 - this.scale), this.x + x));
    this.y = Math.min(0, Math.max(clientHeight * (1 - this.scale), this.y + y));
    for (const each of this.layers) {
      each.style.transform = `translate(${this.x}px, ${this.y}px) scale(${this.scale})`;
      each.style.imageRendering = this.scale > 3 ? "pixelated" : "";
    }
    this.onChange(this.scale);
  }

  whole() {
    this.scale = 1;
    this.pan(0, 0);
  }

  // From the window to pixels of the picture, whose size is [width, height]; the middle of the first pixel is (0, 0).
  toPicture([clientX, clientY], [width, height]) {
    const box = this.root.getBoundingClientRect();
    const x = (clientX - box.left - this.root.clientLeft - this.x) / this.scale / this.root.clientWidth;
    const y = (clientY - box.top - this.root.clientTop - this.y) / this.scale / this.root.clientHeight;
    return [x * width - 0.5, y * height - 0.5];
  }
}
