"""What the site consists of, for MkDocs: the repository's pages at their own places, and the generated ones."""

import json
from pathlib import Path

from finding import TASKS, misses, weight
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pages import API, FOLDERS, ROOT, anchor, decisions, generated, log

import matchset

PAGES = ("*.md", "LICENSE", "benchmarks/*.md", "docs/*.md", "docs/decisions/*.md", "docs/log/*.md")
BESIDE = ("docs/pictures/*.[pjws]*[gp]", "docs/site/*.css", "docs/*.txt", "benchmarks/pictures/*.svg")
GUIDES = (
    "getting_started",
    "cli",
    "live",
    "sharing",
    "camera",
    "localization",
    "add_a_shape",
    "flight",
    "first_flight",
    "safety",
    "recording",
    "ros",
    "radio",
    "crsf",
    "mavlink",
    "tello",
    "clips",
    "batch",
    "simulation",
)
INSIDE = ("ARCHITECTURE.md", "docs/glossary.md", "docs/finding_your_way.md", "CONTRIBUTING.md", "CHANGELOG.md")
RESULTS = ("docs/evidence.md", "benchmarks/RESULTS.md", "benchmarks/FLIGHT.md", "docs/limits.md")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Lay out the navigation; a page that is missing here makes the build fail."""
    config.nav = [
        {"Start": "README.md"},
        {"Tasks": [f"docs/{name}.md" for name, _ in TASKS]},
        {"Guides": [f"docs/{name}.md" for name in GUIDES]},
        {
            "API": [
                "api/index.md",
                *(f"api/{name}.md" for name in (*API, *FOLDERS)),
                "api/parameters.md",
                "api/commands.md",
            ]
        },
        {"Inside": list(INSIDE)},
        {"Decisions": ["docs/decisions/index.md", *decisions()]},
        {"Log": ["docs/log/index.md", *log()]},
        {"Results": list(RESULTS)},
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Take the repository's pages, at their own places, and the generated ones instead of the folder `docs_dir`."""
    ours = Files([file for file in files if not str(file.abs_src_path or "").startswith(config.docs_dir)])
    for path in sorted(path for pattern in (*PAGES, *BESIDE) for path in ROOT.glob(pattern)):
        name = path.relative_to(ROOT).as_posix()
        ours.append(File(name, str(ROOT), config.site_dir, config.use_directory_urls))
    for name, text in generated().items():
        ours.append(File.generated(config, name, content=text))
    return ours


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001
    """Give the front page the whole width, and each page its weight in the search."""
    if page.is_homepage:
        page.meta["hide"] = ["navigation"]
    counts = weight(page.file.src_uri, GUIDES)
    page.meta["search"] = {"boost": counts} if counts else {"exclude": True}
    return markdown


@event_priority(-100)  # after the search has written its index
def on_post_build(config: MkDocsConfig) -> None:
    """Check that every public name has its section, and that the search finds the page of a task first."""
    pages = "".join(path.read_text(encoding="utf-8") for path in (Path(config.site_dir) / "api").glob("*.html"))
    missing = [name for name in matchset.__all__ if f'id="{anchor(name)}"' not in pages]
    if missing:
        raise PluginError(f"public names without a section in the API: {', '.join(missing)}; see docs/site/pages.py")
    wrong = misses(json.loads((Path(config.site_dir) / "search" / "search_index.json").read_text(encoding="utf-8")))
    if wrong:
        raise PluginError(f"the search finds other pages first, see docs/site/finding.py: {'; '.join(wrong)}")
