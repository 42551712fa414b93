"""Draw the chain of three in flight, animated: `python docs/pictures/chain.py`, from the root of the repository."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from matchset.app.drawing.text import draw_text, text_width
from matchset.app.progress import progress_bar
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.report.picture import annotate_step
from matchset.flight.report.top_view import INK, TopView
from matchset.links.simulation_parameters import FPS, SimulationParameters

Picture = npt.NDArray[np.uint8]

SEED, DURATION, BEGIN = 104, 14.0, 4.0  # s; the picture begins where the start is over
EVERY = 4  # steps
CELL, CORNER, MAP = (420, 300), (70, 50), (840, 310)  # px: a part of each camera's picture as it is, not shrunk
LETTERS = 20  # px; to be read where the picture is as wide as a phone
QUALITY, METHOD = 36, 4
LARGEST = 3_000_000  # bytes


def scene(chain_step: ChainStep, setup: FlightSetup, top: TopView) -> Picture:
    """Put the two cameras side by side, and the chain from above below."""
    cells = []
    for number, (step, camera) in enumerate(zip(chain_step.steps, setup.cameras, strict=True), 1):
        picture = annotate_step(step, number, camera, setup.radius, captions=False)
        cell = np.ascontiguousarray(picture[CORNER[1] :, CORNER[0] :][: CELL[1], : CELL[0]])
        cell[: 2 * LETTERS] //= 3
        draw_text(cell, f"camera of {number}: it follows {number + 1}", (10, LETTERS), LETTERS)
        cells.append(cell)
    view = top.draw(chain_step)
    last = f"{len(setup.cameras) + 1} hangs on a rope"
    draw_text(view, last, (MAP[0] - text_width(last, LETTERS) - 14, MAP[1] - 1.2 * LETTERS), LETTERS, INK)
    return np.vstack((np.hstack(cells), view))


def main() -> None:
    """Fly, and write docs/pictures/chain.webp."""
    pictures = []
    world = SimulationParameters(vehicles=3, seed=SEED)
    with (
        Flight(FlightParameters(duration=DURATION, world=world)) as flight,
        progress_bar("flying", flight.length) as bar,
    ):
        setup = flight.setup
        top = TopView(setup, MAP)
        for chain_step in flight:
            bar.advance()
            picture = scene(chain_step, setup, top)  # also those that are not shown: the map remembers paths
            if chain_step.index % EVERY == 0 and chain_step.time >= BEGIN:
                pictures.append(Image.fromarray(np.ascontiguousarray(picture[..., ::-1])))
    target = Path(__file__).with_name("chain.webp")
    first, *others = pictures
    duration_ms = round(1000.0 * EVERY / FPS)
    first.save(
        target, save_all=True, append_images=others, duration=duration_ms, loop=0, quality=QUALITY, method=METHOD
    )
    size = target.stat().st_size
    print(f"{target}: {len(pictures)} pictures, {size // 1000} kB")
    if size > LARGEST:
        raise SystemExit(f"more than {LARGEST // 1000} kB: lower QUALITY")


if __name__ == "__main__":
    main()
