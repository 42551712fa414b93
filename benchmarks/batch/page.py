"""The page of all figures: `page`."""

import numpy as np

from benchmarks.batch.kept import Kept
from benchmarks.batch.killed import Killed
from benchmarks.batch.overhead import Overhead
from benchmarks.batch.speed import Speed
from benchmarks.batch.split import Split
from benchmarks.batch.tasks import Costs
from benchmarks.results import table

SHARE_BAR, SHARE_PRIZE = 0.95, 0.98
OVERHEAD_BAR, OVERHEAD_PRIZE = 3.0, 1.0  # %
SPLIT_BAR = 1.0  # rows of 1,000
HEAD = ("what", "bar", "prize", "measured", "reached")
ABOUT = """Rendered videos (`typical` link, MPEG-4), one color for all. *Plain*: `track`, one video after the other, in
warm processes with one thread each. *Batch*: the same by `matchset batch` with warm workers, without the start of the
program and without its report. All ways are done by turns, in one run; *others* is the share of the processors that
other programs used meanwhile."""


def page(kept: Kept, *more: str) -> str:
    """Write the page of what was measured so far, with more parts behind it."""
    parts = ["# Batches: one worker, two, and many", "Written by `make bench-batch`.", ABOUT, _bars(kept)]
    if kept.speed is not None:
        parts += ["## One worker and two", _where(kept, "speed"), speed_table(kept.speed), _others(kept.speed)]
    if kept.overhead is not None:
        parts += ["## Overhead of a video", _where(kept, "overhead"), overhead_table(kept.overhead)]
        parts += [_others(kept.overhead)]
    if kept.tasks is not None:
        parts += ["## Tasks that do nothing", _where(kept, "tasks"), tasks_table(kept.tasks), _others(kept.tasks)]
    if kept.split is not None:
        parts += ["## A long video in stretches", _where(kept, "split"), split_words(kept.split), _others(kept.split)]
    if kept.killed is not None:
        parts += ["## Killed three times", _where(kept, "killed"), killed_words(kept.killed), _others(kept.killed)]
    return "\n\n".join(part.strip("\n") for part in (*parts, *more)) + "\n"


def _where(kept: Kept, section: str) -> str:
    return f"*{kept.where.get(section, 'not told')}*"


def _others(section: Speed | Overhead | Costs | Split | Killed) -> str:
    share = "not known" if section.others is None else f"{100.0 * section.others:.0f} %"
    return f"Others: {share}, over {section.seconds:.0f} s."


def _bars(kept: Kept) -> str:
    rows = []
    if kept.speed is not None:
        share = kept.speed.share
        words = f"{share:.3f}"
        said = _said(share >= SHARE_BAR, share >= SHARE_PRIZE)
        rows.append(["one to two workers, of the machine's own", f"{SHARE_BAR}", f"{SHARE_PRIZE}", words, said])
    if kept.overhead is not None:
        percent = kept.overhead.percent
        said = _said(percent <= OVERHEAD_BAR, percent <= OVERHEAD_PRIZE)
        name = "overhead of a video over `track` in a warm process"
        rows.append([name, f"{OVERHEAD_BAR:g} %", f"{OVERHEAD_PRIZE:g} %", f"{percent:.1f} %", said])
    if kept.split is not None:
        found = kept.split.differences
        rate = 1000.0 * (found.numbers + found.sigma) / found.rows
        said = _said(rate <= SPLIT_BAR, rate == 0.0)
        name = f"{kept.split.minutes:g} minutes in stretches: rows of 1,000 that differ"
        rows.append([name, f"{SPLIT_BAR:g}", "0", f"{rate:.2f}", said])
    if kept.killed is not None:
        got = kept.killed
        good = got.same == got.videos == got.noted == got.different and not got.again
        name = f"{got.videos} videos, killed {len(got.kills)} times"
        words = f"{got.same} the same, {got.noted} noted, {got.again} again"
        rows.append([name, "all, byte for byte, once", "", words, _said(good, good)])
    return table(list(HEAD), rows)


def _said(bar: bool, prize: bool) -> str:
    return "prize" if prize else "bar" if bar else "**missed**"


