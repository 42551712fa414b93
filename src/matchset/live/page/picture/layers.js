// The switches of what is drawn over the picture. They stay as they were left, in this browser.

const KEY = "matchset layers";

export function wireLayers(root, picture) {
  const boxes = [...root.querySelectorAll("input[data-layer]")];
  const kept = remembered();
  for (const box of boxes) {
    const { layer } = box.dataset;
    if (layer in kept) box.checked = kept[layer];
    const apply = () => {
      if (layer !== "mask") picture.show[layer] = box.checked;
      else if (picture.wantsMask !== box.checked) { picture.wantsMask = box.checked; picture.remask(); }
      picture.redraw();
    };
    apply();
    box.addEventListener("change", () => {
      apply();
      remember(Object.fromEntries(boxes.map((each) => [each.dataset.layer, each.checked])));
    });
  }
}

function remembered() {
  try { return JSON.parse(localStorage.getItem(KEY)) || {}; } catch { return {}; } // switched off in this browser
}

function remember(values) {
  try { localStorage.setItem(KEY, JSON.stringify(values)); } catch { /* then they are forgotten */ }
}
