// What the curves have in common: how far their axis reaches, and a line at each of its round numbers. Depths from above.

import { palette, ticks } from "../canvas.js";

export const BAND = 2; // standard deviations
export const LEFT = 4.9; // letters, the width of the numbers on the left
export const NAMES = { radius: "r" };
export const UNITS = { angle: "rad", scale: "" };

// Draws the path in a target's color, with an edge so that it is seen on any ground.
export function strokeIn(context, color, width) {
  for (const [style, wide, alpha] of [[palette.ink, 1.6, 0.45], [color, 1, 1]]) {
    context.strokeStyle = style;
    context.lineWidth = wide * width;
    context.globalAlpha = alpha;
    context.stroke();
  }
  context.globalAlpha = 1;
}

// Where a curve is on its canvas.
export function frameOf({ width, height, ratio, text }) {
  return { left: LEFT * text, right: width - ratio, top: 2.2 * text, bottom: height - 1.5 * text };
}

// The least and the largest value with a margin; each sample has low, high and sigma, NaN or null where it was lost.
export function rangeOf(samples) {
  let [least, most] = [Infinity, -Infinity];
  for (const { low, high, sigma } of samples) {
    if (low === null || Number.isNaN(low)) continue;
    least = Math.min(least, low - BAND * (sigma || 0));
    most = Math.max(most, high + BAND * (sigma || 0));
  }
  if (!(most >= least)) return [0, 1];
  const margin = Math.max((most - least) * 0.08, Math.abs(most) * 1e-4, 1e-4);
  return [least - margin, most + margin];
}

// Lines across the frame, and the words at both ends of the time axis; `y` tells where on the canvas a value is.
export function drawGrid(context, frame, { ratio, text, width, height }, [least, most], y, [first, last]) {
  context.lineWidth = ratio;
  context.strokeStyle = palette.line;
  context.fillStyle = palette.soft;
  context.textAlign = "right";
  for (const { value, words } of ticks(least, most, (frame.bottom - frame.top) / (1.9 * text))) {
    const at = Math.round(y(value)) + 0.5;
    drawLine(context, frame.left, frame.right, at);
    context.fillText(words, frame.left - 0.5 * text, at + 0.35 * text);
  }
  context.fillText(last, width, height - 0.25 * text);
  context.textAlign = "left";
  context.fillText(first, frame.left, height - 0.25 * text);
}

// Seen from above: lines across the canvas at distances up to `deep`, m; the camera is at `foot`, `scale` is px in a meter.
export function drawDepths(context, { width, ratio, text }, deep, foot, scale) {
  context.lineWidth = ratio;
  context.strokeStyle = palette.line;
  context.fillStyle = palette.soft;
  for (const { value, words } of ticks(0, deep, foot / (2.2 * text))) {
    const at = Math.round(foot - value * scale) + 0.5;
    if (!value || at < 2.4 * text) continue;
    drawLine(context, 0, width, at);
    context.fillText(words, 0, at - 0.25 * text);
  }
}

function drawLine(context, from, to, y) {
  context.beginPath();
  context.moveTo(from, y);
  context.lineTo(to, y);
  context.stroke();
}
