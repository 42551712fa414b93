"""The report of a flight: one HTML file with all its plots inside: `write_report` (decision 062)."""

import base64
import html
from collections.abc import Iterable
from pathlib import Path

import msgspec

from matchset.app.flight.log import HEADINGS, FlightLog, flight_summary, follower_row
from matchset.image.files.whole_file import write_whole

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #333; max-width: 1180px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.1em; margin-top: 2em; }
table { border-collapse: collapse; font-size: 0.87em; } th { font-weight: normal; color: #777; vertical-align: bottom; }
td, th { text-align: right; padding: 0.3em 0.8em; border-bottom: 1px solid #eee; }
td:first-child, th:first-child { text-align: left; white-space: nowrap; } img { width: 100%; } .quiet { color: #777; }
"""


def write_report(log: FlightLog, path: Path) -> None:
    """Write the report; an error leaves no incomplete file under its name.

    Parameters
    ----------
    log : FlightLog
    path : Path
        A name that ends in .html; overwritten.
    """
    write_whole(path, _page(log).encode())


def _page(log: FlightLog) -> str:
    world = log.setup.parameters.world
    conditions = f"{world.vehicles} vehicles, seed {world.seed}, {world.pal} link, latency {world.latency_ms:g} ms"
    parts = [
        "<!doctype html><html lang=en><meta charset=utf-8><title>matchset: a flight</title>",
        f"<style>{STYLE}</style><h1>A flight of the chain</h1>",
        f"<p>{html.escape(flight_summary(log))}.<br><span class=quiet>{html.escape(conditions)}</span></p>",
        _table(HEADINGS, (follower_row(log, number) for number in range(len(log.followers)))),
    ]
    if log.counters.chain_steps:
        parts += _plots(log)
    parts.append("<h2>Parameters</h2>")
    parts.append(_table(("key", "value"), _flat("", msgspec.to_builtins(log.setup.parameters))))
    return "\n".join([*parts, "</html>\n"])


def _plots(log: FlightLog) -> list[str]:
    """Draw the plots; Matplotlib is loaded only now."""
    from matchset.app.flight_report.plots import coordinates_png, errors_png, paths_png, times_png

    parts = ["<h2>Paths from above</h2>", _image(paths_png(log), "paths from above")]
    parts.append("<h2>Side, height and heading over time</h2>")
    numbers = range(len(log.followers))
    parts += [_image(coordinates_png(log, k), f"coordinates of follower {k + 1}") for k in numbers]
    parts += ["<h2>Errors</h2>", _image(errors_png(log), "histograms of errors")]
    return [*parts, "<h2>Age, losses and computing time</h2>", _image(times_png(log), "age and computing time")]


def _image(png: bytes, description: str) -> str:
    return f'<img alt="{description}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'


def _table(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in headings)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _flat(name: str, value: object) -> Iterable[tuple[str, str]]:
    """Yield the keys and values of nested parameters: ``pilot.place.height``."""
    if not isinstance(value, dict):
        yield name, str(value)
        return
    for key, each in value.items():
        yield from _flat(f"{name}.{key}" if name else key, each)
