"""The options of `matchset radio config` from text to the fields of a `Config`: `config_changes`."""

from typing import TYPE_CHECKING

from matchset.links.arduino.messages import AXES, Config

if TYPE_CHECKING:
    from matchset.flight.radio.options import ConfigOptions


def config_changes(options: "ConfigOptions") -> dict[str, object]:
    """Return the fields of a `Config` that the options name.

    Raises
    ------
    ValueError
        If an option is malformed or out of range.
    """
    changes: dict[str, object] = {}
    if options.identity is not None:
        changes["id"] = _identity(options.identity)
    if options.bind_channels is not None:
        numbers = _integers("--bind-channels", options.bind_channels, (1, 2))
        changes["bind_channels"] = (numbers[0], numbers[-1])
    if options.reverse is not None:
        changes["reversed"] = _axes(options.reverse)
    if options.trims is not None:
        changes["trims"] = _integers("--trims", options.trims, (3,))
    for name in ("bind_at_power_on", "trim_follows_stick", "tail"):
        if getattr(options, name) is not None:
            changes[name] = getattr(options, name)
    Config(**changes)  # type: ignore[arg-type]  # refuses what is out of range, before anything is opened
    return changes


def _identity(text: str) -> bytes:
    try:
        found = bytes.fromhex(text.replace(":", " "))
    except ValueError:
        raise ValueError(f"--id must be hexadecimal, got {text!r}") from None
    if len(found) == 4:
        found += Config().id[4:]
    if len(found) != 5:
        raise ValueError(f"--id must have four or five bytes, got {len(found)}")
    return found


def _integers(option: str, text: str, counts: tuple[int, ...]) -> tuple[int, ...]:
    try:
        found = tuple(int(word, 0) for word in text.split(","))
    except ValueError:
        raise ValueError(f"{option} must be whole numbers with commas between, got {text!r}") from None
    if len(found) not in counts:
        raise ValueError(f"{option} takes {' or '.join(map(str, counts))} numbers, got {len(found)}")
    return found


def _axes(text: str) -> tuple[str, ...]:
    axes = [] if text == "none" else text.split(",")
    if unknown := set(axes) - set(AXES):
        raise ValueError(f"--reverse takes {', '.join(AXES)} or none, got {', '.join(sorted(unknown))!r}")
    return tuple(axis for axis in AXES if axis in axes)
