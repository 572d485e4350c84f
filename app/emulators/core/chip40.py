"""A chip with 40-bit datagrams behind a wire: seconds, bytes and faults around it."""

from __future__ import annotations

import random
from typing import Generic, Protocol, TypeVar

from ...clock import Clock
from ...links.datagram40 import ADDRESS_MAX, FRAME_BYTES, STATUS_BYTES, WRITE_BIT
from .base import ChangeT, ChipFaults, EmulatorBase, StateT
from .uart_end import UartChip, UartEnd


class Chip40(Protocol):
    """Registers behind 40-bit datagrams, which live by clocks."""

    @property
    def spi_status(self) -> int:
        """The eight status bits of a reply."""
        ...

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written."""
        ...

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        ...

    def reset(self) -> None:
        """As after power-on."""
        ...

    def read(self, address: int) -> int:
        """The word at `address`, with all consequences."""
        ...

    def write(self, address: int, word: int) -> None:
        """Write `word`."""
        ...


class UartChip40(Chip40, UartChip, Protocol):
    """The same with a UART besides."""


ChipT = TypeVar("ChipT", bound=Chip40)
UartChipT = TypeVar("UartChipT", bound=UartChip40)


class EmulatorBase40(EmulatorBase[ChangeT, StateT], Generic[ChipT, ChangeT, StateT]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, clock: Clock, time_scale: float, chip: ChipT, clock_hz: float, seed: int) -> None:
        super().__init__(clock, time_scale, ChipFaults())
        self._chip = chip
        self._clock_hz = clock_hz
        self._noise = random.Random(seed)
        self._data = 0

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one 5-byte datagram, or the first byte of one alone, at chip time `at_s` [s], by default now; never
        before the latest time used.

        Raises ValueError for a frame of another length, ConnectionError while unplugged and TimeoutError
        while silent. A silent chip still obeys: only its answer is lost.
        """
        if len(frame) not in (STATUS_BYTES, FRAME_BYTES):
            raise ValueError(f"a datagram has {FRAME_BYTES} bytes, or {STATUS_BYTES} for the status, not {len(frame)}")
        return self.transfer(frame, at_s)

    def transfer(self, sent: bytes, at_s: float | None = None) -> bytes:
        """What comes out while `sent` goes in, between chip select low and high: any whole number of bytes.

        Fewer than 40 bits only fetch the beginning of the reply; of more the last 40 are the command, and those
        before them leave after 40 clocks, to the next chip of a chain (DS-TMC4361 5.2). Raises what `exchange` does,
        but for lengths.
        """
        self.faults.require_plugged(self.model)
        with self._lock:
            chip = self._chip
            self._run_until(at_s)
            self._selected()
            received = (bytes((chip.spi_status,)) + self._data.to_bytes(4, "big") + sent)[: len(sent)]
            if len(sent) >= FRAME_BYTES:
                first, data = sent[-FRAME_BYTES], int.from_bytes(sent[1 - FRAME_BYTES :], "big")
                if first & WRITE_BIT:
                    chip.write(first & ADDRESS_MAX, data)
                    self._data = data
                else:
                    self._data = chip.read(first)
            return self.faults.pass_on(self.model, received, self._noise)

    def _selected(self) -> None:
        """A datagram begins."""

    def _power_cycle(self) -> None:
        self._chip.reset()
        self._data = 0

    def _run(self, until_s: float) -> None:
        self._chip.advance(self._clocks(until_s, self._clock_hz))

    @property
    def _quiet(self) -> bool:
        return self._chip.quiet


class UartEmulatorBase40(EmulatorBase40[UartChipT, ChangeT, StateT]):
    """The same of chips of which some have a UART: `uart` is its single wire; `read` and `write` are what both buses
    reach, for an evaluation board whose firmware does the framing."""

    def __init__(self, clock: Clock, time_scale: float, chip: UartChipT, clock_hz: float, seed: int) -> None:
        super().__init__(clock, time_scale, chip, clock_hz, seed)
        self._uart = UartEnd(chip)

    # --- UART ------------------------------------------------------------------------------------

    def uart(self, datagram: bytes, at_s: float | None = None) -> bytes:
        """Answer one whole datagram of the single-wire UART at chip time `at_s` [s], by default now.

        b"" where nothing is answered: a write, a wrong CRC, another node, no such datagram, a chip without UART. Then
        nothing was obeyed either, but for the write. Raises ConnectionError while unplugged and TimeoutError while
        silent, for a question only.
        """
        self.faults.require_plugged(self.model)
        with self._lock:
            self._run_until(at_s)
            reply = self._uart.answer(datagram)
            return self.faults.pass_on(self.model, reply, self._noise) if reply else b""

    @property
    def reply_delay_bits(self) -> int:
        """Bit times between the end of a question and the answer: NODECONF.SENDDELAY."""
        return self._uart.reply_delay_bits

    # --- registers -------------------------------------------------------------------------------

    def read(self, address: int, at_s: float | None = None) -> int:
        """The word that a bus reads at `address`, with all consequences (flags that a read clears)."""
        self.faults.require_plugged(self.model)
        with self._lock:
            self._run_until(at_s)
            return self._chip.read(address)

    def write(self, address: int, data: int, at_s: float | None = None) -> None:
        """Write 32 bits as a bus does. IFCNT counts only what came over the UART."""
        self.faults.require_plugged(self.model)
        with self._lock:
            self._run_until(at_s)
            self._chip.write(address, data)
