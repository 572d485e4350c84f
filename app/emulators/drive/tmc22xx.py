"""A driver with registers of 32 bits (TMC2130, TMC2209, TMC2240) and its motor: what a write changes and what a read
gives.

It follows STEP and DIR, a velocity of its own where it has VACTUAL, or with GCONF.direct_mode the coil currents that a
register tells it. A write takes effect at once, a read is taken when its datagram has come. Registers that can only be
written read as 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from ...registers.model import Access, Register, RegisterTable
from ...registers.tmc5xxx.driver import DRV_STATUS_5160
from . import adc, otp
from .drive import Drive, DriveCells, Followed
from .kernel import TUNED, Cells
from .options import DriveOptions
from .registers import ALIASES, READ_ONLY, WRITABLE
from .stepped import advance_by_steps
from .units import bits, signed

NODECONF, DIRECT = 0x03, 0x2D
PIN_MRES = (5, 3, 2, 4)
"""MRES by MS1 (1) and MS2 (2): 8, 32, 64 and 16 microsteps (DS-TMC2209 3.2)."""
_MRES, _VSENSE, _SENDDELAY = 24, 17, 8
_AUTOSCALE = 1 << 18
_HEAT = (120.0, 143.0, 150.0, 157.0)
_CLOCK_TRIM = 0x10
VREF_FULL_V = 2.5
"""From which on VREF scales the current no more (DS-TMC2209 8, 9)."""
_DRV_ERR = 2
_GSTAT = 7
_REGISTER_RESET, _VM_UVLO = 8, 16
"""What GSTAT of a TMC2240 has besides a drive's: after power-on the first (a reading), and whether its supply was too
low."""
_WARN_AT, _SUM = 16, 0xFF
_IRUN = 0x1F00
_RAMP: Followed = "ramp"
_STEPS: Followed = "steps"
_CURRENTS: Followed = "currents"

INSIDE = {part.name: part for part in DRV_STATUS_5160.fields}
"""The fields of DRV_STATUS as the drive has them, which is a TMC5160's."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One driver as the emulator sees it: what its register table does not say."""

    version: int
    uart: bool
    spi: bool
    clock_hz: float
    """fCLK, unless the bench says another [Hz]."""
    full_scale_a: float
    """Peak coil current at current scale 31 and vsense 0 [A]: as the chip's evaluation board has it."""
    vsense: float
    """Share of that with CHOPCONF.vsense set."""
    least_supply_v: float
    """The supply below which the bridges do not work [V]."""
    stealth_chop: int = TUNED
    """Its kind, as the kernel names them."""
    stall_guard_4: bool = False
    """Load is measured with StealthChop too."""
    ranges: tuple[float, ...] = (1.0,)
    """Share of full scale that the coils get, by DRV_CONF.CURRENT_RANGE."""
    scale_shift: int = 0
    """Bits that PWM_SCALE_SUM has more than eight."""
    power_down_less: int = 0
    """Delays of 2^18 clocks that TPOWERDOWN counts too many."""


