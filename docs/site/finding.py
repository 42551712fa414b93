"""What the site's search finds first: how much a page counts, and what readers type, searched as the page searches.

Material for MkDocs searches the sections of all pages with Lunr; `first_pages` does the same with Lunr for Python.
"""

import re
from collections.abc import Callable
from typing import Any

# A page of a task in docs/, and what its reader types.
TASKS = (
    ("own_video", "my own video"),
    ("webcam", "webcam"),
    ("two_balls", "two balls"),
    ("meters", "meters"),
    ("pandas", "pandas"),
    ("ros2", "ROS 2"),
)
# Other words, and the page that must be the first: what a task is called elsewhere.
ALSO = (
    ("docs/own_video.html", "video file"),
    ("docs/webcam.html", "web camera"),
    ("docs/two_balls.html", "several balls"),
    ("docs/meters.html", "distance"),
    ("docs/pandas.html", "plot"),
    ("docs/ros2.html", "rclpy node"),
    ("docs/camera.html", "calibration board"),
    ("docs/getting_started.html", "lost"),
    ("docs/live.html", "phone"),
    ("index.html", "install"),
)
# Why and when something was done: long, and full of every word.
NEVER = ("docs/decisions/", "docs/log/", "docs/mutants.md", "docs/soak.md")
TASK, GUIDE, REFERENCE, INSIDE = 20.0, 10.0, 0.1, 0.01  # how much a word in a page counts


def weight(page: str, guides: tuple[str, ...]) -> float:
    """How much a page counts in the search; 0: it is not in the index.

    Parameters
    ----------
    page : str
        Its path in the site: ``docs/webcam.md``.
    guides : tuple of str
        Names of the guides, without folder and ending.
    """
    if page.startswith(NEVER):
        return 0.0
    folder, _, name = page.removesuffix(".md").rpartition("/")
    if folder == "docs" and name in dict(TASKS):
        return TASK
    if page == "README.md" or (folder == "docs" and name in guides):
        return GUIDE
    return REFERENCE if folder == "api" else INSIDE


def misses(index: dict[str, Any]) -> list[str]:
    """Say which words find another page first than the one that they should.

    Parameters
    ----------
    index : dict
        ``search/search_index.json`` of the built site.
    """
    search = searcher(index)
    wanted = [(f"docs/{page}.html", words) for page, words in TASKS]
    found = [(page, words, search(words)[:3]) for page, words in (*wanted, *ALSO)]
    return [f"{words!r} finds {first}, not {page}" for page, words, first in found if first[:1] != [page]]


def searcher(index: dict[str, Any]) -> Callable[[str], list[str]]:
    """Make a search that answers with pages, the best first, as the page in the browser does.

    Parameters
    ----------
    index : dict
        ``search/search_index.json`` of the built site.
    """
    from lunr.builder import Builder
    from lunr.stop_word_filter import stop_word_filter

    builder = Builder()
    builder.b(0)
    builder.ref("location")
    builder.pipeline.add(stop_word_filter)
    for name, field in index["config"]["fields"].items():
        builder.field(name, boost=field["boost"])
    for section in index["docs"]:
        words = {name: re.sub(r"<[^>]*>", " ", section.get(name, "")) for name in ("title", "text")}
        plain = {name: re.sub(index["config"]["separator"], " ", text) for name, text in words.items()}
        builder.add({"location": section["location"], "tags": None, **plain}, {"boost": section.get("boost", 1.0)})
    built = builder.build()

    def search(words: str) -> list[str]:
        """Weigh a section more that begins a page, and one that has all words."""
        typed = [word.lower() for word in words.split()]
        best: dict[str, float] = {}
        for result in built.search(" ".join(f"{word}*" for word in typed)):
            terms = result["match_data"].metadata
            there = [any(term.startswith(word) for term in terms) for word in typed]
            counted = [each for each, word in zip(there, typed, strict=True) if each or stop_word_filter(word)]
            page, _, section = result["ref"].partition("#")
            score = result["score"] * (1.0 + ((not section) + sum(counted) / max(len(counted), 1)) ** 2)
            best[page] = max(best.get(page, 0.0), score)
        return sorted(best, key=lambda page: -best[page])

    return search
