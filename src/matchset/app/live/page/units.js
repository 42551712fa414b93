// Lengths as people type them, and numbers as people read them.

const METERS = { mm: 0.001, cm: 0.01, m: 1, in: 0.0254, '"': 0.0254 };
const LARGEST = 20; // m

export function parseLength(text) {
  const match = /^\s*(\d+(?:[.,]\d+)?|[.,]\d+)\s*(mm|cm|m|in|")?\s*$/.exec(text);
  if (!match) throw new Error(`"${text}" is no length: type 28 cm, 0.28 m, 280 mm or 11 in`);
  if (!match[2]) throw new Error(`${text.trim()} of what? Type the unit: mm, cm, m or in`);
  const meters = parseFloat(match[1].replace(",", ".")) * METERS[match[2]];
  if (!(meters > 0 && meters <= LARGEST)) throw new Error(`a diameter is more than 0 and at most ${LARGEST} m, not ${text.trim()}`);
  return meters;
}

// Decimal points below each other: those with fewer digits end with spaces as wide as digits.
export function aligned(words, decimals) {
  const [, found = ""] = words.split(".");
  if (!words || found.length >= decimals) return words;
  return words + (found ? "" : "\u2008") + "\u2007".repeat(decimals - found.length);
}

// What a picture took, ms: three digits, two decimals at most.
export function times(computing) {
  if (!computing || computing.median === undefined) return "";
  const { median, mean, percentile_95: most, worst } = computing;
  const [a, b, c, d] = [median, mean, most, worst].map((value) => value.toFixed(value < 9.995 ? 2 : value < 99.95 ? 1 : 0));
  return `median ${a}, mean ${b}, 95 % ${c}, worst ${d} ms`;
}

// As many digits as the standard deviation makes sense of: up to its leading one, and four at most.
export function measured(value, sigma) {
  if (!(sigma > 0)) return [value.toFixed(2), ""];
  const digits = Math.min(Math.max(-Math.floor(Math.log10(sigma * 1.05)), 0), 4);
  return [value.toFixed(digits), `±${Math.max(sigma, 10 ** -digits).toFixed(digits)}`];
}
