"""Does memory stay flat: the size of a process over 100,000 frames."""

import matchset as ms
from benchmarks.common.resident_memory import resident_mb
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section
from benchmarks.tracking.trial import clicked, sequence
from benchmarks.workers import spread

FRAMES, QUICK_FRAMES = 100_000, 10_000
POOL = 100  # different frames, shown again and again
HIDDEN = (60, 66)  # frames in which the tracker must coast and search
SAMPLES = 100
FLAT_MB = 1.0


def run(options: Options) -> Section:
    """Track in a process of its own and look at its size now and then."""
    count = QUICK_FRAMES if options.quick else FRAMES
    sizes = spread(sizes_mb, [count], jobs=2)[0]
    goal = (Goal("growth", high=FLAT_MB),)
    finding = Finding(
        name="memory",
        what=f"memory of the process over {count:,} frames, from the tenth part of them to the end",
        figures=(Figure("growth", growth(sizes), "MB", 2), Figure("size", sizes[-1], "MB", 0)),
        bar=goal,
    )
    curve = ", ".join(f"{size:.1f}" for size in sizes[:: len(sizes) // 10])
    text = (
        f"{POOL} frames of 640 × 480 in turn; in {HIDDEN[1] - HIDDEN[0]} of them the ball is hidden, and it "
        "jumps where they begin again, so that losing and searching are a part of it. *Flat*: grows by less "
        f"than {FLAT_MB:g} MB. Resident size after every tenth, MB: {curve}."
    )
    return Section("Memory", [finding], text)


def growth(sizes: list[float]) -> float:
    """Largest size in the last tenth above the largest in the second tenth."""
    tenth = max(len(sizes) // 10, 1)
    return max(sizes[-tenth:]) - max(sizes[tenth : 2 * tenth])


def sizes_mb(count: int) -> list[float]:
    """Track that many frames and note the size of this process, MB."""
    clip = sequence("typical", 100, POOL, hidden=(HIDDEN,))
    images = [frame.image for frame, _ in clip]
    tracker = clicked(ms.Frame(images[0]), clip.first_click)
    sizes = []
    for index in range(count):
        tracker.update(ms.Frame(images[index % POOL], index / clip.fps, index))
        if index % (count // SAMPLES) == 0:
            sizes.append(resident_mb())
    return sizes
