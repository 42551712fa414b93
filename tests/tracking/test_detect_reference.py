"""The detector against exhaustion (Epstein & Feldman, Alg. 2) on small binary pictures."""

import itertools

import numpy as np
import pytest

import matchset as ms
from matchset import reference
from matchset.reference import Edges, Mask
from naive import disc

WHITE = ms.ColorModel(np.where(np.arange(256) > 127, 4.0, -4.0).astype(np.float32))
MARGIN, NABLA, EPS = 3, 2, 0.5


def picture(seed: int) -> tuple[Mask, ms.Circle]:
    """One white disc, wholly or mostly in the picture, specks of noise, and its circle."""
    rng = np.random.default_rng(seed)
    height, width = (int(size) for size in rng.integers(48, 97, 2))
    radius = float(rng.uniform(8.0, 0.45 * min(height, width)))
    x, y = rng.uniform(0.8 * radius, np.array([width, height]) - 0.8 * radius).tolist()
    specks = rng.random((height, width)) < rng.choice([0.0, 0.01, 0.03])
    return disc(x, y, radius, (height, width)) ^ specks, ms.Circle(x, y, radius)


def size(edges: Edges, circle: ms.Circle) -> int:
    return int(np.count_nonzero(reference.match_set(edges, circle, EPS)))


def largest_beside(edges: Edges, circle: ms.Circle) -> int:
    """Largest match-set of the circles of whole numbers less than a pixel away."""
    numbers = ([int(np.floor(value)), int(np.ceil(value))] for value in (circle.x, circle.y, circle.radius))
    return max(size(edges, ms.Circle(*each)) for each in itertools.product(*numbers) if each[2] > 0)


@pytest.mark.parametrize("seed", range(30))
def test_the_match_set_is_as_large_as_exhaustion_finds(seed: int) -> None:
    image, truth = picture(seed)
    found = ms.detect(ms.Frame(np.where(image, 255, 0).astype(np.uint8)), ms.Circle, WHITE)
    exhausted = reference.init_circle(image, MARGIN, NABLA, EPS)
    assert found
    assert exhausted is not None
    assert reference.error(found[0].shape, truth) < 1.0
    edges = reference.edge_points(image, MARGIN, NABLA)
    assert largest_beside(edges, found[0].shape) >= len(exhausted[1])
