"""A TMC26x (TMC260, TMC261, TMC262, TMC2660) with its motor: five registers of 20 bits, and the answers to them.

It follows STEP and DIR, or with DRVCONF.SDOFF the coil currents that DRVCTRL tells it. Sources: DS-TMC2660 6
(registers, 6.10 the answers), DS-TMC262 11.3 (temperatures), PY (places of the fields), KLIPPER-TMC2660 (sensing
voltages).

Not acted on: slopes (SLPH, SLPL), RNDTF, TS2G and DISS2G: a short is always seen, and at once; DEDGE: whoever gives
steps counts them, whatever their edges.
"""

from __future__ import annotations

from collections.abc import Callable

from .drive import Drive, DriveCells, Followed
from .kernel import Cells
from .options import DriveOptions
from .stepped import advance_by_steps
from .units import bits

BITS = 20
WORD = (1 << BITS) - 1
FULL_SCALE_V = (0.310, 0.165)
"""Peak voltage over the sense resistors at current scale 31, by VSENSE (DS-TMC2660 6.8, KLIPPER-TMC2660)."""
WARNING_C = 100.0
"""Of OTPW; off from 150 deg C, and on again below 120 (DS-TMC262 11.3)."""
DRVCTRL, CHOPCONF, SMARTEN, SGCSCONF, DRVCONF = 0, 4, 5, 6, 7
"""What bits 19..17 of a datagram say; with 0 above, DRVCTRL has bit 17 too."""
_RAMP: Followed = "ramp"
_STEPS: Followed = "steps"
_CURRENTS: Followed = "currents"
SG_FLAG, STST_FLAG = 1, 1 << 7
_SDOFF, _VSENSE, _RDSEL = 7, 6, 4
_PHASE_A, _PHASE_B = 1 << 17, 1 << 8
_CHM, _KEPT_OF_CHOPCONF, _TERMINATED_BY_TIME = 1 << 14, 0x1_CFFF & ~0x1800, 1 << 12
_FAST_DECAY_MSB = 1 << 11
_EVERY_SPEED = 0xFFFFF
"""TCOOLTHRS with which CoolStep and StallGuard2 work at every speed, as they do here."""


def register_of(datagram: int) -> int:
    """The register that 20 bits are written to, as bits 19..17 say it."""
    tag = datagram >> 17 & 7
    return tag if tag & 4 else DRVCTRL


def currents_of(drvctrl: int) -> tuple[int, int]:
    """DRVCTRL with SDOFF: signed currents of coils A and B, 248 at the peak of the wave (DS-TMC2660 6.4)."""
    a, b = bits(drvctrl, 9, 8), bits(drvctrl, 0, 8)
    return (-a if drvctrl & _PHASE_A else a), (-b if drvctrl & _PHASE_B else b)


