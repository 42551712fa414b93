"""The known answers that firmware and tests share."""

import tomllib
from typing import Any

from toolchain import FIRMWARE

VECTORS: dict[str, Any] = tomllib.loads((FIRMWARE / "vectors.toml").read_text(encoding="utf-8"))
HOPS: list[list[int]] = [VECTORS["hops"][str(row)] for row in range(32)]


def octets(words: str) -> bytes:
    """Bytes of a hexadecimal string; spaces do not count."""
    return bytes.fromhex(words)


def channel_lists() -> list[tuple[list[int], bytes]]:
    """Channels and the frames that carry them."""
    found = []
    for case in VECTORS["crsf"]:
        values = case["channels"]
        found.append(([values] * 16 if isinstance(values, int) else values, octets(case["frame"])))
    return found
