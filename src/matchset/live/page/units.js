// Lengths as people type them, and numbers as people read them.

const METERS = { mm: 0.001, cm: 0.01, m: 1, in: 0.0254, '"': 0.0254 };
const LARGEST = 20; // m
const PLUS_MINUS = /±|\+\/?-/;

export function parseLength(text) {
  const match = /^\s*(\d+(?:[.,]\d+)?|[.,]\d+)\s*(mm|cm|m|in|")?\s*$/.exec(text);
  if (!match) throw new Error(`"${text}" is no length: type 28 cm, 0.28 m, 280 mm or 11 in`);
  if (!match[2]) throw new Error(`${text.trim()} of what? Type the unit: mm, cm, m or in`);
  const meters = parseFloat(match[1].replace(",", ".")) * METERS[match[2]];
  if (!(meters > 0 && meters <= LARGEST)) throw new Error(`a diameter is more than 0 and at most ${LARGEST} m, not ${text.trim()}`);
  return meters;
}

// "28 cm ± 2 mm", "28 ± 0.2 cm": a length and its standard deviation, m; 0 where none is typed.
export function parseMeasured(text) {
  const [typed, spread, more] = text.split(PLUS_MINUS);
  if (!typed.trim() || !spread?.trim() || more !== undefined) return [parseLength(text), 0];
  const unit = /[^\d.,\s]*\s*$/.exec(spread)[0];
  return [parseLength(/[a-z"]\s*$/.test(typed) ? typed : typed + unit), parseLength(spread)];
}

// "60 ± 3": an angle and its standard deviation, degrees; 0 where none is typed.
export function parseDegrees(text) {
  const [degrees, spread = 0] = text.replaceAll(",", ".").split(PLUS_MINUS).map(parseFloat);
  if (!(degrees > 5 && degrees < 175)) throw new Error("type an angle between 5 and 175 degrees, such as 60");
  if (!(spread >= 0 && spread < degrees)) throw new Error("after ± comes how well it is known, such as 60 ± 3");
  return [degrees, spread];
}

// A name where there is little room, cut between letters.
export const shortened = (name) => ([...name].length > 24 ? `${[...name].slice(0, 23).join("")}…` : name);

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
