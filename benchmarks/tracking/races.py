"""The races that `speed` reports: who runs against whom, on which frames."""

from benchmarks.options import Options
from benchmarks.tracking import contenders as rivals
from benchmarks.tracking.contenders import Pool
from benchmarks.tracking.sequences import sequence
from benchmarks.tracking.stopwatch import Times, race

Result = dict[str, Times]

RADII = (20, 40, 60, 80, 100, 120)
SIZES = ((3840, 2160), (640, 480))
SIZES_RADIUS = 60.0
UPDATE, DETECT, SEARCH = "Tracker.update", "detect", "Tracker.update, searching in vain"
CONVERSION, COPY = "cvtColor + inRange", "frame.copy()"
CONVERSION_KEPT, COPY_KEPT = "cvtColor + inRange into kept buffers", "copy into a kept buffer"


def sweep_pool(options: Options) -> Pool:
    """Render `typical` frames in which the ball goes from r = 120 to 20 px."""
    frames = 120 if options.quick else 200
    return Pool.render(sequence("typical", options.seeds[0], frames, shrink_to=20.0))


def sweep(pool: Pool, options: Options) -> Result:
    """Race the tracker, while r changes, against both yardsticks, all on the same frame."""
    frames = pool.frames
    contenders = [rivals.update(UPDATE, pool), rivals.convert(CONVERSION, frames, 0), rivals.copy(COPY, frames, 0)]
    return race(contenders, len(frames) * _laps(options))


def cold_sweep(pool: Pool, options: Options) -> Result:
    """Race the same, each on a frame that nobody has touched lately, and against kept buffers."""
    frames, count = pool.frames, len(pool.frames)
    contenders = [
        rivals.update(UPDATE, pool),
        rivals.convert(CONVERSION, frames, count // 5),
        rivals.copy(COPY, frames, 2 * count // 5),
        rivals.convert_kept(CONVERSION_KEPT, frames, 3 * count // 5),
        rivals.copy_kept(COPY_KEPT, frames, 4 * count // 5),
    ]
    return race(contenders, count * _laps(options))


def alone(pool: Pool, options: Options) -> Result:
    """Time the tracker on the same frames with no one else: its code and its data stay in the cache."""
    return race([rivals.update(UPDATE, pool)], len(pool.frames) * _laps(options))


def fixed_radii(options: Options) -> Result:
    """Race trackers of balls of fixed radii, each with frames of its own, and the conversion."""
    count = 40 if options.quick else 100
    pools = {
        f"r = {r}": Pool.render(sequence("typical", options.seeds[0], count, radii=(float(r), float(r)))) for r in RADII
    }
    contenders = [rivals.update(name, pool) for name, pool in pools.items()]
    middle = pools[f"r = {RADII[len(RADII) // 2]}"]
    contenders.append(rivals.convert(CONVERSION, middle.frames, count // 2))
    return race(contenders, count * _laps(options))


def resolutions(options: Options) -> Result:
    """Race trackers of balls of equal radius in frames of two sizes; by "640 × 480".

    The large frames are few; the small ones are more, so that they do not stay in the cache.
    """
    contenders = []
    for width, height in SIZES:
        count = 100 if width == SIZES[-1][0] else (10 if options.quick else 20)
        radii = (SIZES_RADIUS, SIZES_RADIUS)
        clip = sequence("clean", options.seeds[0], count, width=width, height=height, radii=radii)
        contenders.append(rivals.update(f"{width} × {height}", Pool.render(clip)))
    return race(contenders, 100 * _laps(options))


def whole_frames(pool: Pool, options: Options) -> Result:
    """Race detection in the whole frame, and a search in vain, against the conversion."""
    frames, count = pool.frames, len(pool.frames)
    empty = [frame for frame, _ in sequence("typical", options.seeds[0], count // 2, ball=False)]
    contenders = [
        rivals.detect(DETECT, pool, 0),
        rivals.convert(CONVERSION, frames, count // 2),
        rivals.search(SEARCH, empty, pool.color),
    ]
    return race(contenders, count * (2 if options.quick else 5))


def _laps(options: Options) -> int:
    return 5 if options.quick else 12
