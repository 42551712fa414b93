"""One session, three times: in simavr, in avr8js, and as a program of this computer."""

import subprocess
from pathlib import Path

import toolchain
from emulator import TICK, Board
from nrf24 import Nrf24

Session = list[tuple[int, bytes]]
"""Cycle at which bytes begin to arrive, and the bytes; in order."""


def _text(session: Session, end: int) -> str:
    return "".join(f"{cycle} {data.hex()}\n" for cycle, data in session) + f"end {end}\n"


def _replay(log: str, end: int) -> tuple[Nrf24, bytes]:
    """Hand what a program printed to the model of the radio; returns it, and what was said to the host."""
    radio, said = Nrf24(), bytearray()
    for line in log.splitlines():
        cycle, kind, value = line.split()
        if kind == "S":
            radio.exchange(int(value), int(cycle))
        elif kind == "N":
            radio.select(value == "0", int(cycle))
        elif kind == "E":
            radio.enable(value == "1", int(cycle))
        else:
            said.append(int(value))
    radio.advance(end)
    return radio, bytes(said)


def _program(*command: str | Path, session: Session, end: int, cwd: Path | None = None) -> tuple[Nrf24, bytes]:
    words = [str(word) for word in command]
    done = subprocess.run(words, input=_text(session, end), capture_output=True, text=True, check=False, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return _replay(done.stdout, end)


def in_simavr(session: Session, end: int) -> tuple[Nrf24, bytes]:
    """Play it in simavr."""
    with Board() as board:
        for cycle, data in session:
            board.run_to(cycle)
            board.write(data)
        board.run_to(end)
        return board.radio, board.read()


def in_avr8js(session: Session, end: int) -> tuple[Nrf24, bytes]:
    """Play it in avr8js."""
    hexadecimal = toolchain.firmware().with_suffix(".hex")
    return _program("node", "run.mjs", hexadecimal, session=session, end=end, cwd=toolchain.avr8js())


def on_host(session: Session, end: int) -> tuple[Nrf24, bytes]:
    """Play it on this computer, under ASan and UBSan."""
    return _program(toolchain.host_session(), session=session, end=end)


def slot(number: int, offset_us: int = 300) -> int:
    """Cycle so long after a tick; early enough for a frame to be whole well before the next one."""
    return number * TICK + offset_us * 16
