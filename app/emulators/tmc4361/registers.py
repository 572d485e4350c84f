"""The register file behind the datagrams: what a write changes and what a read gives.

A write takes effect at once. A read is taken right after the datagram that asks for it (DS-TMC4361 5.1.1); that
EVENTS is cleared in the same moment is a choice, as is that writing ones to EVENTS clears them (the later chip does).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...registers.model import Register
from ...registers.tmc4361.table import TMC4361
from ..drive import kernel as motor
from . import kernel, recording
from . import layout as c
from .driver import TMC24X_FORMS, KeptWords, bits_of, tmc24x_answer
from .feedback import FeedbackOptions, FeedbackUnit
from .feedback import layout as fl
from .kept_registers import BITS as BITS_2130
from .kept_registers import FORMS, KeptRegisters
from .pins import levels
from .spi_output import Sent

MASK = 0xFFFF_FFFF
VERSION_NO = 2
"""No source tells what a TMC4361-LA answers; a TMC4361A's version is taken."""
RESET_WORD = 0x525354
SPI_OUT_CONF, CHOPSYNC_DIV = 0x04, 0x1F
TMC24X_FORMAT = 9
"""spi_output_format."""
_RAMP = frozenset(
    (
        *(c.GENERAL_CONF, c.REFERENCE_CONF, c.START_CONF, c.GEAR_RATIO, c.XTARGET, c.FREEZE, c.CIRCULAR_DEC),
        *range(c.RAMPMODE, c.CLK_FREQ + 1),
        *(c.XACTUAL, c.R_X_LATCH),
    )
)
"""Registers that the ramp generator goes by."""
_WAITING = {c.XTARGET: 1, c.R_VMAX: 2, c.RAMPMODE: 4, c.GEAR_RATIO: 8}
"""start_en's bit of each register that may wait for a start."""
_KEPT = (c.TICK, c.CLOCK, c.FIELD, c.FORCE, c.FORCED, c.EXT_LEFT, c.NET)
_KEPT_REALS = (c.LEFT_AT, c.RIGHT_AT, c.HOME_LOW, c.HOME_HIGH, c.EXT_RATE)


def _masks() -> tuple[list[int], dict[int, int], frozenset[int]]:
    """What a write to each address may change, words after power-on, and addresses that cannot be read."""
    masks = [0] * c.ADDRESSES
    resets: dict[int, int] = {}
    readable: set[int] = set()
    row: Register
    for row in TMC4361:
        if row.access.readable:
            readable.add(row.address)
        if row.access.writable:
            masks[row.address] |= row.write_mask
            if not row.when:
                resets[row.address] = row.reset or 0
    return masks, resets, frozenset(range(c.ADDRESSES)) - readable


_MASKS, _RESETS, _WRITE_ONLY = _masks()


