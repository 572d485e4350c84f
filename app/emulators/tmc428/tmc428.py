"""The emulated TMC428: driver chain, microstep table and shared switch inputs around three axes."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import partial

from ...registers.catalog import MODELS
from ...registers.tmc428.tmc428 import RAM_CHAIN, RAM_TABLE, SIGNAL_CODES
from . import chain
from . import kernel as k
from .chain import Datagram, Polarity, Selects, Signals
from .chip import CLK2_DIV_RESET, GLOBAL, SWITCHES, Chip
from .drives import ChainDrives, Record
from .options import EmulatorOptions
from .sequencer import Coils, increment
from .state import ChainBit, ChainState, DriverState

STAGE_UNITS = 64
"""Stage positions are kept in 1/64 full steps, the finest microstep."""
LOW_WORD, HIGH_WORD, COVER, COVER_DATAGRAM = 0x30, 0x31, 0x32, 0x33
CURRENT = 0x8
_WIRINGS = {"left-only": k.LEFT_ONLY, "two-one-null": k.TWO_ONE_NULL, "multiplexed": k.MULTIPLEXED}
_LONGEST_COVER = 24
SLICE_CLOCKS = 16384
"""About a millisecond: how far carriages may run ahead of shafts, by the steps that are made meanwhile."""


class Tmc428(Chip):
    """The chip, its three drivers and their stages."""

    kind = k.TMC428_KIND
    name = "tmc428"

    def __init__(self, options: EmulatorOptions) -> None:
        self.ram = [0] * 128
        self.driver_status = [chain.DRIVER_STATUS_HEALTHY] * chain.DRIVERS_ON_BOARD
        self.drives = ChainDrives(options) if options.drivers else None
        self._outside = 0
        """Where the drivers are, in clocks of the outside."""
        super().__init__(MODELS[self.name], options, self._units(options))

    def _units(self, options: EmulatorOptions) -> int:
        """Stage units of a full step."""
        del options  # an external driver's microsteps are not its own
        return STAGE_UNITS

    def _power_on_ram(self) -> list[int]:
        """Not initialised by power-on (DS-TMC428 7.3)."""
        noise = random.Random(f"{self.options.seed} {self.power_cycles}")
        return [noise.getrandbits(6) for _ in range(128)]

    def _reset(self) -> None:
        self.ram = self._power_on_ram()
        self._shift = 0
        self._cover_pos_stored = 0
        self._last: Datagram | None = None
        self._last_count = 0
        self._captured: Datagram | None = None
        self.axes[:, k.INC] = increment(0)
        if self.drives is not None:
            self.chip[k.LOG_ON] = 1
            self.drives.reset()
        self.chip[k.WIRING] = _WIRINGS[self.options.wiring]
        self._write_global(CLK2_DIV_RESET)

    # --- drivers with motors ---------------------------------------------------------------------

    def advance(self, clock: int) -> int:
        """In slices at whole multiples of `SLICE_CLOCKS`, where there are motors: behind each the carriages are where
        the shafts are, whatever was stepped."""
        if self.drives is None:
            return super().advance(clock)
        while True:
            boundary = (self._outside // SLICE_CLOCKS + 1) * SLICE_CLOCKS
            self._outside = until = max(min(clock, boundary), self._outside)
            status = super().advance(until)
            self._drive_motors(self.drives, until)
            if until >= clock:
                return status

    def _drive_motors(self, drives: ChainDrives, until: int) -> None:
        chip, width = self.chip, k.LOG_WIDTH
        count = int(chip[k.LOGGED])
        if count:
            cells = chip[k.CHIP_CELLS : k.CHIP_CELLS + count * width].tolist()
            chip[k.LOGGED] = 0
            lengths = self._driver_lengths()
            for at in range(0, count * width, width):
                motors = tuple(
                    Signals(*cells[at + 1 + k.SNAP_WIDTH * n : at + 1 + k.SNAP_WIDTH * (n + 1)]) for n in range(3)
                )
                record = Record(
                    cells[at] + self._offset, motors, bool(cells[at + width - 2]), bool(cells[at + width - 1])
                )
                drives.take(record, lengths, self._bits_of, self.selects)
        drives.advance(until, self.driver_status)
        if until % SLICE_CLOCKS == 0:
            self._carry(drives)

    def _carry(self, drives: ChainDrives) -> None:
        """Carriages go to where the shafts are."""
        moved = False
        for index in range(self.model.axes):
            shaft = drives.shaft_fullsteps(index)
            if shaft is not None and (place := round(shaft * self.stage_units)) != self.axes[index, k.MECH]:
                self.axes[index, k.MECH] = place
                moved = True
        if moved and not self.powered_down:
            k.refresh(self.axes, self.chip)

    def _driver_lengths(self) -> list[int]:
        """Bits of each driver in the RAM."""
        drivers = [place.driver for place in self._places or ()]
        return [drivers.count(driver) for driver in dict.fromkeys(drivers)]

    def _bits_of(self, record: Record) -> tuple[int, ...]:
        return self._compose_signals(record.motors, covered=record.covered).bits

    @property
    def quiet(self) -> bool:
        return super().quiet and (self.drives is None or self.drives.quiet)

    def _map_registers(self) -> None:
        super()._map_registers()
        for index in range(self.model.axes):
            self._writers[index << 4 | CURRENT] = partial(self._write_current, index)
        self._readers[LOW_WORD] = partial(self._read_reply, 0)
        self._readers[HIGH_WORD] = partial(self._read_reply, 24)
        self._readers[COVER] = self._read_cover
        self._readers[SWITCHES] = self._read_switches
        self._writers[LOW_WORD] = self._writers[HIGH_WORD] = self._arm_capture
        self._writers[COVER] = self._write_cover
        self._writers[COVER_DATAGRAM] = self._write_cover_datagram
        self._writers[GLOBAL] = self._write_global
        for address in range(RAM_CHAIN, 0x80):
            self._readers[address] = partial(self._read_ram, address)
            self._writers[address] = partial(self._write_ram, address)

    # --- axis registers of its own ---------------------------------------------------------------

    def _write_current(self, index: int, data: int) -> None:
        self._words[index << 4 | CURRENT] = data
        axis = self.axes[index]
        axis[k.ATH] = data & 0x7FF
        axis[k.ISV0] = data >> 12 & 7
        axis[k.ISAL] = data >> 16 & 7
        axis[k.ISAG] = data >> 20 & 7

    def _microstep(self, index: int) -> None:
        """By usrs, how far a step moves the wave index and the motor; the index itself stays (DS-TMC428 12.1)."""
        width = increment(self._words[index << 4 | 0xC] & 7)
        turned = self._words[GLOBAL] >> 4 & 1
        self.axes[index, k.INC] = width
        # The sheet: inverting the phase bits turns the motor round (DS-TMC428 9.7).
        self.axes[index, k.MINC] = -width if turned else width

    # --- global registers ------------------------------------------------------------------------

    def _read_switches(self) -> int:
        bits = 0
        for index in range(self.model.axes):
            bits |= (self._get(index, k.SR) | self._get(index, k.SL) << 1) << 2 * index
        return bits

    def _write_global(self, data: int) -> None:
        self._settle_datagrams()
        self._words[GLOBAL] = data
        # three individual selects are always low active (DS-TMC428 9.7)
        self.chip[k.IDLE] = 1 if data >> 7 & 1 else 1 - (data >> 2 & 1)
        self.chip[k.CU] = data >> 16 & 1
        self.chip[k.REFMUX] = data >> 20 & 1
        self.chip[k.MOT1R] = data >> 21 & 1
        for index in range(self.model.axes):
            self._microstep(index)
        self._configure_chain()

    def _read_ram(self, address: int) -> int:
        cell = 2 * (address - RAM_CHAIN)
        return self.ram[cell] | self.ram[cell + 1] << 8

    def _write_ram(self, address: int, data: int) -> None:
        self._settle_datagrams()
        cell = 2 * (address - RAM_CHAIN)
        self.ram[cell] = data & 0x3F
        self.ram[cell + 1] = data >> 8 & 0x3F
        self._configure_chain()

    # --- driver chain ----------------------------------------------------------------------------

    def _configure_chain(self) -> None:
        word = self._words[GLOBAL]
        if self.drives is not None:
            self.drives.forget_words()
        self._places = chain.walk(self.ram, word & 3)
        duration = chain.duration_clocks(self._places, word >> 8 & 0xFF)
        self.chip[k.DURATION] = duration
        if self.chip[k.BUSY] and self.chip[k.BUSY_UNTIL] >= k.NEVER > duration:
            # An unbounded datagram meets an NxM bit at last.
            self.chip[k.BUSY_UNTIL] = self.chip[k.CLOCK] + duration

    def _compose(self, snapshot: int) -> Datagram:
        """The datagram whose signals stand at `snapshot` of the kernel's array, with today's RAM."""
        cells = self.chip[snapshot : snapshot + 3 * k.SNAP_WIDTH + 1].tolist()
        motors = [Signals(*cells[at : at + k.SNAP_WIDTH]) for at in range(0, 3 * k.SNAP_WIDTH, k.SNAP_WIDTH)]
        return self._compose_signals(motors, covered=bool(cells[-1]))

    def _compose_signals(self, motors: Sequence[Signals], *, covered: bool) -> Datagram:
        word = self._words[GLOBAL]
        length = min(self._words[COVER] & 0x1F, _LONGEST_COVER)
        cover = (self._cover_pos_stored - 1, length, self._words[COVER_DATAGRAM]) if covered else None
        polarity = Polarity(ph=word >> 4 & 1, fd=word >> 5 & 1, dac=word >> 6 & 1)
        table = self.ram[2 * (RAM_TABLE - RAM_CHAIN) :]
        return chain.compose(self._places, motors, table, polarity, cover)

    def _settle_datagrams(self) -> None:
        """Compose what was sent so far, before something that it is made of changes; take in its reply.

        The kernel keeps only the signals of the last datagram and of the captured one: bits are made
        when they are read.
        """
        if self.chip[k.SENT_COUNT] != self._last_count:
            self._last_count = int(self.chip[k.SENT_COUNT])
            self._last = self._compose(k.SNAP)
        capture = self.chip[k.CAPTURE]
        if capture < 2:
            return
        if self._captured is None:
            self._captured = self._compose(k.CAPTURED)
        if capture == 3:
            came = self.selects.reply(self._parts(self._captured), self.driver_status)
            for bit in came if self.drives is None or not self.selects.fit else self.drives.answer:
                self._shift = (self._shift << 1 | bit) & 0xFFFF_FFFF_FFFF
            self._captured = None
            self.chip[k.CAPTURE] = 0

    @property
    def selects(self) -> Selects:
        """Which chip selects there are."""
        return Selects(bool(self._words[GLOBAL] >> 7 & 1), self.options.chip_selects == "individual")

    @staticmethod
    def _parts(datagram: Datagram) -> list[list[int]]:
        """The bits of each driver, in order."""
        parts: dict[int, list[int]] = {}
        for place, bit in zip(datagram.places, datagram.bits, strict=True):
            parts.setdefault(place.driver, []).append(bit)
        return list(parts.values())

    def _read_reply(self, shift: int) -> int:
        self._settle_datagrams()
        return self._shift >> shift & 0xFF_FFFF

    def _arm_capture(self, _data: int) -> None:
        """Clears both words and waits for the next reply of the chain (DS-TMC428 9.1)."""
        self._settle_datagrams()
        self._shift = 0
        self.chip[k.CAPTURE] = 1

    def _read_cover(self) -> int:
        # The chip keeps cover_pos + 1 (DS-TMC428 9.2), in six bits.
        waits = 1 if self.chip[k.CW] else 0
        return self._words[COVER] & 0x1F | self._cover_pos_stored << 8 | waits << 23

    def _write_cover(self, data: int) -> None:
        self._settle_datagrams()
        self._words[COVER] = data
        self._cover_pos_stored = (data >> 8 & 0x3F) + 1 & 0x3F

    def _write_cover_datagram(self, data: int) -> None:
        """Covers the next datagram, and asks for one; its reply is captured too (DS-TMC428 9.1, 9.3)."""
        self._settle_datagrams()
        self._words[COVER_DATAGRAM] = data
        self.chip[k.CW] = 1
        self.chip[k.CAPTURE] = 1
        self.chip[k.REQ] = 1

    def describe_chain(self) -> ChainState:
        """The chain as the API tells it."""
        self._settle_datagrams()
        last = self._last
        duration = int(self.chip[k.DURATION])
        drivers = []
        none = (Coils(0, 0, 0, 0, 0, 0),) * (0 if self.drives is None else len(self.drives.drivers))
        for driver, state in enumerate(last.coils if last else none):
            told = None if self.drives is None else self.drives.describe(driver)
            bits = (
                [
                    ChainBit(signal=SIGNAL_CODES.get(place.code, "One"), value=bit)
                    for place, bit in zip(last.places, last.bits, strict=True)
                    if place.driver == driver
                ]
                if last
                else []
            )
            drivers.append(
                DriverState(
                    driver=driver,
                    bits=bits,
                    **state._asdict(),
                    status=self.driver_status[driver],
                    selected=self.selects.fit,
                    motor=None if told is None else told[0],
                    truth=None if told is None else told[1],
                    load=None if told is None else told[2],
                )
            )
        return ChainState(
            datagrams_sent=int(self.chip[k.SENT_COUNT]),
            busy=bool(self.chip[k.BUSY]),
            endless=duration >= k.NEVER,
            duration_us=None if duration >= k.NEVER else duration / self.options.clock_hz * 1e6,
            last_bits="".join(map(str, last.bits)) if last else "",
            covered=bool(self.chip[k.COVERED]),
            drivers=drivers,
        )
