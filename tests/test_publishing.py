"""What an index and other people are told: metadata, extras, markers, the citation, and the image of a container."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NUMBA = [Requirement(each) for each in PROJECT["dependencies"] if Requirement(each).name == "numba"]
DOCKERFILE = (ROOT / "Dockerfile").read_text(encoding="utf-8")
IGNORED = (ROOT / ".dockerignore").read_text(encoding="utf-8").split("\n")


def test_classifiers_name_systems_and_versions_of_python() -> None:
    classifiers = PROJECT["classifiers"]
    for version in ("3.11", "3.12", "3.13"):
        assert f"Programming Language :: Python :: {version}" in classifiers
    for system in ("POSIX :: Linux", "MacOS", "Microsoft :: Windows"):
        assert f"Operating System :: {system}" in classifiers
    assert "Operating System :: OS Independent" not in classifiers, "32-bit systems have no Numba"
    assert sum(each.startswith("Topic ::") for each in classifiers) >= 2


@pytest.mark.parametrize(
    ("system", "machine", "newest"),
    [
        ("linux", "x86_64", 68),
        ("linux", "aarch64", 68),
        ("win32", "AMD64", 68),
        ("darwin", "arm64", 68),
        ("darwin", "x86_64", 62),
    ],
)
def test_each_system_has_a_numba(system: str, machine: str, newest: int) -> None:
    """Wheels for Macs with an Intel processor end with 0.62."""
    environment = {"sys_platform": system, "platform_machine": machine}
    (bound,) = (each.specifier for each in NUMBA if each.marker is None or each.marker.evaluate(environment))
    assert bound.contains(f"0.{newest}.1")
    assert not bound.contains(f"0.{newest + 1}.0")


def test_every_extra_that_code_advises_exists_and_every_extra_has_code() -> None:
    extras = PROJECT["optional-dependencies"]
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py"))
    assert set(re.findall(r"matchset\[(\w+)\]", text)) <= set(extras)
    imported = {"pyserial": "serial", "eclipse-zenoh": "zenoh", "pyntcore": "ntcore"}
    for name, requirements in extras.items():
        for each in requirements:
            module = imported.get(Requirement(each).name, Requirement(each).name)
            assert re.search(rf"^\s*(import|from) {module}\b", text, re.MULTILINE), f"{name}: nothing imports {module}"


def test_addresses_are_whole_or_absent() -> None:
    """Four of them or, as long as the project has no public place, none; never one that leads nowhere."""
    urls = PROJECT.get("urls", {})
    assert set(urls) in (set(), {"Homepage", "Documentation", "Issues", "Changelog"})
    assert not [url for url in urls.values() if re.search(r"example|placeholder|TODO|\.invalid|OWNER", url)]


def test_the_citation_is_that_of_this_version_and_names_the_paper() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert (citation["version"], citation["license"]) == (PROJECT["version"], PROJECT["license"])
    (paper,) = citation["references"]
    assert paper["title"] == "Quadcopter Tracks Quadcopter via Real Time Shape Fitting"
    assert [author["family-names"] for author in paper["authors"]] == ["Epstein", "Feldman"]


def instructions() -> list[tuple[str, str]]:
    lines = re.sub(r"^#.*\n", "", DOCKERFILE, flags=re.MULTILINE).replace("\\\n", " ").splitlines()
    return [(word, rest) for word, _, rest in (line.partition(" ") for line in lines) if word]


def test_the_image_runs_as_nobody_special_with_its_kernels_compiled() -> None:
    """hadolint, where it is installed, finds nothing in it either; CONTRIBUTING.md says how to run it."""
    words = instructions()
    last = max(k for k, (word, _) in enumerate(words) if word == "FROM")
    users = [rest for word, rest in words[last:] if word == "USER"]
    assert users == ["1000:1000"], "not root, and a number, which every host can compare"
    warm = next(k for k, (word, rest) in enumerate(words) if word == "RUN" and "matchset warm" in rest)
    assert "NUMBA_CACHE_DIR=" in "".join(rest for word, rest in words[:warm] if word == "ENV")
    assert all(":" in rest and ":latest" not in rest for word, rest in words if word == "FROM")
    assert ("ENTRYPOINT", '["matchset"]') in words


def test_only_what_is_built_from_goes_into_the_image() -> None:
    assert IGNORED[1] == "*"
    sent = {line[1:] for line in IGNORED if line.startswith("!")}
    copied = {
        name for word, rest in instructions() if word == "COPY" and "--from" not in rest for name in rest.split()[:-1]
    }
    assert sent == copied == {"pyproject.toml", "README.md", "LICENSE", "src"}
    assert all((ROOT / name).exists() for name in sent)


def test_there_is_a_list_for_a_release() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    release = text.split("## A release")[1].split("\n## ")[0]
    for word in ("make release-check", "CHANGELOG.md", "CITATION.cff", "hadolint", "[project.urls]", "twine check"):
        assert word in release, word


def test_three_commands_lead_to_the_first_picture() -> None:
    """`make first-picture` types them in an empty folder and measures what they take."""
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location("first_picture", ROOT / ".ci" / "first_picture.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.commands() == [f"git clone {ROOT} matchset", "cd matchset", "make demo"]
    assert module.MOST_SECONDS <= 60.0
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "\ndemo: $(PACKAGE) " in makefile
    assert ".ci/first_picture.py" in makefile
    assert "PIP_NO_COMPILE=1" in (ROOT / ".ci" / "setup").read_text(encoding="utf-8")
