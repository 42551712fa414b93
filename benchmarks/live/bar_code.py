"""The time of capture drawn into a picture, to be read back from a screen: `stamp`, `READ`."""

import numpy as np
import numpy.typing as npt

BITS = 32  # geometry: milliseconds on the clock of the computer, without the highest bits
SIDE = 16  # geometry: px of a bar

READ = """() => {
  const canvas = document.getElementById("picture");
  if (!canvas.width) return null;
  const side = SIDE * canvas.width / 640;
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, Math.max(1, Math.round(side))).data;
  let code = 0;
  for (let bit = 0; bit < BITS; bit++) {
    const at = 4 * (Math.round(side / 2 - 0.5) * canvas.width + Math.round((bit + 0.5) * side));
    code = code * 2 + (pixels[at + 1] > 127 ? 1 : 0);
  }
  const now = Math.round(performance.timeOrigin + performance.now()) % 2 ** BITS;
  return [code, now - code];
}""".replace("SIDE", str(SIDE)).replace("BITS", str(BITS))
"""JavaScript: code on the page's canvas, and by how many ms it is older than the browser's clock."""


def stamp(image: npt.NDArray[np.uint8], milliseconds: int) -> None:
    """Draw a time along the upper border of a picture 640 px wide.

    Parameters
    ----------
    image : ndarray of shape (h, 640, 3), uint8
        Is changed.
    milliseconds : int
        Since 1970; the lowest 32 bits are drawn.
    """
    for bit in range(BITS):
        value = 255 if milliseconds >> (BITS - 1 - bit) & 1 else 0
        image[:SIDE, bit * SIDE : (bit + 1) * SIDE] = value
