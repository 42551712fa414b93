"""Our packets read by pymavlink, and its packets by us, now and not from a file: `.ci/setup-mavlink`."""

import json
import random
import subprocess
from pathlib import Path
from typing import Any

import pytest

from matchset.links.mavlink.message import SIZES, MessageField
from matchset.links.mavlink.messages import MESSAGES
from matchset.links.mavlink.packet import MavlinkParser, PacketWriter

ROOT = Path(__file__).resolve().parents[3]
PEERS = ROOT / ".mavlink"
COUNT = 40  # packets of each message

pytestmark = pytest.mark.skipif(not (PEERS / "ready").exists(), reason="pymavlink is missing: run .ci/setup-mavlink")


def pymavlink(action: str, lines: list[str]) -> list[str]:
    program = Path(__file__).with_name("peer_pymavlink.py")
    command = [str(PEERS / "bin" / "python"), str(program), action]
    done = subprocess.run(command, input="\n".join(lines), capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.splitlines()


def drawn(chance: random.Random, field: MessageField) -> Any:
    size, letter = SIZES[field.base]

    def one() -> Any:
        if chance.random() < 0.3:
            return 0
        if letter == "f":
            return chance.choice((-1, 1)) * chance.randrange(1 << 24) * 2.0 ** chance.randint(-40, 20)
        low = 0 if letter.isupper() else -(1 << 8 * size - 1)
        return low + chance.randrange(1 << 8 * size)

    if field.is_text:
        return "".join(chance.choice("PreArm: check 7") for _ in range(chance.randint(0, field.count)))
    return [one() for _ in range(field.count)] if field.count else one()


def messages() -> list[dict[str, Any]]:
    chance = random.Random(21)
    return [
        {"name": each.name, "values": {field.name: drawn(chance, field) for field in each.fields}}
        for each in MESSAGES
        for _ in range(COUNT)
    ]


def test_pymavlink_reads_what_is_sent() -> None:
    writer, sent = PacketWriter(255, 190), messages()
    answers = [json.loads(line) for line in pymavlink("parse", [writer.write(**each).hex() for each in sent])]
    assert [{"name": each["name"], "values": each["values"]} for each in answers] == sent
    assert [each["sender"] for each in answers] == [[255, 190, k % 256] for k in range(len(sent))]


def test_what_pymavlink_sends_is_read() -> None:
    sent = messages()
    packets = pymavlink("pack", [json.dumps(each) for each in sent])
    for line, each in zip(packets, sent, strict=True):
        (packet,) = MavlinkParser().feed(bytes.fromhex(line))
        values = {name: list(value) if isinstance(value, tuple) else value for name, value in packet.values.items()}
        assert (packet.message.name, values) == (each["name"], each["values"])
