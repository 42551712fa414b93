"""In what two outcomes of a step differ, in words: `first_difference`."""

from typing import Any

import msgspec


def first_difference(recorded: bytes, replayed: bytes) -> str:
    """Name the first value in which two outcomes differ: ``pose.position.0 was 0.1, is 0.2``.

    Parameters
    ----------
    recorded, replayed : bytes
        msgpack.
    """
    try:
        before: Any = msgspec.msgpack.decode(recorded)
    except msgspec.DecodeError:
        return "what was recorded is no message"
    return _differing(before, msgspec.msgpack.decode(replayed), "") or "the bytes differ"


def _differing(before: Any, after: Any, path: str) -> str:
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        pairs = [(str(key), before[key], after[key]) for key in before]
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = [(str(k), a, b) for k, (a, b) in enumerate(zip(before, after, strict=True))]
    elif msgspec.msgpack.encode(before) == msgspec.msgpack.encode(after):
        return ""
    else:
        return f"{path} was {_brief(before)}, is {_brief(after)}"
    found = (_differing(a, b, f"{path}.{name}" if path else name) for name, a, b in pairs)
    return next((words for words in found if words), "")


def _brief(value: Any) -> str:
    words = repr(value)
    return words if len(words) <= 60 else words[:57] + "..."
