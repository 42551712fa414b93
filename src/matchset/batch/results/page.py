"""The page of a batch: counts, a histogram of the shares found, the worst videos with pictures (`write_page`)."""

import html
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol
from urllib.parse import quote

from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.results.store import Store
from matchset.batch.results.worst_picture import worst_picture

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 64rem; padding: 0 1rem; color: #222 }
h1 { font-size: 1.4rem } h2 { font-size: 1.1rem; margin-top: 2rem }
table { border-collapse: collapse } td, th { padding: .2rem .8rem .2rem 0; text-align: left; vertical-align: top }
td.number { text-align: right; font-variant-numeric: tabular-nums }
section { display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: 1rem }
figure { margin: 0; border: 1px solid #ddd; border-radius: 6px; overflow: hidden }
figure img { width: 100%; display: block } figcaption { color: #555; padding: .5rem .7rem; overflow-wrap: anywhere }
svg text { font-size: 12px; fill: #444 }
"""


class Counted(Protocol):
    """What the page shows."""

    states: dict[str, int]
    shares: list[int]
    frames: int
    found: int
    count: int

    @property
    def worst(self) -> list[VideoOutcome]:
        """Those with the smallest share found."""
        ...


def write_page(folder: Path, store: Store, totals: Counted) -> None:
    """Write summary.html, and the pictures that it shows beside it.

    Parameters
    ----------
    folder : Path
        Where to.
    store : Store
        Of the results.
    totals : Totals
    """
    figures = []
    for number, outcome in enumerate(totals.worst, 1):
        picture = folder / f"worst{number:02d}.png"
        shown = f'<img src="{picture.name}" alt="">' if worst_picture(store, outcome, picture) else ""
        figures.append(f"<figure>{shown}<figcaption>{_words(outcome)}</figcaption></figure>")
    share = f"{100.0 * totals.found / totals.frames:.1f} %" if totals.frames else "-"
    rows = "".join(
        f'<tr><td>{html.escape(state)}</td><td class="number">{count:,}</td></tr>'
        for state, count in sorted(totals.states.items())
    )
    body = f"""<h1>{totals.count:,} videos</h1>
<p>A ball was found in {totals.found:,} of {totals.frames:,} frames ({share}).
<a href="videos.csv">videos.csv</a> has a row for each video, <a href="all.csv">all.csv</a> all their rows.</p>
<table><tr><th>what became of it</th><th>videos</th></tr>{rows}</table>
<h2>Share of the frames in which it was found</h2>
{_histogram(totals.shares)}
{f"<h2>The {len(figures)} with the smallest share</h2>" if figures else ""}
<section>{"".join(figures)}</section>"""
    head = f'<meta charset="utf-8"><title>matchset: {totals.count:,} videos</title><style>{STYLE}</style>'
    page = f'<!doctype html><html lang="en"><head>{head}</head><body>{body}</body></html>\n'
    (folder / "summary.html").write_text(page, encoding="utf-8", errors="replace")


def _words(outcome: VideoOutcome) -> str:
    link = f'<a href="{html.escape(quote(outcome.folder))}/log.txt">{html.escape(outcome.folder)}</a>'
    share = f"{outcome.found:,} of {outcome.frames:,} frames" if outcome.frames else html.escape(outcome.state)
    reason = f": {html.escape(outcome.reason)}" if outcome.reason else ""
    return f"{link}: {share}{reason}"


def _histogram(counts: Sequence[int]) -> str:
    """Draw bars with their numbers, as SVG."""
    most, bars = max(max(counts), 1), []
    for k, count in enumerate(counts):
        height = 120.0 * count / most  # geometry: px
        x, y = 20 + 56 * k, 140 - height  # geometry: px
        bars.append(f'<rect x="{x}" y="{y:.1f}" width="50" height="{height:.1f}" fill="#3b7dd8"/>')
        bars.append(f'<text x="{x + 25}" y="{y - 5:.1f}" text-anchor="middle">{count:,}</text>' if count else "")
        bars.append(f'<text x="{x - 3}" y="156" text-anchor="middle">{10 * k}</text>')
    bars.append('<text x="577" y="156" text-anchor="middle">100 %</text>')
    return f'<svg width="600" height="165" role="img" aria-label="histogram">{"".join(bars)}</svg>'