class StepDirDriver:
    """One driver with its motor, at clocks of its own. Not thread-safe."""

    def __init__(
        self,
        kind: Kind,
        table: RegisterTable,
        options: DriveOptions,
        *,
        pins: int = 0,
        cells: DriveCells | None = None,
    ) -> None:
        """Just switched on.

        pins : levels of MS1 (1) and MS2 (2). cells : as of `Drive`
        """
        self.kind = kind
        self.table = table
        self.pins = pins
        self.ifcnt = 0
        self.drive = Drive(options, cells)
        self.drive.stall_guard_4 = self.kind.stall_guard_4
        self.drive.stealth_chop = self.kind.stealth_chop
        self.drive.least_supply_v = self.kind.least_supply_v
        self._clock = 0
        self._enn = False
        self._gstat_more = 0
        self._external_clock = options.clock_hz != self.kind.clock_hz
        self._step_hz = 0.0
        self._stepped = False
        """Whether steps come one by one."""
        self._following: Followed = _RAMP
        self.steps_made = 0
        """Of those, since power-on."""
        self._vref_v = VREF_FULL_V
        self._memory = _CLOCK_TRIM
        """What is burnt into it: the factory has trimmed the clock (a middle value: it differs from chip to chip)."""
        self._per_hz = (1 << 24) / options.clock_hz
        self._words: dict[int, int] = {}
        self._readers = {row.address: self._reader(row) for row in self.table if row.access.readable}
        self.reset()

    # --- power and time --------------------------------------------------------------------------

    def reset(self) -> None:
        """Registers as after power-on; the plant stays, and time goes on."""
        self._words = {}
        self.ifcnt = 0
        self._gstat_more = _REGISTER_RESET & self.table.get("GSTAT").mask
        self.drive.power_cycle()
        self._following, self.steps_made = _RAMP, 0
        resets = {row.name: row.reset or 0 for row in self.table}
        if "OTP_READ" in resets:
            resets |= otp.resets(self._memory, resets)
        for row in self.table:
            if row.access.writable and row.access is not Access.R_W1C:
                self._take(row, _CLOCK_TRIM if row.name == "FACTORY_CONF" else resets[row.name], fresh=True)
        self._turn()

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        if clock > self._clock:
            self._clock = clock
            self.drive.advance(clock)

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written."""
        return self.drive.quiet

    @property
    def clock(self) -> int:
        """Clocks that it has been brought to."""
        return self._clock

    @property
    def stepped(self) -> bool:
        """Whether steps come one by one, from a controller that is wired to it."""
        return self._stepped

    @stepped.setter
    def stepped(self, value: bool) -> None:
        self._stepped = value
        self._turn()

    def advance_by_steps(self, clocks: Cells, counts: Cells) -> None:
        """Catch up to the last of `clocks`; `counts` steps (signed) come by each; lost while it follows others."""
        if self._following != _STEPS:
            self.advance(int(clocks[-1]))
            return
        self._clock = int(clocks[-1])
        self.steps_made += int(counts.sum())
        advance_by_steps(*self.drive.cells, clocks, counts)

    # --- the buses -------------------------------------------------------------------------------

    @property
    def has_uart(self) -> bool:
        return self.kind.uart

    @property
    def node(self) -> int | None:
        """Its address: the levels of two pins, and what NODECONF adds to them, where it can."""
        part = self.table.get("NODECONF").field_named("NODEADDR") if self.kind.uart else None
        return self.pins + (0 if part is None else part.unpack(self.held(NODECONF))) & 0xFF

    @property
    def send_delay(self) -> int:
        return self.held(NODECONF) >> _SENDDELAY & 15

    @property
    def spi_status(self) -> int:
        """The first byte of every SPI reply; of a driver without SPI nobody sees it."""
        standing, stalled = self.drive.standing_or_stalled
        return self._gstat() & 3 | stalled << 2 | standing << 3

    def read(self, address: int) -> int:
        """The word at `address`; 0 where nothing can be read."""
        reader = self._readers.get(address)
        return reader() if reader else 0

    def write(self, address: int, word: int) -> None:
        """Write `word`; bits that the register does not have are dropped, as are writes to what cannot be written."""
        row = self.table.at(address, write=True)
        if row is None or not row.access.writable:
            return
        word &= row.write_mask
        if row.access is Access.R_W1C:
            self._gstat_more &= ~word if row.name == "GSTAT" else -1
            self.drive.write(row.name, word)
        else:
            self._take(row, word)

    def keep(self, address: int, word: int) -> None:
        """Have a register show a word that the drive has taken already."""
        self._words[address] = word

    def held(self, address: int) -> int:
        """What was written there last."""
        return self._words.get(address, 0)

    # --- registers -------------------------------------------------------------------------------

    def _reader(self, row: Register) -> Callable[[], int]:
        """What answers for a register."""
        read, mask = self.drive.read, row.mask
        match row.name:
            case "GSTAT":
                return partial(self._flags, clears=row.read_clears)
            case "IFCNT":
                return lambda: self.ifcnt
            case "IOIN":
                return partial(self._pin_levels, row)
            case "OTP_READ":
                return lambda: self._memory
            case "DRV_STATUS":
                return partial(self._status, row)
            case "SG_RESULT":
                return lambda: read("SG4_RESULT") & mask
            case "ADC_VSUPPLY_AIN":  # nothing is connected to AIN
                return lambda: adc.supply(self.drive.plant.driver_supply_v)
            case "ADC_TEMP":
                return lambda: adc.temperature(self.drive.plant.temperature_c)
            case "PWM_SCALE":
                return partial(self._pwm_scale, mask)
            case name if name in READ_ONLY or name in ("X_ENC", "ENC_STATUS"):
                return lambda: read(name) & mask
        return partial(self.held, row.address)

    def _take(self, row: Register, word: int, *, fresh: bool = False) -> None:
        self._words[row.address] = word
        match row.name:
            case "GCONF":
                self._configure(self._gconf())
                self._write_chopper()
                if self.takes_currents != (self._following == _CURRENTS):
                    self._turn()
            case "CHOPCONF":
                self._write_chopper()
            case "OTP_PROG":
                self._memory = otp.burnt(self._memory, word)
            case "SGTHRS":
                self.drive.write("SG4_THRS", word)
            case "PWMCONF":
                if fresh:  # what StealthChop begins with is this chip's, not a TMC5160's
                    self.drive.write("PWMCONF", word & ~_AUTOSCALE)
                self.drive.write("PWMCONF", word)
            case "VACTUAL":
                self._turn()
            case "IHOLD_IRUN":
                self._write_current_scales()
            case "XDIRECT" | "DIRECT_MODE":
                self._take_currents()
            case "TPOWERDOWN":
                self.drive.write("TPOWERDOWN", max(word - self.kind.power_down_less, 0))
            case "DRV_CONF":
                self.drive.sense_share = self.kind.ranges[bits(word, 0, 2)]
            case name if ALIASES.get(name, name) in WRITABLE and not row.behaviour:
                self.drive.write(name, word)

    def _configure(self, gconf: dict[str, int]) -> None:
        stealth = gconf["en_pwm_mode"] if "en_pwm_mode" in gconf else not gconf["en_spreadcycle"]
        self.drive.write("GCONF", gconf.get("faststandstill", 0) << 1 | stealth << 2 | gconf["shaft"] << 4)

    def _turn(self) -> None:
        """By currents that are told it, by VACTUAL where it is not 0, else by the steps that come in."""
        row = self.table.find("VACTUAL", 0)
        own = 0 if row is None else signed(self.held(row[0].address), 24)
        wanted = _CURRENTS if self.takes_currents else _STEPS if self._stepped and not own else _RAMP
        if wanted != self._following:
            self._following = wanted
            self.drive.follow(wanted)
            self._write_current_scales()
            self._take_currents()
        if wanted == _RAMP:
            self.drive.turn_at(own or round(self._step_hz * self._per_hz))

    @property
    def takes_currents(self) -> bool:
        """Whether a register tells both coil currents, and STEP is not looked at (GCONF.direct_mode)."""
        return bool(self._gconf().get("direct_mode"))

    def step(self, steps: int) -> None:
        """Steps (signed) that have come since the last call. Not looked at while currents are told."""
        self.stepped = True
        if self._following == _STEPS:
            self.drive.take_steps(steps)

    def _take_currents(self) -> None:
        """The word at `DIRECT`: both coil currents."""
        if self._following == _CURRENTS:
            word = self.held(DIRECT)
            self.drive.take_currents(signed(word, 9), signed(word >> 16, 9))

    def _write_current_scales(self) -> None:
        """IHOLD_IRUN; currents that are told are scaled by IHOLD, moving or not (DS-TMC5130, XDIRECT)."""
        word = self.held(self.table.get("IHOLD_IRUN", 0).address)
        if self._following == _CURRENTS:
            word = word & ~_IRUN | bits(word, 0, 5) << 8
        self.drive.write("IHOLD_IRUN", word)

    def _write_chopper(self) -> None:
        """CHOPCONF, whose microsteps the pins may set."""
        chopconf = self.table.get("CHOPCONF", 0)
        word = self.held(chopconf.address)
        if not self._gconf().get("mstep_reg_select", 1):
            word = word & ~(0xF << _MRES) | PIN_MRES[self.pins] << _MRES
        if chopconf.field_named("vsense") is not None:
            share = self.kind.vsense if bits(word, _VSENSE, 1) else 1.0
            if self._gconf().get("I_scale_analog"):
                share *= min(max(self._vref_v, 0.0) / VREF_FULL_V, 1.0)
            self.drive.sense_share = share
        self.drive.write("CHOPCONF", word)

    # --- pins and status -------------------------------------------------------------------------

    @property
    def has_vref(self) -> bool:
        """Whether a voltage at a pin can scale its current."""
        return "I_scale_analog" in self._gconf()

    @property
    def vref_v(self) -> float:
        """Voltage at VREF, which scales the current while GCONF.I_scale_analog says so [V]."""
        return self._vref_v

    @vref_v.setter
    def vref_v(self, volts: float) -> None:
        self._vref_v = volts
        self._write_chopper()

    @property
    def index(self) -> bool | None:
        """Whether INDEX is active; None of a chip without. Once an electrical turn, where the wave of coil A rises
        through 0 (DS-TMC2209 13.4); or what GCONF has it show instead: the steps of VACTUAL, each an edge, and the
        warning of overtemperature."""
        shows = self._gconf()
        if "index_step" not in shows:
            return None
        if shows["index_otpw"]:
            status = self.table.get("DRV_STATUS", 0)
            return bool(status.unpack(self._status(status))["otpw"])
        width = 1 << min(self.drive.read("CHOPCONF") >> _MRES & 15, 8)
        step = self.drive.read("MSCNT") // width
        return bool(step & 1) if shows["index_step"] else step == 0

    @property
    def enn(self) -> bool:
        """Level at ENN: high switches the bridges off."""
        return self._enn

    @enn.setter
    def enn(self, level: bool) -> None:
        self._enn = level
        self.drive.enabled = not level

    @property
    def diag(self) -> bool:
        """Whether DIAG is active: an error of the driver, or a stall where TSTEP is within TCOOLTHRS (DS-TMC2209 5.3).
        Of a chip with two such pins whether one is, each by what GCONF has it show."""
        tcoolthrs = self.held(self.table.get("TCOOLTHRS", 0).address)
        stalled = self.drive.standing_or_stalled[1] and self.drive.read("TSTEP") <= tcoolthrs
        failed, shows = bool(self.drive.gstat & _DRV_ERR), self._gconf()
        if "diag0_error" not in shows:
            return failed or stalled
        status = self.table.get("DRV_STATUS", 0)
        warned = bool(status.unpack(self._status(status))["otpw"])
        causes = (("diag0_error", failed), ("diag0_otpw", warned), ("diag0_stall", stalled), ("diag1_stall", stalled))
        return any(shows[name] and cause for name, cause in causes)

    @property
    def diag_high(self) -> bool:
        """The level of DIAG; of a chip with two such pins that of both together: low as long as they are open drain
        and one is active, unless GCONF has both push-pull (DS-TMC2130 5.1)."""
        drivers = [bool(value) for name, value in self._gconf().items() if name.endswith("pushpull")]
        return self.diag == all(drivers)

    @property
    def step_hz(self) -> float:
        """Steps a second that come in at STEP, negative with DIR high."""
        return self._step_hz

    @step_hz.setter
    def step_hz(self, value: float) -> None:
        self._step_hz = value
        self._turn()

    def _gconf(self) -> dict[str, int]:
        row = self.table.get("GCONF")
        return row.unpack(self.held(row.address))

    def _flags(self, *, clears: bool) -> int:
        """GSTAT, which reading may clear."""
        word = self._gstat()
        if clears:
            self.drive.write("GSTAT", _GSTAT)
        return word

    def _gstat(self) -> int:
        if self.drive.undervoltage:
            self._gstat_more |= _VM_UVLO & self.table.get("GSTAT").mask
        return self.drive.gstat | self._gstat_more

    def _pwm_scale(self, mask: int) -> int:
        """PWM_SCALE, whose sum, alone of its parts, may have more bits."""
        word = self.drive.read("PWM_SCALE")
        return (word & ~_SUM | (word & _SUM) << self.kind.scale_shift) & mask

    def _status(self, row: Register) -> int:
        inside, heat = self.drive.read("DRV_STATUS"), self.drive.plant.temperature_c
        word = 0
        for part in row.fields:
            if part.name in INSIDE:
                word |= INSIDE[part.name].unpack(inside) << part.lsb
            elif part.name.startswith("t1"):
                word |= (heat >= _HEAT[part.lsb - 8]) << part.lsb
        warning = self.table.find("OTW_OV_VTH", 0)
        if warning is not None:
            hot = adc.temperature(heat) >= bits(self.held(warning[0].address), _WARN_AT, 13)
            word = row.field_named("otpw").pack(hot, over=word)  # type: ignore[union-attr]
        return word

    def _pin_levels(self, row: Register) -> int:
        """IOIN: levels of the pins, and the version. PDN_UART idles high, STEP is seen between two steps."""
        levels = {"ENN": self.enn, "MS1": self.pins & 1, "MS2": self.pins >> 1, "DIAG": self.diag, "PDN_UART": True}
        levels |= dict.fromkeys(("DRV_ENN_CFG6", "DRV_ENN"), self.enn)
        levels |= {"EXT_RES_DET": True, "EXT_CLK": self._external_clock, "OUTPUT": bits(self.held(row.address), 12, 1)}
        back = self.drive.read("VACTUAL") < 0 if self._following == _STEPS else self._step_hz < 0
        levels |= dict.fromkeys(("DIR", "REFR_DIR"), back)
        word = 0
        for part in row.fields:
            word |= (self.kind.version if part.name == "VERSION" else levels.get(part.name, False)) << part.lsb
        return word
