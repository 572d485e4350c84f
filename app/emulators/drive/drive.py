"""The drive: registers in and out, time forward."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from . import kernel as k
from .encoder import EncoderChannel
from .events import Event, EventKind
from .options import DriveOptions
from .physics import plant_state_of, set_graduation, set_physics
from .plant import OT_C, OTPW_C, UNDERVOLTAGE_V, Plant, PlantState, Switches
from .registers import ALIASES, CLEARED_BY_ONES, MAX_VMAX, READ_ONLY, WRITABLE
from .spread_cycle import Chopper, bent
from .table import PEAK, wave_of
from .units import bits, signed, wrap32

_VELOCITIES = {"VSTART": k.VSTART, "V1": k.V1, "V2": k.V2, "VMAX": k.VMAX, "VSTOP": k.VSTOP}
# a deceleration of 0 would never end: it is taken for the least there is
_ACCELERATIONS = {
    "A1": (k.A1, 0),
    "A2": (k.A2, 0),
    "AMAX": (k.AMAX, 0),
    "DMAX": (k.DMAX, 1),
    "D2": (k.D2, 1),
    "D1": (k.D1, 1),
}
_PLAIN = {
    "TPWMTHRS": k.TPWMTHRS,
    "TCOOLTHRS": k.TCOOLTHRS,
    "THIGH": k.THIGH,
    "RAMPMODE": k.MODE,
    "SW_MODE": k.SW,
    "VIRTUAL_STOP_L": k.VLEFT,
    "VIRTUAL_STOP_R": k.VRIGHT,
    "X_COMPARE_REPEAT": k.X_REPEAT,
}
JUMP = 1 << 33
"""An acceleration that gets to every velocity in one tick."""
_TABLE = ("MSLUTSEL", "MSLUTSTART", *(f"MSLUT[{i}]" for i in range(8)))
_FASTSTANDSTILL, _EN_PWM_MODE, _SHAFT = 1 << 1, 1 << 2, 1 << 4
_BLANK_CLOCKS, _PWM_CLOCKS = (16, 24, 36, 54), (1024, 683, 512, 410)
"""By tbl; by pwm_freq, of two periods."""
_S2G = {"a": 1 << 27, "b": 1 << 28}
_GSTAT_RESET, _GSTAT_DRV_ERR, _GSTAT_UV_CP = 1, 2, 4
_STOP_SG = 1 << 6
_OPEN_LOADS = {"none": 0, "a": 1, "b": 2}
"""Of DRV_STATUS: ola and olb."""
_KEPT = (
    k.TICK,
    k.CLOCK,
    k.WATCH,
    k.RNG,
    k.SUBSTEPS,
    k.UNTRUE,
    k.UNEVEN,
    k.APART,
    k.COUPLED,
    k.BLOCKED,
    k.FORCE,
    k.FORCED,
    k.STALL_V,
    k.RIGID,
    k.SG4,
    k.PWM_KIND,
)
"""Cells that a power cycle leaves."""

DriveCells = tuple[k.Cells, k.Floats, k.Floats]
Followed = Literal["ramp", "steps", "currents"]
"""What can move the field."""

DRIVE_JOB = "drive"
"""What compiling it is called: families that have it wait for that, so that it is compiled once."""


class Drive:
    """A TMC5160, the bridges behind it, and all that they move.

    Time is counted in clocks of `options.clock_hz` (16 MHz). Ramp generator, motor, switches and encoders are worked
    out in ticks every `TICK_CLOCKS` = 256 clocks (16 us), counted from power-on: a register shows the last tick, and a
    write holds from the next one. So it makes no difference in how many pieces time is advanced.

    Chips that are not a TMC5160 in everything say so by the properties below `# --- the rest`: velocity thresholds
    instead of TSTEP's, an N line, pins of switches that are taken, another full scale or least supply, StallGuard4.

    Not modelled: pins and buses. SpreadCycle bends the wave only where `options.ripple` asks for it. With StealthChop
    the coils get a voltage, which is what PWMCONF, supply and automatic tuning make it; StallGuard2 tells 0 there.
    StallGuard4 goes by the same figures as StallGuard2 (a reading: nobody tells how the PWM's duty falls with load),
    and CoolStep does not use it.

    Nothing here is thread-safe; the kernel releases the GIL.
    """

    def __init__(self, options: DriveOptions | None = None, cells: DriveCells | None = None) -> None:
        """The rotor stands at `options.start_fullsteps`, the chip has just been switched on.

        cells : state, figures and microstep table to work on, all 0, in place of its own: a part of a larger state
        """
        self.options = options = options or DriveOptions()
        self._s, self._f, self._table = cells or (np.zeros(k.INTEGERS, np.int64), np.zeros(k.REALS), np.zeros(k.TABLE))
        self._registers: dict[str, int] = {}
        self._gstat = 0
        self._wired = True
        self._hot = self._undervoltage = False
        self._short = 0
        """s2ga or s2gb of DRV_STATUS: kept until the driver is switched off."""
        self._enabled, self._sense = True, 1.0
        self._least_supply_v = UNDERVOLTAGE_V
        self._stall_stop_velocity: int | None = None
        self.warning_c = OTPW_C
        """From which on DRV_STATUS.otpw warns [deg C]."""
        self._set_constants()
        self.plant = Plant(options, self._s, self._f, self._plant_changed)
        self.internal = EncoderChannel(self._s, self._f, k.INTERNAL, self._changed)
        self.external = EncoderChannel(self._s, self._f, k.EXTERNAL, self._changed)
        self._f[k.THETA] = self._f[k.LOAD_THETA] = options.start_fullsteps * self.plant.fullstep_rad
        self._s[k.RNG] = (options.seed << 16 | 0x330E) & 0xFFFFFFFFFFFF
        self.plant.push()
        self.power_cycle()

    # --- registers -------------------------------------------------------------------------------

    def write(self, register: str, value: int) -> None:
        """Write a register by its TMC5160 name. Bits beyond its width are dropped, as on the bus.

        Writable: those of `WRITABLE`, and GSTAT, RAMP_STAT and ENC_STATUS, where 1 clears. Signed registers take
        either form of a negative number. The encoder registers are `external`'s; ENC_DEVIATION only warns there.

        Raises KeyError for a name that the chip does not have, PermissionError for one that can only be read.
        """
        register = ALIASES.get(register, register)
        if register in CLEARED_BY_ONES:
            self._clear(register, value & CLEARED_BY_ONES[register])
            return
        row = WRITABLE.get(register)
        if row is None:
            if register in READ_ONLY:
                raise PermissionError(f"{register} can only be read")
            raise KeyError(f"a drive has no register {register!r}")
        value = signed(value, row.bits) if row.signed else value & ((1 << row.bits) - 1)
        self._registers[register] = value
        self._take_over(register, value)
        self._changed()

    def read(self, register: str) -> int:
        """A register by its TMC5160 name: signed where the chip counts signed. Reading has no side effects.

        Besides what can be written (write-only ones read back here) those of `READ_ONLY`. Raises KeyError for a name
        that the chip does not have.
        """
        register = ALIASES.get(register, register)
        s = self._s
        match register:
            case "XACTUAL":
                return int(s[k.X])
            case "VACTUAL":
                v = int(s[k.V])
                return (abs(v) >> k.VELOCITY_BITS) * (1 if v > 0 else -1)
            case "AACTUAL":
                return int(s[k.ACTUAL])
            case "SG4_RESULT":
                return int(s[k.SG]) if s[k.STEALTH] else 0
            case "SG4_IND":
                return int(s[k.SG4_LAST]) if s[k.SG4_FILTER] else int(s[k.SG4_LAST]) & 0xFF
            case "X_ENC":
                return self.external.position
            case "TSTEP":
                return int(s[k.TSTEP])
            case "XLATCH":
                return int(s[k.XLATCH])
            case "ENC_LATCH":
                return int(s[k.ENC_LATCH])
            case "MSCNT":
                return int(s[k.LOOK]) & 1023
            case "MSCURACT":
                at = int(s[k.LOOK])
                return self._wave[at & 1023] & 0x1FF | (self._wave[at + 256 & 1023] & 0x1FF) << 16
            case "RAMP_STAT":
                return self.ramp_stat
            case "DRV_STATUS":
                return self._drv_status()
            case "GSTAT":
                return self.gstat
            case "ENC_STATUS":
                return int(s[k.N_FLAG]) | self.external.exceeded << 1
            case "PWM_SCALE":
                return self._pwm_scale()
            case "PWM_AUTO":
                return int(s[k.OFS_AUTO]) | int(s[k.GRAD_AUTO]) << 16
            case "LOST_STEPS":
                return 0
        try:
            return self._registers[register]
        except KeyError:
            raise KeyError(f"a drive has no register {register!r}") from None

    def _clear(self, register: str, ones: int) -> None:
        if register == "GSTAT":
            self._gstat &= ~ones
            if ones & _GSTAT_UV_CP:
                self._s[k.SAG_SEEN] = self._s[k.SAGGED]
        elif register == "ENC_STATUS":
            if ones & 2:
                self.external.exceeded = False
            if ones & 1 and self._s[k.N_FLAG]:
                self._s[k.N_FLAG] = 0
                k.n_restart(self._s, self._f)
        else:
            self._s[k.LATCHED] &= ~ones
            self._changed()

    def _take_over(self, register: str, value: int) -> None:
        s = self._s
        if register in _VELOCITIES:
            s[_VELOCITIES[register]] = min(value, MAX_VMAX) << k.VELOCITY_BITS
        elif register in _ACCELERATIONS:
            cell, least = _ACCELERATIONS[register]
            s[cell] = max(value, least)
        elif register in _PLAIN:
            s[_PLAIN[register]] = value
            if register == "SW_MODE":
                s[k.VIRTUAL] = value >> 12
                if not value >> 10 & 1:
                    s[k.LATCHED] &= ~_STOP_SG  # without sg_stop nothing holds the motor
        elif register in _TABLE:
            self._load_table()
        else:
            self._take_over_rest(register, value)

    def _take_over_rest(self, register: str, value: int) -> None:
        s = self._s
        match register:
            case "XACTUAL":
                s[k.X] = value
            case "XTARGET":
                s[k.XT] = value
                if s[k.V] == 0:
                    s[k.HEADING] = 0
            case "TZEROWAIT":
                s[k.TZERO] = value * 512 // k.TICK_CLOCKS
            case "TVMAX":
                s[k.TVMAX] = value * 512 // k.TICK_CLOCKS
                s[k.VWAIT] = min(int(s[k.VWAIT]), int(s[k.TVMAX]))
            case "SG4_THRS":
                s[k.SG4_THRS], s[k.SG4_FILTER] = bits(value, 0, 8), bits(value, 8, 1)
            case "GCONF":
                s[k.SHAFT] = -1 if value & _SHAFT else 1
                s[k.EN_PWM] = bool(value & _EN_PWM_MODE)
                s[k.STILL_LIMIT] = (1 << (18 if value & _FASTSTANDSTILL else 20)) // k.TICK_CLOCKS
            case "GLOBALSCALER":
                self._f[k.FULL_SCALE] = self.options.full_scale_a * self._sense * (value or 256) / 256
                self._chop()
            case "IHOLD_IRUN":
                s[k.IHOLD], s[k.IRUN] = bits(value, 0, 5), bits(value, 8, 5)
                s[k.IHOLDDELAY] = bits(value, 16, 4) * k.TICKS_A_DELAY
                s[k.IRUNDELAY] = bits(value, 24, 4) * 512 // k.TICK_CLOCKS
                s[k.COOL_CS] = s[k.IRUN]
                self._chop()
            case "TPOWERDOWN":
                s[k.TPOWER] = value * k.TICKS_A_DELAY
            case "CHOPCONF":
                mres = min(bits(value, 24, 4), 8)
                s[k.MRES], s[k.INTPOL] = mres, bits(value, 28, 1)
                # to the nearest step, half a step off 0 (DS-TMC5130A 17.2); of two as near the upper, as dumps show
                s[k.FIELD] = (int(s[k.FIELD]) >> mres << mres) + (1 << mres >> 1)
                per_second = self.options.clock_hz / 2**24 / 2**k.VELOCITY_BITS
                self._f[k.FS_A_V] = per_second * 2.0 ** int(s[k.MRES]) / 256
                self._set_chopper(value)
                self._chop()
                self._set_pwm_floor()
                self._bridges_changed()
            case "COOLCONF":
                s[k.SEMIN], s[k.SEUP], s[k.SEMAX] = bits(value, 0, 4), bits(value, 5, 2), bits(value, 8, 4)
                s[k.SEDN], s[k.SEIMIN] = bits(value, 13, 2), bits(value, 15, 1)
                s[k.SGT], s[k.SFILT] = signed(value >> 16, 7), bits(value, 24, 1)
                s[k.SG_SUM] = s[k.SG_COUNT] = 0
                s[k.COOL_CS] = s[k.IRUN]
            case "VDCMIN":
                s[k.VDCMIN] = (value if value >= 256 and not self.options.rigid else 0) << k.VELOCITY_BITS
                k.at_high_velocity(s)
            case "DCCTRL":
                s[k.DC_TIME], s[k.DC_SG] = bits(value, 0, 10), 16 * bits(value, 16, 8)
            case "PWMCONF":
                self._set_stealth_chop(value)
            case "X_ENC":
                self.external.position = value
            case "ENC_CONST":
                self._scale_external()
            case "ENCMODE":
                self._scale_external()
                s[k.N_MODE], s[k.N_ONCE] = value, bits(value, 5, 1)
                k.n_restart(s, self._f)
            case "ENC_DEVIATION":
                self.external.limit, self.external.stops = value, False

    def _scale_external(self) -> None:
        constant = self._registers["ENC_CONST"]
        if not self._wired:
            self.external.scale(0, 1)
        elif bits(self._registers["ENCMODE"], 10, 1):
            self.external.scale(signed(constant >> 16, 16) * 10_000 + bits(constant, 0, 16), 10_000)
        else:
            self.external.scale(signed(constant, 32), 1 << 16)

    def _load_table(self) -> None:
        words = tuple(self._registers[f"MSLUT[{i}]"] for i in range(8))
        self._wave, table = wave_of(words, self._registers["MSLUTSEL"], self._registers["MSLUTSTART"])
        self._table[k.WAVE : k.CHOPPED] = table
        self._chop()

    def _chop(self) -> None:
        """The wave as SpreadCycle makes it with the run current; less current is a share of that (INFERRED)."""
        wave = self._table[k.WAVE : k.CHOPPED]
        self._table[k.CHOPPED :] = wave
        if self.options.ripple:
            full_scale_a = float(self._f[k.FULL_SCALE])
            self._table[k.CHOPPED :] = bent(
                self._chopper(full_scale_a), wave, full_scale_a * (self._s[k.IRUN] + 1) / 32
            )

    def _chopper(self, full_scale_a: float) -> Chopper:
        """SpreadCycle as it is set. A unit of hysteresis is 1/248 of the peak at full scale, as `app.calc` has it."""
        conf, motor = self._registers["CHOPCONF"], self.options.motor
        units = bits(conf, 4, 3) + 1 + bits(conf, 7, 4) - 3
        return Chopper(
            motor.resistance_ohm,
            motor.inductance_h,
            float(self._f[k.SOURCE]),
            _BLANK_CLOCKS[bits(conf, 15, 2)] / self.options.clock_hz,
            (24 + 32 * bits(conf, 0, 4)) / self.options.clock_hz,
            units * full_scale_a / PEAK,
        )

    def _drv_status(self) -> int:
        word = int(k.driver_stat(self._s)) | self._short
        if self._hot:
            word |= 1 << 25
        if self.plant.temperature_c >= self.warning_c:
            word |= 1 << 26
        if self._toff > 0:
            word |= (3 if not self.plant.motor_connected else _OPEN_LOADS[self.options.motor.open_phase]) << 29
        return word

    def _pwm_scale(self) -> int:
        """PWM_SCALE_SUM, and PWM_SCALE_AUTO from bit 16. 0 unless StealthChop works."""
        s, f = self._s, self._f
        if not s[k.STEALTH] or not s[k.DRIVER_ON]:
            return 0
        scale = round(float(k.pwm_amplitude(s, f)))
        if not (s[k.PWM_KIND] == k.TUNED and s[k.AUTOSCALE]):
            return scale
        return scale | (round(float(f[k.PWM_AUTO])) & 0x1FF) << 16

    def _set_stealth_chop(self, conf: int) -> None:
        """PWMCONF. Without pwm_autoscale what it has found by itself is what was written (DS-TMC5160 7.4)."""
        s = self._s
        s[k.PWM_OFS], s[k.PWM_GRAD], s[k.AUTOSCALE] = bits(conf, 0, 8), bits(conf, 8, 8), bits(conf, 18, 1)
        s[k.AUTOGRAD], s[k.FREEWHEEL] = bits(conf, 19, 1), bits(conf, 20, 2)
        s[k.PWM_REG], s[k.PWM_LIM] = bits(conf, 24, 4), bits(conf, 28, 4)
        if not s[k.AUTOSCALE]:
            s[k.OFS_AUTO], s[k.GRAD_AUTO], self._f[k.PWM_AUTO] = s[k.PWM_OFS], s[k.PWM_GRAD], 0.0
        self._set_pwm_floor()

    def _set_chopper(self, conf: int) -> None:
        """CHOPCONF: with constant off time a cycle is on for the blank time or more, decays fast for TFD, slowly for
        TOFF (DS-TMC5160 8.2): the mean voltage that lowers a current is what is left of TFD (INFERRED)."""
        s, f = self._s, self._f
        s[k.CHM], s[k.VHIGHFS], s[k.VHIGHCHM] = bits(conf, 14, 1), bits(conf, 18, 1), bits(conf, 19, 1)
        s[k.T_OFF], s[k.T_BLANK] = 24 + 32 * bits(conf, 0, 4), _BLANK_CLOCKS[bits(conf, 15, 2)]
        fast = 32 * (bits(conf, 4, 3) | bits(conf, 11, 1) << 3)
        blank, off = int(s[k.T_BLANK]), int(s[k.T_OFF])
        f[k.FALL_CHM] = max(fast - blank, 0) / (blank + fast + off)
        f[k.SINE_OFFSET] = (bits(conf, 7, 4) - 3) / 512
        k.at_high_velocity(s)

    def _set_pwm_floor(self) -> None:
        """t_blank f_PWM V / R: the mean current of the shortest pulse that can be measured (DS-TMC5160 7.3.1)."""
        shortest = _BLANK_CLOCKS[bits(self._registers["CHOPCONF"], 15, 2)]
        share = shortest * 2 / _PWM_CLOCKS[bits(self._registers["PWMCONF"], 16, 2)]
        self._f[k.PWM_FLOOR] = share * self._f[k.SOURCE] / self.options.motor.resistance_ohm

    # --- time ------------------------------------------------------------------------------------

    @property
    def clocks(self) -> int:
        """Chip time [clocks]. Goes on over `power_cycle`."""
        return int(self._s[k.CLOCK])

    @property
    def watch(self) -> EventKind:
        """Which events end an `advance` early; none at first."""
        return EventKind(int(self._s[k.WATCH]))

    @watch.setter
    def watch(self, kinds: EventKind) -> None:
        self._s[k.WATCH] = int(kinds)

    def advance(self, until_clocks: int) -> Event | None:
        """Go on to `until_clocks`, or to the first tick in which an event of `watch` happens.

        None: `clocks` is `until_clocks`. An event: `clocks` is the tick it happened in; call again to go on.
        Raises ValueError for a time gone by.
        """
        if until_clocks < self.clocks:
            raise ValueError(f"it is clock {self.clocks}, and {until_clocks} is over")
        kinds = int(k.advance(self._s, self._f, self._table, until_clocks))
        return self.event(kinds) if kinds else None

    @property
    def cells(self) -> DriveCells:
        """What `kernel.advance` goes by, for compiled code that calls it itself: state, figures, microstep table."""
        return self._s, self._f, self._table

    def event(self, kinds: int) -> Event:
        """What such code was told by `kernel.advance`, as `advance` would have told it."""
        return Event(EventKind(kinds), self.clocks, int(self._s[k.X]))

    def power_cycle(self) -> None:
        """The chip loses supply and comes back: registers and counters at reset, GSTAT.reset set, field at MSCNT 0.

        Rotor, load, stage and magnet stay where they are, so does `plant`; `watch`, `stall_stop_velocity` and `clocks`
        stay too. The encoders' positions are 0, their scales and limits as at first.
        """
        s, f = self._s, self._f
        values = [int(s[cell]) for cell in _KEPT]
        s[:] = 0
        for cell, value in zip(_KEPT, values, strict=True):
            s[cell] = value
        options, encoders = self.options, self.options.encoders
        for at, per_turn in ((k.INTERNAL, encoders.internal_counts), (k.EXTERNAL, 4 * encoders.external_lines)):
            s[at + k.E_PER_TURN], s[at + k.E_STOPS] = per_turn, 1
            s[at + k.E_NUM] = s[at + k.E_DEN] = 1
        f[k.IA] = f[k.IB] = f[k.TORQUE] = f[k.PWM_AUTO] = f[k.PWM_SUM] = 0.0
        f[k.SUPPLY] = f[k.SOURCE]
        # the field is where the rotor finds it without losing steps
        s[k.FIELD] = s[k.LOOK] = 1024 * round(float(f[k.TEETH] * f[k.THETA]) / (2 * math.pi))
        s[k.COOL_V], s[k.PINS], s[k.N_HAS], self._wired, self._sense = -1, 7, options.n_line, True, 1.0
        self._registers = {name: row.reset for name, row in WRITABLE.items()}
        for name, value in self._registers.items():
            self._take_over(name, value)
        s[k.OFS_AUTO], s[k.GRAD_AUTO] = s[k.PWM_OFS], s[k.PWM_GRAD]
        self.external.stops = True  # the register's reset has made it warn only
        self.internal.scale(51_200, encoders.internal_counts)
        self.internal.position = self.external.position = 0
        k.n_restart(s, f)
        s[k.STILL], s[k.PHASE], s[k.TSTEP] = s[k.STILL_LIMIT], k.HOLD, k.NO_TSTEP
        s[k.REACHED] = s[k.ARRIVED] = s[k.FAST] = 1
        s[k.PHYS] = k.physical(s, f)
        self._gstat = _GSTAT_RESET
        self._plant_changed()

    # --- the rest --------------------------------------------------------------------------------

    @property
    def ramp_stat(self) -> int:
        """RAMP_STAT, for who asks often."""
        return int(k.ramp_stat(self._s))

    @property
    def gstat(self) -> int:
        """GSTAT."""
        return self._gstat | (_GSTAT_UV_CP if self._undervoltage or self._s[k.SAG_SEEN] else 0)

    @property
    def standing_or_stalled(self) -> tuple[bool, bool]:
        """DRV_STATUS.stst and stallGuard."""
        word = int(k.driver_stat(self._s))
        return bool(word >> 31), bool(word >> 24 & 1)

    def turn_at(self, velocity: int) -> None:
        """Turn at `velocity` [ramp units, signed] from the next tick on, without a ramp: VACTUAL of a driver alone.

        Another direction takes one tick more, in which it stands. 0 stops it.
        """
        s = self._s
        s[k.MODE] = k.FORWARD if velocity >= 0 else k.BACKWARD
        s[k.VMAX] = abs(velocity) << k.VELOCITY_BITS
        s[k.AMAX] = JUMP
        s[k.A1] = s[k.V1] = 0
        self._changed()

    def follow(self, what: Followed) -> None:
        """What moves the field from the next tick on: the ramp generator, `take_steps`, or `take_currents`.

        Of the latter two the speed, which StallGuard2 and CoolStep go by, is that of what comes. A power cycle goes
        back to the ramp generator, which stands then.
        """
        s = self._s
        s[k.OUTSIDE] = {"ramp": 0, "steps": k.BY_STEPS, "currents": k.BY_CURRENTS}[what]
        s[k.COMING] = s[k.WINDOW] = s[k.MOVED] = s[k.V] = s[k.ACC] = 0
        s[k.MODE] = k.HOLD_MODE
        k.at_high_velocity(s)
        self.moves_by_leaps = what == "ramp"
        self._changed()

    def take_steps(self, steps: int) -> None:
        """Steps (signed) that have come at STEP since the last call, for the next tick."""
        k.take_steps(self._s, steps)

    def take_currents(self, a: int, b: int) -> None:
        """Currents of both coils from the next tick on [1/248 of the wave's peak, signed]."""
        k.take_currents(self._s, a, b)

    @property
    def stall_stop_velocity(self) -> int | None:
        """VACTUAL from which on SW_MODE.sg_stop acts [ramp units]. None, as in the chip: where TSTEP <= TCOOLTHRS."""
        return self._stall_stop_velocity

    @stall_stop_velocity.setter
    def stall_stop_velocity(self, value: int | None) -> None:
        self._stall_stop_velocity = value
        self._s[k.STALL_V] = -1 if value is None else value << k.VELOCITY_BITS

    @property
    def stall_guard_4(self) -> bool:
        """Whether load is measured with StealthChop too, which then works above TCOOLTHRS as well. False at first."""
        return bool(self._s[k.SG4])

    @stall_guard_4.setter
    def stall_guard_4(self, value: bool) -> None:
        self._s[k.SG4] = value
        self._changed()

    def set_module_currents(self, boost: int, slow: int, free_after_s: float) -> None:
        """What the firmware of a module does with the current besides IHOLD_IRUN; 0 where it does not.

        boost : current scale plus 1 while the speed changes. slow : the same below CoolStep's range.
        free_after_s : time [s] of hold current after which the bridges are open. A power cycle forgets them.
        """
        s = self._s
        s[k.BOOST], s[k.SLOW] = boost, slow
        s[k.FREE_AFTER] = math.ceil(free_after_s * self.options.clock_hz / k.TICK_CLOCKS)
        s[k.DOWN] = 0
        self._changed()

    @property
    def stealth_chop(self) -> int:
        """Kind of StealthChop, as the kernel names them: `TUNED`, of a TMC5160, at first."""
        return int(self._s[k.PWM_KIND])

    @stealth_chop.setter
    def stealth_chop(self, kind: int) -> None:
        self._s[k.PWM_KIND] = kind
        self._changed()

    @property
    def least_supply_v(self) -> float:
        """The supply below which the bridges do not work [V]."""
        return self._least_supply_v

    @least_supply_v.setter
    def least_supply_v(self, value: float) -> None:
        self._least_supply_v = value
        self._plant_changed()

    @property
    def undervoltage(self) -> bool:
        """Whether the supply is below that, by itself or as it sags."""
        return self._undervoltage or bool(self._s[k.SAGGED])

    def set_velocity_window(self, cool: int, high: int) -> None:
        """VCOOLTHRS and VHIGH of the chips that have them instead of TSTEP's thresholds [ramp units].

        CoolStep and a stop by StallGuard2 work from `cool` to `high`, StealthChop below `cool`; only bits 22..8 count.
        """
        self._s[k.COOL_V], self._s[k.HIGH_V] = cool << k.VELOCITY_BITS, high << k.VELOCITY_BITS
        k.at_high_velocity(self._s)
        self._changed()

    @property
    def x_compare(self) -> int:
        """X_COMPARE: what `positions_passed` counts."""
        return int(self._s[k.X_COMPARE])

    @x_compare.setter
    def x_compare(self, value: int) -> None:
        self._s[k.X_COMPARE] = wrap32(value)
        self._changed()

    @property
    def positions_passed(self) -> int:
        """How often XACTUAL has come upon X_COMPARE since power-on, from either side; also between two ticks."""
        return int(self._s[k.PASSED])

    @property
    def enabled(self) -> bool:
        """Whether the pin DRV_ENN lets the bridges work. True at first; a power cycle leaves it."""
        return self._enabled

    @enabled.setter
    def enabled(self, value: bool) -> None:
        self._enabled = value
        self._bridges_changed()
        self._changed()

    @property
    def sense_share(self) -> float:
        """Share of `options.full_scale_a` that the coils get (CHOPCONF.vsense). 1 at first."""
        return self._sense

    @sense_share.setter
    def sense_share(self, value: float) -> None:
        self._sense = value
        self._take_over("GLOBALSCALER", self._registers["GLOBALSCALER"])
        self._changed()

    def wire_pins(self, *, left: bool = True, right: bool = True, encoder: bool = True) -> None:
        """Which of them have pins of their own: others are never seen, an encoder stands still. All at first."""
        self._s[k.PINS] = left | right << 1 | 4
        if encoder != self._wired:
            self._wired = encoder
            self._s[k.N_HAS] = encoder and self.options.n_line
            self._scale_external()
            k.n_restart(self._s, self._f)
        self._changed()

    def latch_now(self) -> None:
        """ENC_LATCH takes X_ENC, and with ENCMODE.latch_x_act XLATCH XACTUAL, as upon an N event."""
        self._s[k.ENC_LATCH] = self.external.position
        if bits(self._registers["ENCMODE"], 9, 1):
            self._s[k.XLATCH] = self._s[k.X]

    @property
    def moves_by_leaps(self) -> bool:
        """Whether a rigid motor at constant velocity passes over ticks. True at first; it makes no other difference."""
        return bool(self._s[k.RIGID] == k.LEAPS)

    @moves_by_leaps.setter
    def moves_by_leaps(self, value: bool) -> None:
        if self.options.rigid:
            self._s[k.RIGID] = k.LEAPS if value else k.NO_LEAPS
            self._changed()

    @property
    def switches(self) -> Switches:
        """The switches as they are on the stage or forced: polarity and swap of SW_MODE do not enter."""
        pressed = int(k.physical(self._s, self._f))
        return Switches(bool(pressed & 1), bool(pressed & 2), bool(pressed & 4))

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written or changes the plant."""
        return bool(self._s[k.QUIET])

    @property
    def plant_state(self) -> PlantState:
        """State of motor and shaft at the last tick."""
        return plant_state_of(self._s, self._f, self.options.motor)

    @property
    def _toff(self) -> int:
        return bits(self._registers["CHOPCONF"], 0, 4)

    def _set_constants(self) -> None:
        options, encoders, f = self.options, self.options.encoders, self._f
        set_physics(options, self._s, f, k.TICK_CLOCKS)
        self._s[k.STALL_V] = -1
        self._s[k.RIGID] = k.LEAPS if options.rigid else 0
        f[k.P1], f[k.P2] = (
            math.radians(encoders.eccentricity_phase_deg),
            math.radians(encoders.second_harmonic_phase_deg),
        )
        f[k.E2] = math.radians(encoders.second_harmonic_deg)
        f[k.ZERO] = encoders.internal_zero_fullsteps * math.pi / 2 / options.motor.rotor_teeth
        f[k.SCALE_I] = encoders.internal_counts / (2 * math.pi)
        f[k.SCALE_E] = 4 * encoders.external_lines / (2 * math.pi) * (-1 if encoders.external_reversed else 1)
        set_graduation(encoders.external_errors, encoders.external_lines, self._s, f)

    def _bridges_changed(self) -> None:
        switched_on = self._toff > 0 and self._enabled
        works = switched_on and not self._undervoltage and not self._hot
        if not switched_on:
            self._short = 0
        elif works and self.plant.short_to_ground != "none" and not self._short:
            self._short = _S2G[self.plant.short_to_ground]
            self._gstat |= _GSTAT_DRV_ERR
        self._s[k.DRIVER_ON] = works and not self._short and self.plant.motor_connected

    def _plant_changed(self) -> None:
        if not self._registers:  # still being made
            return
        self._undervoltage = self.plant.supply_v < self._least_supply_v
        self._f[k.LEAST_SUPPLY] = self._least_supply_v
        was_hot = self._hot
        self._hot = self.plant.temperature_c >= (OTPW_C if was_hot else OT_C)
        if self._hot and not was_hot:
            self._gstat |= _GSTAT_DRV_ERR
        if self._undervoltage:
            self._gstat |= _GSTAT_UV_CP
        self._set_pwm_floor()
        self._chop()
        self._bridges_changed()
        self._changed()

    def _changed(self) -> None:
        k.refresh(self._s, self._f)


def warm_up() -> None:
    """Compile the kernel or load it from numba's cache, so that the first `advance` need not."""
    drive = Drive()
    drive.advance(k.TICK_CLOCKS)
    for register in ("RAMP_STAT", "DRV_STATUS", "X_ENC"):
        drive.read(register)
