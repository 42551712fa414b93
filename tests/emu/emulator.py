"""The firmware on an emulated ATmega328P with an emulated radio, in lock-step: time passes only when told to."""

import ctypes
from pathlib import Path
from typing import Self

import toolchain
from nrf24 import Nrf24, Packet

HZ = 16_000_000
TICK = 64_000  # cycles of 4 ms
PORF, EXTRF, BORF, WDRF = 1, 2, 4, 8
CE_PIN, CSN_PIN = 1, 2
RAM_END = 0x08FF

_EXCHANGE = ctypes.CFUNCTYPE(ctypes.c_uint8, ctypes.c_uint8, ctypes.c_uint64)
_PIN = ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.c_int, ctypes.c_uint64)


def _library() -> ctypes.CDLL:
    library = ctypes.CDLL(str(toolchain.shim()))
    pointer, u64 = ctypes.c_void_p, ctypes.c_uint64
    library.emu_open.restype = pointer
    library.emu_open.argtypes = [ctypes.c_char_p, _EXCHANGE, _PIN, ctypes.c_int]
    library.emu_close.argtypes = [pointer]
    library.emu_cycle.restype = library.emu_uart_last.restype = u64
    library.emu_cycle.argtypes = library.emu_uart_last.argtypes = library.emu_uart_waiting.argtypes = [pointer]
    library.emu_run_to.argtypes = [pointer, u64]
    library.emu_uart_in.argtypes = library.emu_uart_out.argtypes = [pointer, ctypes.c_char_p, ctypes.c_uint32]
    library.emu_reset.argtypes = [pointer, ctypes.c_uint8, ctypes.c_int]
    library.emu_hang.argtypes = [pointer, ctypes.c_uint32, ctypes.c_char_p, ctypes.c_uint32]
    library.emu_ram.argtypes = [pointer, ctypes.c_uint16, ctypes.c_char_p, ctypes.c_uint16, ctypes.c_int]
    library.emu_eeprom.argtypes = [pointer, ctypes.c_char_p, ctypes.c_uint16, ctypes.c_int]
    return library


class Board:
    """An Arduino with a radio.

    Parameters
    ----------
    eeprom : bytes
        What its memory holds from place 0 on; the rest is erased.
    slow_spi : bool
        Leave simavr's own timing of SPI: 100 us a byte where 2 us are true. The worst that could be.
    program : Path, optional
        The firmware to run, if not the one that its Makefile builds.

    Attributes
    ----------
    radio : Nrf24
        The radio; its `packets` are what went on the air.
    """

    def __init__(self, eeprom: bytes = b"", slow_spi: bool = False, program: Path | None = None) -> None:
        self.radio = Nrf24()
        self._exchange = _EXCHANGE(self.radio.exchange)
        self._pin = _PIN(self._on_pin)
        self._emu = _library()
        code = str(program or toolchain.firmware()).encode()
        self._handle = self._emu.emu_open(code, self._exchange, self._pin, slow_spi)
        assert self._handle, "libsimavr cannot load the firmware"
        self.eeprom = eeprom.ljust(1024, b"\xff")

    def _on_pin(self, pin: int, level: int, cycle: int) -> None:
        if pin == CE_PIN:
            self.radio.enable(bool(level), cycle)
        else:
            self.radio.select(not level, cycle)

    @property
    def cycle(self) -> int:
        """Cycles of 16 MHz since power on."""
        return int(self._emu.emu_cycle(self._handle))

    @property
    def time(self) -> float:
        """The same in s."""
        return self.cycle / HZ

    @property
    def packets(self) -> list[Packet]:
        """What went on the air so far."""
        return self.radio.packets

    def run_to(self, cycle: int) -> None:
        """Run until this cycle."""
        assert self._emu.emu_run_to(self._handle, cycle), "the processor stopped"
        self.radio.advance(cycle)

    def run(self, seconds: float) -> list[Packet]:
        """Run for a time; returns the packets that went on the air in it."""
        before = len(self.packets)
        self.run_to(self.cycle + round(seconds * HZ))
        return self.packets[before:]

    def write(self, data: bytes) -> None:
        """Send bytes from the host; they arrive one after the other while the board runs."""
        self._emu.emu_uart_in(self._handle, data, len(data))

    @property
    def waiting(self) -> int:
        """Bytes from the host still on their way."""
        return int(self._emu.emu_uart_waiting(self._handle))

    @property
    def last_byte(self) -> int:
        """Cycle at which the last byte from the host began to arrive."""
        return int(self._emu.emu_uart_last(self._handle))

    def read(self) -> bytes:
        """What the board has sent to the host since the last call."""
        room = ctypes.create_string_buffer(1 << 16)
        count = self._emu.emu_uart_out(self._handle, room, len(room))
        return room.raw[:count]

    def reset(self, flags: int, keep_ram: bool = True) -> None:
        """Reset the processor, with MCUSR as given; PORF with `keep_ram` off is a power-on."""
        self._emu.emu_reset(self._handle, flags, keep_ram)

    def hang(self, symbol: str, interrupts_off: bool = False) -> None:
        """Make a function of the firmware never return; the next reset makes it whole again."""
        cli, jump_to_itself = b"\xf8\x94", b"\xff\xcf"
        code = cli + jump_to_itself if interrupts_off else jump_to_itself
        self._emu.emu_hang(self._handle, toolchain.symbols()[symbol], code, len(code))

    def ram(self, place: int, count: int) -> bytes:
        """Read the memory."""
        room = ctypes.create_string_buffer(count)
        self._emu.emu_ram(self._handle, place, room, count, 0)
        return room.raw

    def fill_ram(self, place: int, data: bytes) -> None:
        """Overwrite the memory."""
        self._emu.emu_ram(self._handle, place, data, len(data), 1)

    @property
    def eeprom(self) -> bytes:
        """The memory that outlives power."""
        room = ctypes.create_string_buffer(1024)
        self._emu.emu_eeprom(self._handle, room, 1024, 0)
        return room.raw

    @eeprom.setter
    def eeprom(self, data: bytes) -> None:
        self._emu.emu_eeprom(self._handle, data, len(data), 1)

    def close(self) -> None:
        """Free the emulator."""
        if self._handle:
            self._emu.emu_close(self._handle)
        self._handle = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
