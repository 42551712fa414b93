import collections
import sys
from pathlib import Path

import pytest
from benchmarks.mutants.mutant import ROOT, Mutant, load
from benchmarks.mutants.run import Outcome, Runner, Verdict
from benchmarks.mutants.table import BEGIN, END, table, write_table

MUTANTS = load()
LISTS = "safety", "links", "sharing", "batch", "firmware", "control", "localization", "tracking", "fitting"


@pytest.mark.parametrize("path", sorted({mutant.path for mutant in MUTANTS}))
def test_every_mutant_still_applies_once(path: str) -> None:
    source = (ROOT / path).read_text(encoding="utf-8")
    mine = [mutant for mutant in MUTANTS if mutant.path == path]
    changed = [mutant.apply(source) for mutant in mine]
    assert source not in changed
    assert max(collections.Counter(changed).values()) == 1, "two mutants are the same"
    if path.endswith(".py"):
        for mutant, text in zip(mine, changed, strict=True):
            compile(text, f"{path} with {mutant.after!r}", "exec")


def test_the_lists_are_what_they_should_be() -> None:
    groups = collections.Counter(mutant.group for mutant in MUTANTS)
    assert set(groups) == {*LISTS}
    assert sum(groups.values()) >= 200
    assert 20 <= sum(mutant.quick for mutant in MUTANTS) <= 30
    for mutant in MUTANTS:
        for test in mutant.tests:
            assert (ROOT / test).exists() or not test.startswith("tests"), test


def test_a_list_that_is_not_there_is_named() -> None:
    with pytest.raises(ValueError, match="got sound"):
        load(("sound",))


@pytest.mark.parametrize("before", ["x", "z"])
def test_a_fragment_that_is_not_there_once_is_refused(before: str) -> None:
    with pytest.raises(ValueError, match=f"'{before}' must occur once"):
        Mutant("g", "a.py", before, "y", ()).apply("x x")


def test_the_table_counts_what_was_run_and_names_what_lived(tmp_path: Path) -> None:
    mutants = [Mutant("safety", "Makefile", "help", after, ()) for after in ("a", "b", "c")]
    verdicts: tuple[Verdict, ...] = "killed", "alive"
    known = {
        mutant.key(): Outcome(
            mutant.key(), mutant.tests_key(), "safety", "Makefile", "help", mutant.after, verdict, 1.0
        )
        for mutant, verdict in zip(mutants, verdicts, strict=False)
    }
    text = table(mutants, known)
    assert "| safety | 3 | 2 | 1 | 50.0 % | 1 |" in text
    assert "- `Makefile`: `help` became `b`" in text
    page = tmp_path / "page.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", encoding="utf-8")
    write_table(page, mutants, known)
    assert page.read_text(encoding="utf-8") == f"before\n{BEGIN}\n\n{text}\n{END}\nafter\n"


@pytest.mark.skipif(sys.platform == "win32", reason="needs fork")
def test_a_runner_without_mutants_keeps_nothing(tmp_path: Path) -> None:
    assert Runner(tmp_path).known() == {}


def test_what_lived_is_run_again_when_its_tests_change_and_what_was_noticed_is_not() -> None:
    mutant = Mutant("safety", "Makefile", "help", "halp", ("Makefile",))
    runner = Runner(ROOT / "build")
    for verdict, tests_key, holds in (
        ("alive", mutant.tests_key(), True),
        ("alive", "other", False),
        ("killed", "other", True),
        ("timeout", "other", True),
    ):
        outcome = Outcome(mutant.key(), tests_key, "safety", "Makefile", "help", "halp", verdict, 1.0)  # type: ignore[arg-type]
        assert runner.holds(mutant, {mutant.key(): outcome}) is holds
    assert not runner.holds(mutant, {})
