"""Find light round things in a gray picture, best first: python examples/detect_coins.py [PICTURE]."""

import sys
from pathlib import Path

import cv2
import numpy as np

import matchset as ms

given = sys.argv[1] if len(sys.argv) > 1 else ""
path = Path(given) if given else Path(__file__).resolve().parents[2] / "shared/data/stills/skimage_coins.png"
if path.exists():
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
else:
    picture = np.full((240, 320), 60, np.uint8)
    for center, axes in (((70, 70), (30, 30)), ((170, 90), (40, 38)), ((250, 180), (25, 24))):
        cv2.ellipse(picture, center, axes, 20, 0, 360, 170, -1, cv2.LINE_AA)
if picture is None:
    sys.exit(f"error: {path} is not a picture")

for track in ms.detect(ms.Frame(np.asarray(picture, np.uint8)), ms.Ellipse, ms.ColorModel.light(), limit=30):
    coin = track.shape
    print(f"x {coin.x:.1f}  y {coin.y:.1f}  {coin.a:.1f} × {coin.b:.1f} px, {track.support:.0%} of it confirmed")