class Chip:
    """One TMC4361 with its motor, at clocks of its own. Not thread-safe."""

    def __init__(self, options: FeedbackOptions, clock_hz: float) -> None:
        self.r: c.Cells = np.zeros(c.ADDRESSES, dtype=np.int64)
        self.s: c.Cells = np.zeros(c.INTEGERS, dtype=np.int64)
        self.f: c.Floats = np.zeros(c.REALS, dtype=np.float64)
        self.feedback = FeedbackUnit(options, clock_hz)
        self._kept_words = KeptWords()
        self._kept_registers = KeptRegisters()
        self._general_told = 0
        self._selected: tuple[int, ...] = ()
        self._freeze_written = False
        self._readers: dict[int, Callable[[], int]] = {
            c.XACTUAL: lambda: int(self.s[c.X]),
            c.VACTUAL: lambda: int(self.f[c.V]),
            c.AACTUAL: lambda: int(self.f[c.A]),
            c.R_X_LATCH: self._read_latch,
            c.R_EVENTS: self._read_events,
            c.R_STATUS: lambda: int(self.s[c.STATUS]),
            c.COVER_LOW: self._polled,
            c.COVER_HIGH: lambda: 0,
            c.COVER_DRV_LOW: lambda: self._cover_answer & MASK,
            c.COVER_DRV_HIGH: lambda: self._cover_answer >> 32,
            c.VERSION: lambda: VERSION_NO,
        }
        self._cover_answer = 0
        self.forced: dict[int, bool] = {}
        """Levels that the bench holds pins at."""
        self.wired: dict[int, bool] = {}
        """Those that wires to other chips put there."""
        self.reset()

    # --- power and time --------------------------------------------------------------------------

    def reset(self, power: bool = True) -> None:
        """Registers, counters and the ramp generator as after power-on; the plant stays, and time goes on.

        power : the supply was away, and a driver behind begins anew too
        """
        self.catch_up_driver()
        r, s, f = self.r, self.s, self.f
        kept = [(cell, int(s[cell])) for cell in _KEPT]
        kept_reals = [(cell, float(f[cell])) for cell in _KEPT_REALS]
        r[:] = 0
        s[:] = 0
        f[:] = 0.0
        for cell, value in kept:
            s[cell] = value
        for cell, real in kept_reals:
            f[cell] = real
        for address, word in _RESETS.items():
            r[address] = word
        for timer in (c.START_AT, c.GATE_AT, c.STANDBY_AT, c.COVER_AT, *range(c.FILTER, c.FILTER + c.PINS)):
            s[timer] = c.NEVER
        s[c.DIR] = 1
        s[c.START_OUT] = s[c.ZERO_WAIT] = s[c.TICK]
        s[c.READY] = s[c.FREE] = s[c.CLOCK]
        self.feedback.reset(power)
        self._kept_words = KeptWords()
        if power:
            self._kept_registers = KeptRegisters()
        self._cover_answer = 0
        self._freeze_written = False
        self._general_told = int(r[c.GENERAL_CONF])
        s[c.FEEDBACK] = c.FB_TARGET_OK
        # A pin that is active from the start has no edge, but a freeze is one.
        s[c.INPUTS] = levels(r, s, f, self.feedback.fb)
        s[c.SEEN] = int(s[c.INPUTS]) | c.PIN_FREEZE
        self.settle(True)
        s[c.EVENTS] = 1 << 31
        self._select()

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        if clock > self.s[c.CLOCK]:
            kernel.advance(self.r, self.s, self.f, self.feedback.fb, clock, 0)
            if self.r[c.GENERAL_CONF] != self._general_told:  # the pipeline has changed it
                self._tell(c.GENERAL_CONF)

    def record(self, clocks: c.Cells) -> c.Cells:
        """Catch up to the last of `clocks`, which rise: steps sent by each, or by as many as there was time for."""
        sent = np.zeros(len(clocks), dtype=np.int64)
        reached = recording.record(self.r, self.s, self.f, self.feedback.fb, clocks, sent)
        if self.r[c.GENERAL_CONF] != self._general_told:  # the pipeline has changed it
            self._tell(c.GENERAL_CONF)
        return sent[:reached]

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written."""
        return bool(self.s[c.IDLE]) and self.s[c.WAKE] == c.NEVER

    def settle(self, ramp: bool = False) -> None:
        """Take over what was changed from outside."""
        clock = int(self.s[c.CLOCK])
        kernel.advance(self.r, self.s, self.f, self.feedback.fb, clock, 2 if ramp else 1)

    def hold_pins(self) -> None:
        """Pins have other levels from outside: what the bench forces, else what other chips drive."""
        held = self.wired | self.forced
        self.s[c.FORCE], self.s[c.FORCED] = sum(held), sum(pin for pin, high in held.items() if high)
        self.settle()

    # --- datagrams -------------------------------------------------------------------------------

    @property
    def spi_status(self) -> int:
        """SPI_STATUS: the first eight events of SPI_STATUS_SELECTION, packed from bit 0 (DS-TMC4361 7.2)."""
        events = int(self.s[c.EVENTS])
        status = 0
        for place, event in enumerate(self._selected):
            status |= (events >> event & 1) << place
        return status

    def wake(self) -> None:
        """Datagrams start stopped clocks again (a choice: no source tells what does, besides START)."""
        if self.s[c.GATED]:
            self.s[c.GATED] = 0
            self.s[c.GATE_AT] = c.NEVER
            self.r[c.RESET_CLK_GATING] &= ~7
            self.settle()

    def read(self, address: int) -> int:
        """The word at `address`; 0 where nothing can be read. Reading EVENTS and ENC_LATCH has consequences."""
        reader = self._readers.get(address)
        if reader is not None:
            return reader() & MASK
        word = self.feedback.read(address)
        if word is not None:
            self.s[c.IDLE] = 0
            return word
        return 0 if address in _WRITE_ONLY else int(self.r[address])

    def write(self, address: int, word: int) -> None:
        """Write `word`; bits that the register does not have are dropped, as are writes to what cannot be written."""
        if address == c.R_EVENTS:
            self.s[c.EVENTS] &= ~word
            self.settle()
            return
        word &= _MASKS[address]
        match address:
            case c.RESET_CLK_GATING if word >> 8 == RESET_WORD:
                self.reset(power=False)
                return
            case c.FREEZE:
                if self._freeze_written or self.f[c.V] != 0.0:
                    return
                self._freeze_written = True
            case c.COVER_LOW:
                self._cover(int(self.r[c.COVER_HIGH]) << 32 | word)
        changed = self.r[address] != word
        if _MASKS[address]:
            self.r[address] = word
        self._act(address, word)
        self._tell(address)
        self.settle(address in _RAMP and (changed or address in (c.XACTUAL, c.XTARGET)))

    def _act(self, address: int, word: int) -> None:
        s = self.s
        waiting = _WAITING.get(address, 0) & int(self.r[c.START_CONF])
        if waiting:
            s[c.PENDING] |= waiting
        match address:
            case c.XACTUAL:
                s[c.X], s[c.SURPLUS] = _signed(word), 0
            case c.R_X_LATCH:
                s[c.X_RANGE] = word & 0x7FFFFFFF
            case c.REFERENCE_CONF if not word >> 22 & 1:
                s[c.REV_CNT] = s[c.SURPLUS] = 0
            case c.SPI_STATUS_SELECTION:
                self._select()

    def _tell(self, address: int) -> None:
        word = int(self.r[address])
        if address == c.GENERAL_CONF:
            self._general_told = word
        if _MASKS[address]:
            self.feedback.write(address, word)
        self.s[c.IDLE] = 0

    def _select(self) -> None:
        mask = int(self.r[c.SPI_STATUS_SELECTION])
        self._selected = tuple(bit for bit in range(32) if mask >> bit & 1)[:8]

    # --- readers ---------------------------------------------------------------------------------

    def _read_latch(self) -> int:
        return int(self.s[c.REV_CNT if self.r[c.GENERAL_CONF] >> 27 & 1 else c.X_LATCH])

    def _read_events(self) -> int:
        events = int(self.s[c.EVENTS])
        self.s[c.EVENTS] = events & int(self.r[c.EVENT_CLEAR_CONF])
        self.settle()
        return events

    def _polled(self) -> int:
        """POLLING_STATUS: the driver's latest answer, or what one that keeps words alone would answer now."""
        driver = self.feedback.driver
        if driver is not None:
            return driver.polled(int(self.s[c.STATUS]) >> 24 & 0xFF)
        if self._tmc24x:
            return self._tmc24x_answer
        return self._driver_load << 10 | int(self.s[c.STATUS]) >> 24 & 0xFF

    @property
    def _tmc24x(self) -> bool:
        """Whether the bridges that the chip drives are to be those of a TMC23x or TMC24x."""
        return int(self.r[SPI_OUT_CONF]) & 15 in TMC24X_FORMS

    @property
    def _tmc24x_answer(self) -> int:
        measures = int(self.r[SPI_OUT_CONF]) & 15 == TMC24X_FORMAT
        return tmc24x_answer(self.feedback.flags_from_outside, self._driver_load >> 7 if measures else 0)

    def catch_up_driver(self) -> None:
        """Bring a driver behind that rests to the chip's time."""
        self.feedback.catch_up(int(self.s[c.CLOCK]))

    @property
    def driver_words(self) -> dict[str, int]:
        """What has been written into the driver, as datagrams: of a real one every register, of words that are kept
        those that came."""
        driver = self.feedback.driver
        if driver is None and int(self.r[SPI_OUT_CONF]) & 15 in FORMS:
            return self._kept_registers.named
        if driver is None:
            return dict(self._kept_words.words)
        self.feedback.told_by_chip(driver)
        return driver.words

    @property
    def _driver_load(self) -> int:
        cells = self.feedback.fb[fl.INTEGERS_AT :].view(np.int64)
        return int(cells[motor.SG])

    def _cover(self, datagram: int) -> None:
        """Send a cover datagram. It is through, and COVER_DONE there, when its bits have been clocked out."""
        conf = int(self.r[SPI_OUT_CONF])
        bits = bits_of(conf)
        clocks = bits * max((conf >> 20 & 15) + (conf >> 24 & 15), 2)
        mscnt = self.feedback.read(0x79) or 0
        flags = int(self.s[c.STATUS]) >> 24
        datagram &= (1 << bits) - 1
        driver = self.feedback.driver
        if driver is None and conf & 15 in FORMS and bits == BITS_2130:
            self._cover_answer = self._kept_registers.exchange(datagram, flags, mscnt, self._driver_load)
        elif driver is None and self._tmc24x:
            self._cover_answer = self._tmc24x_answer
        elif driver is None:
            self._cover_answer = self._kept_words.exchange(datagram, flags, mscnt, self._driver_load)
        else:
            self.catch_up_driver()
            self._cover_answer = self.feedback.exchange_with_driver(driver, datagram, bits)
        self.s[c.COVER_AT] = int(self.s[c.TICK]) + 1 + clocks // c.TICK_CLOCKS

    # --- outputs ---------------------------------------------------------------------------------

    @property
    def intr(self) -> bool:
        """Level at INTR: the OR of the events that INTR_CONF chooses, with intr_pol."""
        active = bool(int(self.s[c.EVENTS]) & int(self.r[c.INTR_CONF]))
        return active == bool(self.r[c.GENERAL_CONF] >> 15 & 1)

    @property
    def target_reached(self) -> bool:
        """Level at TARGET_REACHED: the flag that pos_comp_output chooses, high unless inverted."""
        chosen = int(self.r[c.REFERENCE_CONF]) >> 23 & 3
        active = bool(int(self.s[c.STATUS]) >> (0, 2, 14, 1)[chosen] & 1)
        return active != bool(self.r[c.GENERAL_CONF] >> 16 & 1)

    @property
    def spi_sent(self) -> Sent | None:
        """What the SPI output sends by itself."""
        rate, velocity = float(self.f[c.A]), float(self.f[c.V])
        return self.feedback.sent_by_itself(moving=velocity != 0.0, falling=rate * velocity < 0.0)

    @property
    def _phase_levels(self) -> tuple[bool, bool] | None:
        sent = self.spi_sent
        return None if sent is None else sent.phases

    @property
    def direction_level(self) -> bool:
        """Level at DIROUT: pol_dir_out is that of the negative direction; the phase of B where a DAC needs one."""
        levels = self._phase_levels
        if levels is not None:
            return levels[1]
        negative = bool(self.r[c.GENERAL_CONF] >> 5 & 1)
        return negative if self.s[c.DIR] < 0 else not negative

    @property
    def step_level(self) -> bool:
        """Level at STPOUT between pulses; with toggle_step it tells whether an odd number of steps was made. The phase
        of A where a DAC needs one."""
        levels = self._phase_levels
        if levels is not None:
            return levels[0]
        general = int(self.r[c.GENERAL_CONF])
        return bool(general >> 3 & 1) != bool(general >> 4 & 1 and int(self.s[c.STEPS]) & 1)

    @property
    def standby_level(self) -> bool:
        """Level at STDBY_CLK while it tells standby (stdby_clk_pin_assignment 0: low active, 1: high active)."""
        chosen = int(self.r[c.GENERAL_CONF]) >> 13 & 3
        return chosen < 2 and bool(self.s[c.STANDBY]) == bool(chosen)

    def clock_out_hz(self, clock_hz: float) -> float | None:
        """The clock at STDBY_CLK (stdby_clk_pin_assignment 2: chopSync's, fCLK / CHOPSYNC_DIV; 3: fCLK).

        With auto_double_chopsync and a TMC24x it is twice that at standstill (STEPPYR). None where there is none.
        """
        chosen = int(self.r[c.GENERAL_CONF]) >> 13 & 3
        if chosen < 2 or self.s[c.GATED]:
            return None
        if chosen == 3:
            return clock_hz
        divider = int(self.r[CHOPSYNC_DIV]) & 0xFFF
        output = int(self.r[SPI_OUT_CONF])
        doubled = output & 15 == TMC24X_FORMAT and output >> 12 & 1 and self.f[c.V] == 0.0
        return None if divider == 0 else clock_hz / divider * (2 if doubled else 1)


def _signed(word: int) -> int:
    return word - (1 << 32) if word >> 31 else word
