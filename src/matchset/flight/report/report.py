"""The report of a flight: one HTML file with all its plots inside: `write_report` (decision 062)."""

import base64
import html
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2

from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.fly.log import EXPLANATIONS, HEADINGS, UNTRUE, FlightLog, flight_summary, follower_row
from matchset.flight.report.parameter_table import ParameterRow, parameter_rows
from matchset.flight.report.picture import annotate_step
from matchset.image.files.whole_file import write_whole

# format: of the pictures of the flight: quality, and colors as sharp as brightness, for thin outlines
JPEG = (cv2.IMWRITE_JPEG_QUALITY, 80, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444)
STYLE = """
:root { color-scheme: light dark; --text: #2b2b2b; --quiet: #666; --line: #e4e4e4; --page: #fff; --accent: #b34a00; }
@media screen and (prefers-color-scheme: dark) {
:root { --text: #dcdcdc; --quiet: #a3a3a3; --line: #34373c; --page: #17191c; --accent: #ff9a57; } }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, 'DejaVu Sans', sans-serif; color: var(--text); background: var(--page);
max-width: 1180px; margin: 0 auto; padding: 1em; overflow-wrap: break-word; }
h1 { font-size: 1.5em; margin: 0.4em 0; } h2 { font-size: 1.15em; margin: 1.8em 0 0.4em; }
.quiet, figcaption, small { color: var(--quiet); } small { display: block; font-size: 0.8em; line-height: 1.25; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 0.92em; }
td, th { text-align: right; vertical-align: top; padding: 0.35em 0 0.35em 1.2em; border-bottom: 1px solid var(--line); }
th { font-weight: normal; } td:first-child, th:first-child { text-align: left; padding-left: 0; }
thead th { font-weight: 600; white-space: nowrap; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 500px), 1fr)); gap: 1.2em 2em; }
figure { margin: 0; break-inside: avoid; } figure > svg, figure > img { display: block; width: 100%; height: auto; }
figure > svg * { stroke-linejoin: round; }
summary { cursor: pointer; padding: 0.5em 0; } .parameters td { text-align: left; padding-left: 1em; }
.parameters td:first-child { padding-left: 0; } .changed td:first-child { color: var(--accent); font-weight: 600; }
@media (max-width: 600px) { .parameters td:nth-child(4) { display: none; } }
@media print { body { font-size: 11px; max-width: none; padding: 0; } .plots { grid-template-columns: 1fr 1fr; } }
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
    titles = {"simulated": "A flight of the chain", "flight": "A flight", "dry run": "A dry run: no throttle was sent"}
    parts = [
        "<!doctype html><html lang=en><meta charset=utf-8>",
        '<meta name=viewport content="width=device-width, initial-scale=1"><title>matchset: a flight</title>',
        f"<style>{STYLE}</style><h1>{titles[log.setup.kind]}</h1>",
        f"<p>{html.escape(flight_summary(log))}.<br><span class=quiet>{html.escape(_conditions(log.setup))}</span></p>",
    ]
    if log.shown is not None:
        parts.append(_pictures(log, log.shown))
    meanings = EXPLANATIONS if log.setup.has_truth else [UNTRUE.get(each, each) for each in EXPLANATIONS]
    parts.append(_figures_table([follower_row(log, number) for number in range(len(log.followers))], meanings))
    if log.gains.lowered:
        items = "".join(f"<li>{html.escape(line)}" for line in log.gains.lines())
        parts.append(f"<h2>Gains that were lowered</h2><ul>{items}</ul>")
    if log.counters.chain_steps:
        parts += _plots(log)
    rows = parameter_rows(log.setup.parameters)
    parts.append(_parameters([row for row in rows if log.setup.has_truth or not row.key.startswith("world.")]))
    return "\n".join([*parts, "</html>\n"])


def _conditions(setup: FlightSetup) -> str:
    """Say in which world it flew, or with which devices."""
    world = setup.parameters.world
    if not setup.has_truth:
        return "; ".join(f"vehicle {number}: {words}" for number, words in enumerate(setup.devices, 1))
    return f"{world.vehicles} vehicles, seed {world.seed}, {world.pal} link, latency {world.latency_ms:g} ms"


def _pictures(log: FlightLog, shown: ChainStep) -> str:
    """Show one step of the flight: every camera's picture with what was found in it."""
    figures = []
    for number, (step, camera) in enumerate(zip(shown.steps, log.setup.cameras, strict=True), 1):
        image = annotate_step(step, number, camera, log.setup.radius, captions=False)
        jpeg = cv2.imencode(".jpg", image, JPEG)[1].tobytes()
        words = f"{number} watches {number + 1} at {shown.time:.1f} s: outline, match-set and axes as measured"
        data = base64.b64encode(jpeg).decode()
        figures.append(
            f'<figure><img alt="camera of vehicle {number}" width={camera.width} height={camera.height} '
            f'src="data:image/jpeg;base64,{data}"><figcaption>{words}</figcaption></figure>'
        )
    return f"<div class=plots>{''.join(figures)}</div>"


