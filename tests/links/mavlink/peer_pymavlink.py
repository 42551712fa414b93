"""pymavlink as a parser and a writer, in an environment of its own: `.ci/setup-mavlink`.

    peer_pymavlink.py parse     a packet per line, hexadecimal -> name, sender and values, JSON
    peer_pymavlink.py pack      name and values per line, JSON -> a packet, hexadecimal
    peer_pymavlink.py vectors   the lines of pymavlink_vectors.jsonl

TARGET_RELATIVE is in none of its dialects: its generator makes it from the definition below.
"""

import importlib.util
import json
import random
import sys
import tempfile
from pathlib import Path
from typing import Any

from pymavlink.generator import mavgen, mavparse

NAMES = [
    "HEARTBEAT",
    "SYS_STATUS",
    "PARAM_REQUEST_READ",
    "PARAM_VALUE",
    "ATTITUDE",
    "MANUAL_CONTROL",
    "COMMAND_LONG",
    "COMMAND_ACK",
    "SET_POSITION_TARGET_LOCAL_NED",
    "TIMESYNC",
    "BATTERY_STATUS",
    "LANDING_TARGET",
    "STATUSTEXT",
    "ODOMETRY",
]
TARGET_RELATIVE = """<?xml version="1.0"?>
<mavlink><dialect>0</dialect><messages><message id="511" name="TARGET_RELATIVE"><description>seen</description>
<field type="uint64_t" name="timestamp">t</field><field type="uint8_t" name="id">t</field>
<field type="uint8_t" name="frame">t</field><field type="float" name="x">t</field>
<field type="float" name="y">t</field><field type="float" name="z">t</field>
<field type="float[3]" name="pos_std">t</field><field type="float" name="yaw_std">t</field>
<field type="float[4]" name="q_target">t</field><field type="float[4]" name="q_sensor">t</field>
<field type="uint8_t" name="type">t</field></message></messages></mavlink>
"""


def generated() -> Any:
    """The dialect of TARGET_RELATIVE alone."""
    folder = Path(tempfile.mkdtemp())
    (folder / "target.xml").write_text(TARGET_RELATIVE, encoding="utf-8")
    options = mavgen.Opts(
        str(folder / "target"), wire_protocol=mavparse.PROTOCOL_2_0, language="Python3", validate=False
    )
    mavgen.mavgen(options, [str(folder / "target.xml")])
    spec = importlib.util.spec_from_file_location("target", folder / "target.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["target"] = module
    spec.loader.exec_module(module)
    return module


def dialects() -> tuple[Any, Any]:
    from pymavlink.dialects.v20 import common

    written, sys.stdout = sys.stdout, sys.stderr  # the generator talks
    try:
        return common, generated()
    finally:
        sys.stdout = written


COMMON, TARGET = dialects()
WRITERS = {module: module.MAVLink(None, srcSystem=7, srcComponent=9) for module in (COMMON, TARGET)}


def classes() -> dict[str, tuple[Any, Any]]:
    """Dialect and class of each message."""
    found = {name: (COMMON, COMMON.mavlink_map[getattr(COMMON, f"MAVLINK_MSG_ID_{name}")]) for name in NAMES}
    return found | {"TARGET_RELATIVE": (TARGET, TARGET.mavlink_map[511])}


def packed(name: str, values: dict[str, Any]) -> str:
    module, kind = classes()[name]
    given = {key: value.encode() if isinstance(value, str) else value for key, value in values.items()}
    return bytes(kind(**given).pack(WRITERS[module])).hex()


def parsed(data: bytes) -> dict[str, Any]:
    module = TARGET if int.from_bytes(data[7:10], "little") == 511 else COMMON
    parser = module.MAVLink(None)
    (message,) = parser.parse_buffer(data)
    values = message.to_dict()
    name = values.pop("mavpackettype")
    sender = [message.get_srcSystem(), message.get_srcComponent(), message.get_seq()]
    return {"name": name, "sender": sender, "values": values}


def drawn(chance: random.Random, kind: str, fraction: float) -> Any:
    """A value of a type; some of them zero."""
    if kind == "float":
        return 0.0 if chance.random() < fraction else chance.choice((-1.5, 0.25, 3.0, -1024.125, 2**-14, 7.75))
    bits, signed = int(kind.strip("uint_")), not kind.startswith("u")
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    return 0 if chance.random() < fraction else chance.choice((low, high, chance.randint(low, high)))


def vectors() -> None:
    chance = random.Random(20)
    for name, (_, kind) in classes().items():
        counts = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
        for fraction in (1.0, 0.0, 0.5, 0.9):
            values: dict[str, Any] = {}
            for field, what in zip(kind.fieldnames, kind.fieldtypes, strict=True):
                count = counts[field]
                if what == "char":
                    values[field] = "".join(chance.choice("Arming: ok") for _ in range(round(count * (1 - fraction))))
                elif count:
                    values[field] = [drawn(chance, what, fraction) for _ in range(count)]
                else:
                    values[field] = drawn(chance, what, fraction)
            line = {"name": name, "extra": kind.crc_extra, "values": values, "packet": packed(name, values)}
            print(json.dumps(line))


def main() -> None:
    if sys.argv[1] == "vectors":
        vectors()
        return
    for line in sys.stdin:
        if sys.argv[1] == "parse":
            print(json.dumps(parsed(bytes.fromhex(line))))
        else:
            print(packed(**json.loads(line)))


if __name__ == "__main__":
    main()
