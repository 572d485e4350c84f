"""The register file behind SPI and UART: what a write changes and what a read gives, of all chips.

A write takes effect at once, a read is taken when its datagram has come. Registers that can only be written read as 0.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ...registers.model import Access, Register
from ...registers.tmc5xxx.table import TABLES
from .axis import LIVE, Axis
from .chips import CHIPS
from .options import Tmc5xxxModel, Tmc5xxxOptions

GCONF, NODECONF, OUTPUT = 0x00, 0x03, 0x04
_RESET, _DRV_ERR, _UV_CP = 1, 2, 4
"""GSTAT of a TMC5160, which is what a drive has."""
_REGISTER_RESET, _VM_UVLO = 8, 16
"""What a TMC5240 has besides: after power-on the first (a reading), and whether its supply was too low."""
_EVENTS = 0xF0
"""RAMP_STAT: stops left, right and by StallGuard2, position reached."""


class Chip:
    """One TMC5xxx with its motors, at clocks of its own. Not thread-safe."""

    def __init__(self, model: Tmc5xxxModel, options: Tmc5xxxOptions) -> None:
        self.kind = CHIPS[model]
        self.table = TABLES[model]
        self.has_encoder = self.table.find("X_ENC", 0) is not None
        self.axes = tuple(Axis(self.kind, options, self.has_encoder) for _ in range(self.kind.axes))
        self._clock = 0
        self._drv_enn = False
        self.node_pin = options.node_pin
        self._external_clock = options.clock_hz != self.kind.clock_hz
        self.ifcnt = 0
        self._gstat_more = 0
        self._words: dict[int, int] = {}
        self._encoders = [True] * self.kind.axes
        self._readers = {row.address: self._reader(row) for row in self.table if row.access.readable and not row.when}
        self.reset()

    # --- power and time --------------------------------------------------------------------------

    def reset(self) -> None:
        """Registers and ramp generators as after power-on; the plant stays, and time goes on."""
        self._words = {}
        self.ifcnt = 0
        self._gstat_more = _REGISTER_RESET & self.table.get("GSTAT").mask
        for axis in self.axes:
            axis.reset()
        self.supply_changed()
        for row in self.table:
            if row.access.writable and row.access is not Access.R_W1C and not row.when:
                self._take(row, row.reset or 0)

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        if clock > self._clock:
            self._clock = clock
            for axis in self.axes:
                axis.drive.advance(clock)

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written."""
        return all(axis.drive.quiet for axis in self.axes)

    # --- the buses -------------------------------------------------------------------------------

    def read(self, address: int) -> int:
        """The word at `address`; 0 where nothing can be read. Flags of chips that clear them by reading are cleared."""
        reader = self._readers.get(address)
        return reader() if reader else 0

    def write(self, address: int, word: int) -> None:
        """Write `word`; bits that the register does not have are dropped, as are writes to what cannot be written."""
        row = self.table.at(address, write=True)
        if row is None or not row.access.writable:
            return
        word &= row.write_mask
        if row.access is Access.R_W1C:
            self._clear(row, word)
        elif address != GCONF or not self._gconf("lock_gconf"):
            self._take(row, word)

    def held(self, address: int) -> int:
        """What was written there last."""
        return self._words.get(address, 0)

    def _reader(self, row: Register) -> Callable[[], int]:
        """What answers for a register."""
        match row.name:
            case "GSTAT":
                read: Callable[[], int] = partial(getattr, self, "gstat")
            case "IFCNT":
                read = partial(getattr, self, "ifcnt")
            case "IOIN" | "INPUT":
                read = partial(self._pins, row)
            case name if name in LIVE:
                read = self.axes[row.axis or 0].reader(row)
            case _:
                read = partial(self.held, row.address)
        return partial(self._read_and_clear, row, read) if row.read_clears else read

    def _read_and_clear(self, row: Register, read: Callable[[], int]) -> int:
        word = read()
        self._clear(row, word)
        return word

    def _take(self, row: Register, word: int) -> None:
        self._words[row.address] = word
        if row.axis is not None:
            self.axes[row.axis].write(row, word)
        elif row.address != GCONF:
            for axis in self.axes:  # the microstep table of a TMC5072
                axis.write(row, word)
        if row.name in ("GCONF", "PWMCONF"):
            self._configure()

    def _clear(self, row: Register, ones: int) -> None:
        if row.name == "GSTAT":
            self._gstat_more &= ~ones
            for axis in self.axes:
                axis.drive.write("GSTAT", _RESET | _DRV_ERR | _UV_CP if row.read_clears else ones)
        else:
            self.axes[row.axis or 0].clear(row, ones)

    # --- UART ------------------------------------------------------------------------------------

    @property
    def has_uart(self) -> bool:
        return self.kind.uart != ""

    @property
    def node(self) -> int | None:
        """Address on the UART: NODECONF, one more with NEXTADDR high; None: the chip has none (TMC5062) or no UART."""
        return (self.held(NODECONF) & 0xFF) + self.node_pin & 0xFF if self.kind.uart == "node" else None

    @property
    def send_delay(self) -> int:
        """NODECONF.SENDDELAY."""
        return self.held(NODECONF) >> self.kind.delay_bit & 15

    # --- GCONF -----------------------------------------------------------------------------------

    def _gconf(self, field: str) -> int:
        """A bit of GCONF; 0 where the chip does not have it."""
        part = self.table.get("GCONF").field_named(field)
        return part.unpack(self.held(GCONF)) if part else 0

    def _configure(self) -> None:
        bit, single = self._gconf, self.kind.single
        for index, axis in enumerate(self.axes):
            axis.configure(
                shaft=bit("shaft" if single else f"shaft{index + 1}"),
                stealth_chop=bit("en_pwm_mode") if single else 1,
                fast_standstill=bit("faststandstill"),
            )
        if self.has_encoder and not single:
            # A and B of encoder 2 come in where the right switches do, an N line may where a left one does
            self._encoders = [not bit("poscmp_enable"), bool(bit("enc2_enable"))]
            for index, axis in enumerate(self.axes):
                left = not bit(f"enc{index + 1}_refsel")
                axis.drive.wire_pins(left=left, right=not bit("enc2_enable"), encoder=self._encoders[index])

    # --- pins and status -------------------------------------------------------------------------

    @property
    def gstat(self) -> int:
        """GSTAT: dual chips have a driver error for each motor."""
        words = [axis.drive.gstat for axis in self.axes]
        if self.kind.single:
            return words[0] | self._gstat_more
        return words[0] & (_RESET | _DRV_ERR) | (words[1] & _DRV_ERR) << 1 | bool((words[0] | words[1]) & _UV_CP) << 3

    def supply_changed(self) -> None:
        """The motor supply is another now."""
        if self.axes[0].drive.undervoltage:
            self._gstat_more |= _VM_UVLO & self.table.get("GSTAT").mask

    @property
    def spi_status(self) -> int:
        """The first byte of every SPI reply, of this moment."""
        first = self.axes[0].drive
        ramp = first.ramp_stat
        if self.kind.single:
            standing, stalled = first.standing_or_stalled
            # velocity and position reached, both switches
            return first.gstat & 3 | stalled << 2 | standing << 3 | (ramp >> 8 & 3) << 4 | (ramp & 3) << 6
        second = self.axes[1].drive.ramp_stat
        reached, left = ramp >> 8 & 1 | (second >> 8 & 1) << 1, ramp & 1 | (second & 1) << 1
        return self.gstat & 7 | reached << 3 | left << 5

    @property
    def drv_enn(self) -> bool:
        """Level at DRV_ENN: high switches all bridges off."""
        return self._drv_enn

    @drv_enn.setter
    def drv_enn(self, level: bool) -> None:
        self._drv_enn = level
        for axis in self.axes:
            axis.drive.enabled = not level

    def encoder_connected(self, axis: int) -> bool:
        """Whether GCONF leaves the encoder its pins."""
        return self.has_encoder and self._encoders[axis]

    @property
    def position_compare(self) -> bool:
        """XACTUAL of motor 1 is X_COMPARE."""
        drive = self.axes[0].drive
        ahead, repeat = drive.read("XACTUAL") - drive.x_compare, drive.read("X_COMPARE_REPEAT")
        return ahead % repeat == 0 if repeat > 1 else ahead == 0

    @property
    def shows_position_compare(self) -> bool:
        """Whether a pin shows that."""
        return self.kind.single or bool(self._gconf("poscmp_enable"))

    @property
    def interrupt(self) -> bool:
        """Whether the interrupt output is active."""
        return any(axis.drive.ramp_stat & _EVENTS or axis.drive.read("ENC_STATUS") for axis in self.axes)

    def encoder_lines(self, axis: int) -> tuple[bool, bool, bool]:
        """Levels of A, B and N."""
        encoder = self.axes[axis].drive.external
        phase = encoder.counts & 3
        return phase in (1, 2), phase >= 2, encoder.absolute < 4

    def _pins(self, row: Register) -> int:
        """IOIN or INPUT: levels of the pins, and the version. Pins that nothing is wired to are low."""
        output, switches = self.held(OUTPUT), self.axes[0].drive.switches
        levels = {"DRV_ENN": self.drv_enn, "drv_enn_in": self.drv_enn, "DRV_ENN_CFG6": self.drv_enn}
        levels |= {"nextaddr_in": self.node_pin, "REFL_STEP": switches.left, "REFR_DIR": switches.right}
        levels |= {f"io{n}_in": bool(output >> n & output >> 8 + n & 1) for n in range(4)}
        if self.kind.single:
            a, b, n = self.encoder_lines(0)
            levels |= {"ENCA_DCIN_CFG5": a, "ENCB_DCEN_CFG4": b, "ENC_N_DCO": n, "ENC_N_DCO_CFG6": n}
            # a resistor at IREF is there, and the clock comes from outside unless it is the chip's own
            levels |= {"ENCA_CFG5": a, "ENCB_CFG4": b, "ENCN_CFG6": n, "OUTPUT": bool(output >> 12 & 1)}
            levels |= {"EXT_RES_DET": True, "EXT_CLK": self._external_clock}
        word = 0
        for part in row.fields:
            word |= (self.kind.version if part.name == "VERSION" else levels.get(part.name, False)) << part.lsb
        return word
