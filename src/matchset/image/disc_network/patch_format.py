"""What a patch is: its places, its numbers, and the histograms of colors. The weights were learned for all of these."""

import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.uint8]
Patch = npt.NDArray[np.float32]
Colors = npt.NDArray[np.float32]
Circle3 = tuple[float, float, float]

RAYS, PLACES, NUMBERS = 64, 32, 6  # format: of a patch
SIZE = 20.0  # format: radius to which larger circles are reduced, px
NEAREST, FARTHEST = 0.3, 1.7  # format: first and last place of a ray, radii
MIDDLE, INSIDE, AROUND = 0.7, 0.85, 1.2  # format: places of the median color and of the two histograms, radii
BINS_L, BINS_AB = 16, 24  # format: bins of a histogram along L, and along a and b
COLORS = BINS_L * BINS_AB * BINS_AB  # format: bins of a histogram
PER_L, PER_AB = BINS_L / 100.0, BINS_AB / 128.0  # format: bins for a unit of CIE Lab
LOW_AB = -64.01  # format: first a and b; a little below -64, so that gray is not on the border of two bins
FLOOR, MOST = 5e-4, 4.0  # format: share added to each color, and the log-odds that count as 1
LAB_UNIT, LEAST_SPREAD, SPREAD = 0.02, 0.08, 0.7  # format: of the colors
KNOWN_ROUNDS = 4, 2, 2  # format: how often colors of another picture are blurred along L, a, b: its light was another
ROOM = 1.8  # geometry: how far the picture is cut out around the circle, radii
LEAST_SIDE = 4  # format: of that, px

ANGLES = 2.0 * np.pi * np.arange(RAYS) / RAYS  # geometry: of the rays, rad
DIRECTIONS = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
RADII = np.linspace(NEAREST, FARTHEST, PLACES)
