"""Draw the chain of three in flight, animated: `python docs/pictures/chain.py`, from the root of the repository."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image

from matchset.app.drawing.text import draw_text
from matchset.app.flight.flight import ChainStep, Flight, FlightParameters, FlightSetup, flight_setup
from matchset.app.flight_report.picture import annotate_step
from matchset.app.flight_report.top_view import TopView
from matchset.app.progress import progress_bar
from matchset.links.simulated import FPS, SimulationParameters

Picture = npt.NDArray[np.uint8]

SEED, DURATION, BEGIN = 104, 14.0, 4.0  # s; the picture begins where the start is over
EVERY = 3  # steps
CELL, MAP = (420, 315), (840, 330)  # px
QUALITY, METHOD = 42, 3
LARGEST = 3_000_000  # bytes


def scene(chain_step: ChainStep, setup: FlightSetup, top: TopView) -> Picture:
    """Put the two cameras side by side, and the chain from above below."""
    cells = []
    for number, (step, camera) in enumerate(zip(chain_step.steps, setup.cameras, strict=True), 1):
        picture = annotate_step(step, number, camera, setup.radius, captions=False)
        cell = np.asarray(cv2.resize(picture, CELL, interpolation=cv2.INTER_AREA), np.uint8)
        draw_text(cell, f"camera of {number}", (10, 16), 15)
        cells.append(cell)
    return np.vstack((np.hstack(cells), top.draw(chain_step)))


def main() -> None:
    """Fly, and write docs/pictures/chain.webp."""
    pictures = []
    world = SimulationParameters(vehicles=3, seed=SEED)
    with (
        Flight(FlightParameters(duration=DURATION, world=world)) as flight,
        progress_bar("flying", flight.length) as bar,
    ):
        setup = flight_setup(flight)
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