def _plots(log: FlightLog) -> list[str]:
    """Draw the plots; Matplotlib is loaded only now."""
    from matchset.app.drawing.plot_style import color_rules
    from matchset.flight.report import plots

    numbers = range(len(log.followers))
    parts = [f"<style>{color_rules('figure > svg')}</style>"]
    paths = {"room": plots.room_figure(log)} if log.setup.has_truth else {}
    parts.append(_section("Paths from above", {**paths, "chain": plots.chain_figure(log)}))
    coordinates = {f"follower{k + 1}": plots.coordinates_figure(log, k) for k in numbers}
    parts.append(_section("Side, height and heading over time", coordinates))
    errors = {"circle": plots.circle_error_figure(log)} if log.setup.has_truth else {}
    if any(len(log.position_error(k)) for k in numbers):
        errors["place"] = plots.place_error_figure(log)
    if errors:
        parts.append(_section("Errors", errors))
    times = {"age": plots.age_figure(log), "computing": plots.computing_figure(log)}
    return [*parts, _section("Age, losses and computing time", times)]


def _section(title: str, figures: dict[str, Any]) -> str:
    """Write a section with its plots, Matplotlib figures by name."""
    from matchset.app.drawing.plot_style import svg_of

    drawn = "".join(
        f'<figure role=img aria-label="{name}">{svg_of(figure, name, inside=True)}</figure>'
        for name, figure in figures.items()
    )
    return f"<h2>{title}</h2><div class=plots>{drawn}</div>"


def _figures_table(rows: Sequence[Sequence[str]], meanings: Sequence[str]) -> str:
    """Write the figures of the followers: a column for each, so that few of them fit a phone."""
    names, *lines = zip(HEADINGS, meanings, *rows, strict=True)
    head = "".join(f"<th>{html.escape(name)}</th>" for name in ("", *names[2:]))
    body = "".join(
        f"<tr><th>{html.escape(heading)}<small>{html.escape(explanation)}</small></th>"
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for heading, explanation, *cells in lines
    )
    return f"<h2>Figures</h2><div class=wide><table><thead><tr>{head}</tr></thead>{body}</table></div>"


def _parameters(rows: Sequence[ParameterRow]) -> str:
    """Write the parameters, folded away; those that are not the defaults stand out."""
    changed = sum(row.changed for row in rows)
    body = "".join(
        f"<tr{' class=changed' if row.changed else ''}>"
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in (row.key, row.value, row.unit, row.meaning))
        + "</tr>"
        for row in rows
    )
    words = f"All {len(rows)} of them, {changed} changed from the defaults, in color"
    return (
        f"<h2>Parameters</h2><details><summary>{words}</summary><div class=wide><table class=parameters>"
        "<thead><tr><td>key</td><td>value</td><td>unit</td><td>meaning</td></tr></thead>"
        f"{body}</table></div></details>"
    )
