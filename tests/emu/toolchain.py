"""Builds what the emulation needs; where a tool is missing, CI fails and others skip with a line that helps."""

import functools
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
FIRMWARE = ROOT / "firmware" / "syma_transmitter"
BUILD = ROOT / "build" / "emu"
HEADERS = [ROOT / ".toolchain" / "usr" / "include", Path("/usr/include")]
INSTALL = "to install it, as root: make toolchain"
CORE = ["crc8.c", "crsf.c", "config.c", "pilot.c", "syma.c", "radio.c", "transmitter.c"]
WARNINGS = ["-Wall", "-Wextra", "-Werror"]


def lacking(what: str) -> None:
    """Fail in CI, skip elsewhere."""
    words = f"{what} is missing; {INSTALL}"
    if os.environ.get("CI"):
        pytest.fail(words)
    pytest.skip(words)


def _run(*command: str | Path, cwd: Path | None = None) -> str:
    done = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.fail(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def _newer(target: Path, sources: list[Path]) -> bool:
    return target.exists() and all(target.stat().st_mtime >= source.stat().st_mtime for source in sources)


@functools.cache
def firmware() -> Path:
    """The firmware for the ATmega328P, as its own Makefile builds it."""
    if not shutil.which("avr-gcc") or not shutil.which("make"):
        lacking("avr-gcc")
    _run("make", "-C", FIRMWARE, f"BUILD={BUILD}")
    return BUILD / "syma_transmitter.elf"


@functools.cache
def symbols() -> dict[str, int]:
    """Where the firmware's functions and variables are."""
    lines = _run("avr-nm", firmware()).splitlines()
    return {words[2]: int(words[0], 16) for words in map(str.split, lines) if len(words) == 3}


@functools.cache
def shim() -> Path:
    """The emulator as a library."""
    include = next((path for path in HEADERS if (path / "simavr" / "sim_avr.h").exists()), None)
    if include is None or not shutil.which("gcc"):
        lacking("libsimavr, or gcc")
    target, source = BUILD / "shim.so", HERE / "shim.c"
    if not _newer(target, [source]):
        BUILD.mkdir(parents=True, exist_ok=True)
        where = [f"-I{include}", f"-I{include}/simavr"]
        _run("gcc", "-O2", *WARNINGS, "-shared", "-fPIC", *where, source, "-o", target, "-l:libsimavr.so.2")
    return target


ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
SKETCH_FLAGS = (
    "-c -g -Os -w -mmcu=atmega328p -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_AVR_UNO -DARDUINO_ARCH_AVR -flto "
    f"-ffunction-sections -fdata-sections -I{ARDUINO}/cores/arduino -I{ARDUINO}/variants/standard"
).split()


@functools.cache
def arduino_sketch() -> Path:
    """The firmware as the Arduino IDE builds it: sketch, core and link-time optimization."""
    if not (ARDUINO / "cores" / "arduino" / "Arduino.h").exists() or not shutil.which("avr-gcc"):
        lacking("arduino-core-avr, or avr-gcc")
    folder = BUILD / "sketch"
    program = folder / "sketch.elf"
    if _newer(program, [path for path in FIRMWARE.iterdir() if path.is_file()]):
        return program
    folder.mkdir(parents=True, exist_ok=True)
    sketch = folder / "syma_transmitter.ino.cpp"
    sketch.write_text("#include <Arduino.h>\n" + (FIRMWARE / "syma_transmitter.ino").read_text())
    core = [path for path in (ARDUINO / "cores" / "arduino").glob("*.c*") if path.name != "WString.cpp"]
    objects: dict[Path, Path] = {}
    for source in [*core, sketch, *FIRMWARE.glob("*.c")]:
        target = objects[source] = folder / (source.name + ".o")
        language = ["-std=gnu11", "-fno-fat-lto-objects"] if source.suffix == ".c" else ["-std=gnu++11", "-fpermissive"]
        _run("avr-gcc", *SKETCH_FLAGS, *language, "-fno-exceptions", source, "-o", target)
    archive = folder / "core.a"
    archive.unlink(missing_ok=True)
    _run("avr-gcc-ar", "rcs", archive, *(objects.pop(source) for source in core))
    link = ["-w", "-Os", "-flto", "-fuse-linker-plugin", "-Wl,--gc-sections", "-mmcu=atmega328p"]
    _run("avr-gcc", *link, "-o", program, *objects.values(), archive, "-lm")
    return program


def _host_sources() -> list[Path]:
    return [*(FIRMWARE / name for name in CORE), HERE / "host_board.c", HERE / "host_judge.c"]


def _host(target: Path, extra: list[Path], *options: str) -> Path:
    if not shutil.which("gcc"):
        lacking("gcc")
    sources = [*_host_sources(), *extra]
    if not _newer(target, [*sources, *FIRMWARE.glob("*.h"), *HERE.glob("*.h")]):
        BUILD.mkdir(parents=True, exist_ok=True)
        _run("gcc", "-std=gnu99", "-g", *WARNINGS, *options, f"-I{FIRMWARE}", f"-I{HERE}", *sources, "-o", target)
    return target


SANITIZERS = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")


@functools.cache
def host_session() -> Path:
    """The same C under ASan and UBSan: a program that plays a session and prints what reached the radio."""
    return _host(BUILD / "host_session", [HERE / "host_session.c"], *SANITIZERS)


@functools.cache
def host_fuzz() -> Path:
    """The same C under ASan and UBSan: a program that feeds it noise and looks at the packets."""
    return _host(BUILD / "host_fuzz", [HERE / "host_fuzz.c"], *SANITIZERS)


@functools.cache
def host_walk() -> Path:
    """The same C under ASan and UBSan: a program that plays every sequence of some events to it."""
    return _host(BUILD / "host_walk", [HERE / "host_walk.c"], *SANITIZERS)


@functools.cache
def host_library() -> Path:
    """The same C as a library, for functions called one by one."""
    return _host(BUILD / "host_firmware.so", [], "-O2", "-shared", "-fPIC")


@functools.cache
def avr8js() -> Path:
    """The folder of the second emulator, with its package installed."""
    folder = HERE / "avr8js"
    if not (folder / "node_modules" / "avr8js").exists() or not shutil.which("node"):
        lacking("avr8js (node, npm)")
    return folder
