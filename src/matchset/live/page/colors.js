// Colors of the targets by their numbers: first those of Okabe and Ito, distinguishable for the color-blind, light enough
// on a dark picture; then more, so that each of twenty targets has its own.
export const COLORS = [
  "#56b4e9", "#e69f00", "#009e73", "#f0e442", "#cc79a7", "#d55e00", "#0072b2",
  "#b2df8a", "#9a6fd0", "#fb9a99", "#a5713c", "#00c8cf", "#ef3340", "#d9c7ff",
  "#8f9400", "#5b7cff", "#ff66ff", "#8fe000", "#9fb3c2", "#ffd0a0",
];

export const colorOf = (id) => COLORS[(id - 1) % COLORS.length];