class Tmc26x:
    """One driver with its motor, at clocks of its own. Not thread-safe.

    `drive` has the plant: load, temperature, shorts and plug of the motor are set there.
    """

    def __init__(self, options: DriveOptions, cells: DriveCells | None = None) -> None:
        """Just switched on: all registers 0, so the bridges are off. `options.full_scale_a` is with VSENSE 0.

        cells : as of `Drive`
        """
        self.drive = Drive(options, cells)
        self.drive.warning_c = WARNING_C
        self.words: dict[int, int] = {}
        """What was written, by register: 17 bits, of DRVCTRL 18."""
        self._counted, self._step_hz = False, 0.0
        self.steps_made = 0
        """Steps that came one by one and were made, signed, since power-on."""
        self._following: Followed = _RAMP
        self._clock = 0
        self._takers: dict[int, Callable[[int], None]] = {
            DRVCTRL: self._take_control,
            CHOPCONF: self._set_chopper,
            SMARTEN: self._set_cool_step,
            SGCSCONF: self._take_current,
            DRVCONF: self._take_configuration,
        }
        self.reset()

    # --- power and time --------------------------------------------------------------------------

    def reset(self) -> None:
        """Registers as after power-on; the plant stays, and time goes on."""
        self.words = dict.fromkeys(self._takers, 0)
        drive = self.drive
        drive.power_cycle()
        drive.write("GCONF", 0)
        drive.write("TCOOLTHRS", _EVERY_SPEED)
        drive.write("TPOWERDOWN", 0)
        self._following = _RAMP
        self.steps_made = 0
        self._follow()
        self._turn()
        for take in self._takers.values():
            take(0)

    def advance(self, clock: int) -> None:
        """Catch up to `clock` clocks; never back."""
        if clock > self._clock:
            self._clock = clock
            self.drive.advance(clock)

    @property
    def quiet(self) -> bool:
        """Nothing happens until something is written, or comes."""
        return self.drive.quiet

    # --- datagrams -------------------------------------------------------------------------------

    def exchange(self, datagram: int) -> int:
        """The answer, as it stands now, to 20 bits, which take effect after it."""
        answer = self.answer
        self.write(datagram)
        return answer

    def write(self, datagram: int) -> None:
        """Take 20 bits."""
        register = register_of(datagram)
        word = datagram & ((1 << 18) - 1 if register == DRVCTRL else (1 << 17) - 1)
        self.words[register] = word
        self._takers[register](word)

    @property
    def answer(self) -> int:
        """The 20 bits that the next datagram shifts out (DS-TMC2660 6.10)."""
        drive = self.drive
        status = drive.read("DRV_STATUS")
        load, scale = status & 0x3FF, bits(status, 16, 5)
        match bits(self.words[DRVCONF], _RDSEL, 2):
            case 0:
                shown = drive.read("MSCNT")
            case 1:
                shown = load
            case _:  # 3 is reserved
                shown = load & 0x3E0 | scale
        return shown << 10 | self.flags

    @property
    def flags(self) -> int:
        """SG, OT, OTPW, S2GA, S2GB, OLA, OLB, STST, the lowest first: of the drive they stand in the same order."""
        flags = self.drive.read("DRV_STATUS") >> 24 & 0xFF
        return flags | STST_FLAG if self.takes_currents else flags  # STST is of the input STEP alone

    # --- pins ------------------------------------------------------------------------------------

    @property
    def enn(self) -> bool:
        """Level at ENN: high switches the bridges off."""
        return not self.drive.enabled

    @enn.setter
    def enn(self, level: bool) -> None:
        self.drive.enabled = not level

    @property
    def diag(self) -> bool:
        """Whether SG_TST is active: a stall."""
        return bool(self.flags & SG_FLAG)

    @property
    def diag_high(self) -> bool:
        """The level of SG_TST, which is high while it is active."""
        return self.diag

    # --- steps -----------------------------------------------------------------------------------

    @property
    def takes_currents(self) -> bool:
        """Whether DRVCTRL tells coil currents, and STEP is not looked at (SDOFF)."""
        return bool(bits(self.words[DRVCONF], _SDOFF, 1))

    def step(self, steps: int) -> None:
        """Steps (signed) that have come since the last call. Not looked at with SDOFF."""
        self._counted, self._step_hz = True, 0.0
        self._follow()
        if not self.takes_currents:
            self.drive.take_steps(steps)

    @property
    def clock(self) -> int:
        """Clocks that it has been brought to."""
        return self._clock

    @property
    def stepped(self) -> bool:
        """Whether steps come one by one, in place of a frequency."""
        return self._counted

    @stepped.setter
    def stepped(self, value: bool) -> None:
        self._counted = value
        self._follow()

    def advance_by_steps(self, clocks: Cells, counts: Cells) -> None:
        """Catch up to the last of `clocks`; `counts` steps (signed) come by each. Not looked at with SDOFF."""
        if self._following != _STEPS:
            self.advance(int(clocks[-1]))
            return
        self._clock = int(clocks[-1])
        self.steps_made += int(counts.sum())
        advance_by_steps(*self.drive.cells, clocks, counts)

    @property
    def step_hz(self) -> float:
        """Steps that come in at a steady frequency, in place of counted ones [Hz, signed]. Not looked at with SDOFF."""
        return self._step_hz

    @step_hz.setter
    def step_hz(self, value: float) -> None:
        self._counted, self._step_hz = False, value
        self._follow()
        if not self.takes_currents:
            self._turn()

    def _turn(self) -> None:
        self.drive.turn_at(round(self._step_hz * (1 << 24) / self.drive.options.clock_hz))

    def _follow(self) -> None:
        """Have the drive follow what there is to follow, where that has changed."""
        wanted = _CURRENTS if self.takes_currents else _STEPS if self._counted else _RAMP
        if wanted != self._following:
            self._following = wanted
            self.drive.follow(wanted)
            if wanted == _RAMP:
                self._turn()

    # --- registers -------------------------------------------------------------------------------

    def _take_control(self, word: int) -> None:
        if self.takes_currents:
            self.drive.take_currents(*currents_of(word))
        else:
            self._set_chopper()

    def _take_current(self, word: int) -> None:
        scale = bits(word, 0, 5)
        self._set("IHOLD_IRUN", scale << 8 | scale)
        self._set_cool_step()

    def _take_configuration(self, word: int) -> None:
        self.drive.sense_share = FULL_SCALE_V[bits(word, _VSENSE, 1)] / FULL_SCALE_V[0]
        self._follow()
        self._set_chopper()
        self._take_control(self.words[DRVCTRL])

    def _set(self, register: str, word: int) -> None:
        """Write a register of the drive where it changes: writing alone starts filters anew."""
        if self.drive.read(register) != word:
            self.drive.write(register, word)

    def _set_chopper(self, _: int = 0) -> None:
        """CHOPCONF and the microsteps of DRVCTRL, as the drive has them in one register."""
        word = self.words[CHOPCONF]
        chopper = word & _KEPT_OF_CHOPCONF
        if word & _CHM:
            chopper |= word & (_FAST_DECAY_MSB | _TERMINATED_BY_TIME)
        if not self.takes_currents:
            control = self.words[DRVCTRL]
            chopper |= bits(control, 0, 4) << 24 | bits(control, 9, 1) << 28
        self._set("CHOPCONF", chopper)

    def _set_cool_step(self, _: int = 0) -> None:
        """SMARTEN and StallGuard2's part of SGCSCONF, as the drive has them in one register."""
        stall_guard = self.words[SGCSCONF]
        self._set(
            "COOLCONF",
            self.words[SMARTEN] & 0xEF6F | bits(stall_guard, 8, 7) << 16 | bits(stall_guard, 16, 1) << 24,
        )
