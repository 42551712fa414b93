// The time line of a video: where the target was found (high bar), lost (low bar), not tracked yet (thin line).
// Not by color alone: the heights differ as well.

const [, FOUND, LOST] = [0, 1, 2]; // as the server says it

// `runs` is a code and for how many columns it holds, and so on; the columns share the width evenly.
export function drawLine(canvas, { end, last, shown, runs, color: own }) {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (!width || !height) return;
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const context = canvas.getContext("2d");
  const style = getComputedStyle(canvas);
  const color = (name) => style.getPropertyValue(name);
  context.clearRect(0, 0, width, height);
  const middle = height / 2;
  const read = width * (last + 1) / (end + 1);
  context.fillStyle = color("--line-unknown");
  context.fillRect(0, middle - 2 * ratio, read, 4 * ratio);
  for (let x = read; x < width; x += 8 * ratio) context.fillRect(x, middle - ratio, 3 * ratio, 2 * ratio); // not read yet
  const count = runs.reduce((sum, value, at) => (at % 2 ? sum + value : sum), 0);
  // Where a column of pixels holds several runs a loss is on top: short ones stay visible.
  for (const wanted of [FOUND, LOST]) {
    context.fillStyle = wanted === FOUND ? own : color("--line-lost");
    let at = 0;
    for (let i = 0; i < runs.length; i += 2) {
      const from = Math.floor(at / count * width);
      at += runs[i + 1];
      if (runs[i] !== wanted) continue;
      const wide = Math.max(Math.ceil(at / count * width) - from, ratio);
      const high = wanted === FOUND ? height * 0.56 : height * 0.3;
      const top = wanted === FOUND ? height * 0.22 : height * 0.48;
      if (wanted === LOST) context.clearRect(from, height * 0.2, wide, height * 0.6);
      context.fillRect(from, top, wide, high);
      if (wanted !== FOUND) continue;
      context.fillStyle = color("--line-unknown"); // an edge: light colors on a light ground
      for (const y of [top, top + high - ratio]) context.fillRect(from, y, wide, ratio);
      context.fillStyle = own;
    }
  }
  const x = (shown + 0.5) / (end + 1) * width;
  context.fillStyle = color("--line-page");
  context.fillRect(x - 3 * ratio, 0, 6 * ratio, height);
  context.fillStyle = color("--line-head");
  context.fillRect(x - 1.5 * ratio, 0, 3 * ratio, height);
}
