"""What `track` or `locate` is told for one video of a batch: `track_options`, `locate_options`, `settings_digest`."""

import hashlib
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.cli_options import SeveralTargetOptions, ShownOptions, shape_file
from matchset.app.locate.options import LocateOptions
from matchset.app.several.options import MotOptions, color_files, named_color
from matchset.app.track.options import TrackOptions
from matchset.batch.options import BatchOptions

Options = TrackOptions | LocateOptions


def options_for(options: BatchOptions, video: str) -> Options:
    """Return what the command of a batch is told for one video."""
    return locate_options(options, video) if options.located.locate else track_options(options, video)


def track_options(options: BatchOptions, video: str) -> TrackOptions:
    """Return what `matchset track` is told for one video."""
    return TrackOptions(
        source=video,
        view=options.view,
        target=options.target,
        several=MotOptions(**msgspec.structs.asdict(options.several)),
        shape=options.shape,
        shown=ShownOptions(no_video=not options.films, start=options.start, end=options.end),
        points=options.points,
        params=options.params,
        fps=options.fps,
    )


def locate_options(options: BatchOptions, video: str) -> LocateOptions:
    """Return what `matchset locate` is told for one video (ValueError where an option is of `track` alone)."""
    if options.shape != "circle" or options.target.gray is not None:
        raise ValueError("--shape and --gray are of 'track': leave them out with --locate")
    target = {name: getattr(options.target, name) for name in ("picks", "reading", "candidate", "color", "hsv")}
    located = options.located
    return LocateOptions(
        source=video,
        view=options.view,
        target=msgspec.convert(target, SeveralTargetOptions),
        several=options.several,
        camera=located.camera,
        fov=located.fov,
        focal_sigma=located.focal_sigma,
        diameter=located.diameter,
        diameter_sigma=located.diameter_sigma,
        marker=located.marker,
        marker_diameter=located.marker_diameter,
        markers=located.markers,
        shown=ShownOptions(no_video=not options.films, start=options.start, end=options.end),
        points=options.points,
        params=options.params,
        fps=options.fps,
    )


def absolute(options: Options) -> Options:
    """Return options in which every file is named from the root of the disk: a worker stands in another folder."""
    changed: Options = msgspec.structs.replace(options, target=_absolute(options.target))
    for name in ("params", "camera", "markers"):
        path = getattr(changed, name, None)
        if path is not None:
            changed = msgspec.structs.replace(changed, **{name: path.absolute()})
    if isinstance(changed, LocateOptions) and changed.marker.marker_color:
        colors = [path.absolute() for path in changed.marker.marker_color]
        return msgspec.structs.replace(changed, marker=msgspec.structs.replace(changed.marker, marker_color=colors))
    if isinstance(changed, TrackOptions):
        picture = shape_file(changed.shape)
        if picture.is_file():
            _, behind, affine = changed.shape.partition(":affine")
            return msgspec.structs.replace(changed, shape=f"{picture.absolute()}{behind}{affine}")
    return changed


def _absolute(target: Any) -> Any:
    colors = []
    for each in target.color or ():
        name, path = named_color(each)
        colors.append(Path(f"{name}={path.absolute()}") if name else path.absolute())
    return msgspec.structs.replace(target, color=colors) if colors else target


def settings_digest(options: Options, more: str = "") -> str:
    """Return a check sum of all that decides about the answers, but the video: options, what files in them hold, code.

    Parameters
    ----------
    options : TrackOptions or LocateOptions
    more : str
        What else decides.
    """
    text = msgspec.json.encode(msgspec.structs.replace(options, source="", out=None), enc_hook=str)
    named = {str(path): _content(path) for path in files_in(options)}
    return hashlib.sha256(b"\0".join([text, repr(sorted(named.items())).encode(), more.encode()])).hexdigest()[:32]


def files_in(options: Options) -> list[Path]:
    """Return the files that options name, the video left out."""
    marker = getattr(options, "marker", None)
    colors = color_files(options.target.color)
    shape = [shape_file(options.shape)] if isinstance(options, TrackOptions) else []
    others = [getattr(options, name, None) for name in ("params", "camera", "markers")]
    asked = [*colors, *(marker.marker_color or () if marker else ()), *others, *shape]
    return [path for path in asked if path is not None and path.is_file()]


_CONTENTS: dict[tuple[Path, int, int], str] = {}


def _content(path: Path) -> str:
    """Return the check sum of a file; read once for all videos."""
    stat = path.stat()
    key = path, stat.st_size, stat.st_mtime_ns
    if key not in _CONTENTS:
        _CONTENTS[key] = hashlib.sha256(path.read_bytes()).hexdigest()
    return _CONTENTS[key]
