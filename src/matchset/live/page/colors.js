// Colors of the targets, distinguishable for the color-blind (Okabe and Ito), light enough on a dark picture.
export const COLORS = ["#56b4e9", "#e69f00", "#009e73", "#f0e442", "#cc79a7", "#d55e00", "#0072b2"];

export const colorOf = (id) => COLORS[(id - 1) % COLORS.length];