def speed_table(speed: Speed) -> str:
    """Write the rounds."""
    rows = []
    for number, each in enumerate(speed.rounds, 1):
        times = *each.plain, *(ran.seconds for ran in each.batch)
        share = each.speed_up / each.machine
        rows.append([str(number), *(f"{value:.2f}" for value in (*times, each.machine, each.speed_up)), f"{share:.3f}"])
    times_of = [*(speed.median(lambda each, k=k: each.plain[k]) for k in (0, 1))]  # type: ignore[misc]
    times_of += [speed.median(lambda each, k=k: each.batch[k].seconds) for k in (0, 1)]  # type: ignore[misc]
    ups = speed.median(lambda each: each.machine), speed.median(lambda each: each.speed_up)
    rows.append(["median", *(f"{value:.2f}" for value in (*times_of, *ups)), f"**{speed.share:.3f}**"])
    head = ["round", "plain 1, s", "plain 2, s", "batch 1, s", "batch 2, s", "machine", "batch", "share"]
    tasks = np.concatenate([each.batch[0].tasks for each in speed.rounds])
    low, middle, high = np.quantile(tasks, (0.05, 0.5, 0.95))
    words = f"{speed.videos} videos of {speed.read / speed.videos / 1e6:.1f} MB. A task with one worker: "
    return f"{table(head, rows)}\n\n{words}median {middle:.3f} s, 5 and 95 %: {low:.3f} and {high:.3f} s."


def overhead_table(overhead: Overhead) -> str:
    """Write what a video costs more."""
    pairs = overhead.pairs
    rows = [
        ["processor time, median of the ratios", f"{overhead.percent:+.2f} %"],
        ["by the clock, median of the ratios", f"{overhead.clock_percent:+.2f} %"],
        ["a video, mean", f"{1e3 * overhead.seconds_a_video:.1f} ms beside {1e3 * overhead.mean('plain'):.0f} ms"],
        ["video", f"{overhead.mean('size') / 1e6:.2f} MB"],
        ["asked to read", f"{overhead.mean('read') / 1e6:.2f} MB: once for the check sum, once to decode"],
        ["written", f"{overhead.mean('written') / 1e3:.1f} kB"],
        ["pairs", f"{len(pairs)}"],
    ]
    return table(["what", "figure"], rows)


def tasks_table(tasks: Costs) -> str:
    """Write what an empty task costs."""
    rows = []
    for cost in tasks.costs:
        own = 1e3 * cost.ran.own / cost.tasks
        figures = f"{1e3 * cost.seconds:.2f}", f"{own:.2f}", f"{1.0 / cost.seconds:.0f}"
        rows.append([cost.name, str(cost.workers), str(cost.tasks), *figures])
    head = ["pool", "workers", "tasks", "a task, ms", "processor of the leading process, ms", "tasks a second"]
    words = "Of Dask: so many workers are known to the batch, of which two are there, in the leading process."
    return f"{table(head, rows)}\n{words}"


def split_words(split: Split) -> str:
    """Write how a joined table differs."""
    found = split.differences
    rows = [
        ["whole, one worker", f"{split.whole:.1f} s"],
        ["stretches, two workers", f"{split.split:.1f} s, {split.whole / split.split:.2f} times as fast"],
        ["work of both, side by side, with check sums and joining", f"{split.tasks:.1f} s"],
        ["rows", f"{found.rows}"],
        ["frame, time, found flag or identity differ", _of(found.numbers, found.rows)],
        ["place or radius by more than one standard deviation", _of(found.sigma, found.rows)],
        ["center by more than 0.1 px", f"{_of(found.far, found.rows)}; most {found.most:.2f} px"],
        ["not the same text", _of(found.bytes, found.rows)],
    ]
    text = table(["what", "figure"], rows)
    return f"{split.minutes:g} minutes of 320 x 240 px in stretches of {split.stretch:g} s. {split.words}.\n\n{text}"


def _of(count: int, rows: int) -> str:
    return f"{count} of {rows} ({1000.0 * count / rows:.2f} of 1,000)"


def killed_words(killed: Killed) -> str:
    """Write what was left after the kills."""
    kills = ", ".join(f"{kill.who} after {kill.after}" for kill in killed.kills)
    words = f"Dask, two workers. Killed with -9: {kills}. The command was typed {killed.runs} times, exit codes "
    rows = [
        ["lines of the manifest, videos in them", f"{killed.noted}, {killed.different}"],
        ["tables that are byte for byte those of `track`", f"{killed.same} of {killed.videos}"],
        ["tables that were whole and were written again", f"{killed.again}"],
        ["left-overs", f"{killed.left}"],
        ["time, with all starts", f"{killed.batch:.1f} s; undisturbed {killed.undisturbed:.1f} s"],
    ]
    return f"{words}{', '.join(map(str, killed.codes))}.\n\n{table(['what', 'figure'], rows)}"
