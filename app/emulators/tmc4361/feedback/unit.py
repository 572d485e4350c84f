"""The feedback unit: registers in and out, the plant behind them. Time goes on in feedback/kernel.py."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from ....registers.tmc4361.table import TMC4361
from ...drive import DriveOptions, Plant
from ...drive import kernel as k
from ...drive.documents import motor_state, truth_state
from ...drive.physics import plant_state_of, set_physics
from ...drive.plant import OT_C, OTPW_C, UNDERVOLTAGE_V, PlantState
from ..spi_output import Sent, sent
from . import layout as c
from .behind import DRIVERS, DriverBehind
from .driver import CURRENTS
from .encoder import position_at, true_place
from .options import FeedbackOptions
from .regulation import error_of
from .serial_output import Answer, SerialOutput
from .state import (
    EncoderOutputState,
    EncoderPatch,
    EncoderState,
    FeedbackMotor,
    FeedbackPatch,
    FeedbackState,
    PwmState,
)
from .words import circular_period, encoder_scale, microsteps_a_turn, signed32, wave

_KINDS = {"abn": c.ABN, "ssi": c.SSI, "spi": c.SPI}
_MASK = 0xFFFFFFFF
_SCALES: Final = (0x00, 0x01, 0x07, 0x0A, 0x36, 0x54, 0x7C)
"""Registers that say what a count is worth."""
_SG, _STST = 1 << 0, 1 << 7
_OT, _OTPW, _OLA, _OLB = 1 << 1, 1 << 2, 1 << 5, 1 << 6
_UV, _OCHS = 1 << 0, 1 << 7
"""Of a TMC23x and TMC24x, whose high side sees a short to ground."""
_SHORT = {"none": 0, "a": 1 << 3, "b": 1 << 4}
"""Driver flags, bit 0 being STATUS 24."""
_SWAPPED = ("kind", "lines", "single_turn_bits", "multi_turn_bits", "gray")
"""What another encoder on the shaft is told by."""
_PLANT = (k.RNG, k.SUBSTEPS, k.UNEVEN, k.APART, k.COUPLED, k.BLOCKED, k.DRIVER_ON)
_KEPT = (c.NOW, c.COMMANDED, c.DRIVER, *_PLANT, c.HOT, c.PHASE)
_DEVICE = (c.KIND, c.PER_TURN, c.SINGLE_BITS, c.MULTI_BITS, c.GRAY, c.STATUS_BITS, c.STATUS_WORD)


def _resets() -> dict[int, int]:
    """Words after power-on, of everything that can be written."""
    found: dict[int, int] = {}
    for row in TMC4361:
        if row.access.writable and not row.when:
            found[row.address] = row.reset or 0
    return found


class FeedbackUnit:
    """Encoder interface, regulation, current scaling and microstep sequencer of the chip, and what hangs on them.

    `fb` is what the two compiled functions of feedback/kernel.py work on, and where there is one a driver behind, whose
    cells lie in it. Not modelled: three-phase motors.
    """

    def __init__(self, options: FeedbackOptions, clock_hz: float) -> None:
        """A chip just switched on; its rotor stands at `options.start_fullsteps`. `clock_hz` is the real clock."""
        self.options = options
        self.fb: c.Floats = np.zeros(c.SIZE, dtype=np.float64)
        self._n: c.Cells = self.fb[c.INTEGERS_AT :].view(np.int64)
        self._hot = False
        self._memory: dict[int, int] = {}
        self.output = SerialOutput(self._word)
        self._heard: Answer | None = None
        self._drive: DriveOptions = options.drive(clock_hz)
        self.driver: DriverBehind | None = None
        """The real driver behind the chip; None where its currents are wired to the motor."""
        if options.driver in DRIVERS:
            cells = (self._n[: k.INTEGERS], self.fb[: k.REALS], self.fb[c.TABLE : c.SIZE])
            self.driver = DRIVERS[options.driver](self._drive, cells)
            self.plant = self.driver.drive.plant
            self._n[c.DRIVER] = self.driver.kind
        else:
            set_physics(self._drive, self._n, self.fb, c.MOTOR_CLOCKS)
            self.plant = Plant(self._drive, self._n, self.fb, self._plant_changed)
            self.fb[k.THETA] = self.fb[k.LOAD_THETA] = options.start_fullsteps * self.plant.fullstep_rad
            self._n[k.RNG] = (options.seed << 16 | 0x330E) & 0xFFFFFFFFFFFF
        self._mount(options.encoder.zero_fullsteps, options.encoder.eccentricity_phase_deg)
        self.plant.push()
        self.reset()

    # --- registers -------------------------------------------------------------------------------

    def write(self, address: int, word: int) -> None:
        """Take a register write, of whatever register: those of other units are only kept."""
        n = self._n
        word &= _MASK
        before = self._word(address)
        n[c.WORD + address] = word
        match address:
            case 0x00:
                self._general(before, word)
            case 0x04:
                self._plant_changed()
            case 0x07:
                if (before ^ word) >> 22 & 3:
                    n[c.PID_FRESH], n[c.CL_ISUM], n[c.CL_DUE] = 1, 0, 0
                    n[c.PID_E] = n[c.PID_VEL] = n[c.PID_ISUM] = n[c.PID_DIFF] = 0
                    self.fb[c.REACH] = 0.0
            case 0x21:
                n[c.DEV] = error_of(self.fb, signed32(word))
            case 0x31:
                self.fb[c.CLK_FREQ] = float(word & 0x1FFFFFF) or 1.0
                self._scale()
            case 0x50:
                self._place(signed32(word))
            case 0x59:
                n[c.CL_OFFSET] = signed32(word)
            case 0x68 | 0x69:
                self._exchange_with_encoder(address == 0x69)
            case 0x70 | 0x71 | 0x72 | 0x73 | 0x74 | 0x75 | 0x76 | 0x77 | 0x78 | 0x7E:
                n[c.WAVE : c.WAVE + 1024] = wave(self._word)
        if address in _SCALES:
            self._scale()
        self._changed()

    def read(self, address: int) -> int | None:
        """A register that this unit answers, as an unsigned word; None for those of other units.

        Reading ENC_LATCH ends ENC_LATCH_F.
        """
        n = self._n
        match address:
            case 0x07:
                value = int(n[c.ENC_IN_CONF])
            case 0x50:
                value = int(self.fb[c.ENC_POS])
            case 0x51:
                value = int(n[c.LATCH])
                n[c.LATCH_FLAG] = 0
                self._changed()
            case 0x52:
                value = -int(n[c.DEV])
            case 0x54:
                value = self._constant
            case 0x59:
                value = int(n[c.CL_OFFSET])
            case 0x5A:
                value = int(n[c.PID_VEL])
            case 0x5B:
                value = int(n[c.PID_ISUM])
            case 0x5D:
                value = int(n[c.PID_E])
            case 0x65:
                value = int(n[c.V_ENC])
            case 0x66:
                value = (int(n[c.MEAN_Q16]) + 32768) >> 16
            case 0x6A:
                value = self._word(0x6A)
            case 0x6B:
                value = self._word(0x6B)
            case 0x79:
                value = int(n[c.PHASE]) & 1023
            case 0x7A:
                value = int(n[c.CURRENT_A]) & 0x1FF | (int(n[c.CURRENT_B]) & 0x1FF) << 16
            case 0x7B:
                value = int(n[c.CURRENT_A_SPI]) & 0x1FF | (int(n[c.CURRENT_B_SPI]) & 0x1FF) << 16
            case 0x7C:
                value = int(n[c.SCALE])
            case _:
                return None
        return value & _MASK

    def reset(self, power: bool = True) -> None:
        """Registers, counters and filters as after power-on, the field at MSCNT 0. Motor, load and encoder stay.

        power : the supply was away, so a driver behind begins anew too
        """
        n, fb = self._n, self.fb
        if self.driver is not None and power:
            self.driver.reset()
        kept = [(cell, int(n[cell])) for cell in (*_KEPT, *_DEVICE)]
        if self.driver is None:
            n[:] = 0
        else:
            n[k.INTEGERS : c.TABLE - c.INTEGERS_AT] = 0
        for cell, value in kept:
            n[cell] = value
        n[c.SCALE], n[c.DIRECTION], n[c.DEN] = 255, 1, 1
        # the field starts over at MSCNT 0, within the electrical turn that the rotor stands in
        n[c.PHASE] = 1024 * round(float(fb[k.TEETH] * fb[k.THETA]) / (2 * math.pi))
        if self.driver is None:
            n[k.LOOK], n[k.IRUN], n[k.SGT] = n[c.PHASE], 31, self.options.stall_threshold
        n[c.MOVED_AT] = n[c.V_AT] = n[c.MEAN_AT] = n[c.ASKED_AT] = n[c.REQUEST_AT] = n[c.NOW]
        fb[c.EDGE_AT] = fb[c.LAST_EDGE] = float(n[c.NOW])
        fb[c.PERIOD] = fb[c.REACH] = fb[c.ENC_POS] = 0.0
        fb[c.DUTY_A] = fb[c.DUTY_B] = 0.5
        self._constant = 0
        self.output.reset()
        self._heard = None
        for address, word in _resets().items():
            n[c.WORD + address] = word
        fb[c.CLK_FREQ] = float(self._word(0x31))
        n[c.WAVE : c.WAVE + 1024] = wave(self._word)
        self._start_counting()
        self._scale()
        self._plant_changed()

    def _word(self, address: int) -> int:
        return int(self._n[c.WORD + address])

    def _general(self, before: int, word: int) -> None:
        n = self._n
        n[c.DIRECTION] = -1 if word >> 28 & 1 else 1
        if (before ^ word) >> 10 & 3:
            self._start_counting()

    def _start_counting(self) -> None:
        """ENC_POS of an incremental encoder is 0 here and now; a serial one is asked at once."""
        n, fb = self._n, self.fb
        place = float(true_place(fb))
        fb[c.PLACE] = place
        n[c.COUNTS] = n[c.BASE_COUNTS] = n[c.V_COUNTS] = math.floor(place + 0.5)
        n[c.BASE] = 0
        fb[c.ENC_POS] = 0.0
        if self._word(0x00) >> 10 & 3 != c.ABN:
            n[c.COUNTS] = n[c.BASE_COUNTS] = 0
            n[c.REQUEST_AT] = n[c.NOW]
        n[c.ANSWERED] = n[c.SINGLE] = n[c.TURNS] = n[c.V_ENC] = n[c.MEAN_Q16] = n[c.FAILED] = 0
        n[c.MOVED_AT], n[c.VEL0] = n[c.NOW], 0

    def _scale(self) -> None:
        """ENC_CONST and all that hangs on the size of a turn; an incremental ENC_POS stays what it is."""
        n, fb = self._n, self.fb
        turn = microsteps_a_turn(self._word(0x0A))
        scale = encoder_scale(self._word(0x54), turn, bool(self._word(0x07) & 1))
        self._constant = scale.word
        numerator = -scale.numerator if self._word(0x07) >> 29 & 1 else scale.numerator
        changed = (numerator, scale.denominator) != (int(n[c.NUM]), int(n[c.DEN]))
        if changed and self._word(0x00) >> 10 & 3 == c.ABN:
            n[c.BASE] += (int(n[c.COUNTS]) - int(n[c.BASE_COUNTS])) * int(n[c.NUM]) // int(n[c.DEN])
            n[c.BASE_COUNTS] = n[c.COUNTS]
        n[c.NUM], n[c.DEN] = numerator, scale.denominator
        fb[c.COUNT_RATE] = numerator / scale.denominator * float(fb[c.CLK_FREQ])
        fb[c.TURN], fb[c.PERIOD] = float(turn), circular_period(self._word)
        if self.driver is None:
            fb[k.FS_A_V] = (1 << min(self._word(0x0A) & 15, 8)) / 65536.0
        fb[c.ENC_POS] = float(position_at(fb, n, int(n[c.COUNTS])))

    def _place(self, position: int) -> None:
        """ENC_POS is written."""
        n, fb = self._n, self.fb
        x_actual = signed32(int(fb[c.ENC_POS]) + int(n[c.DEV]))
        n[c.BASE], n[c.BASE_COUNTS] = position, n[c.COUNTS]
        for _ in range(3):  # the compensation hangs on the uncompensated place, gently
            n[c.BASE] += position - int(position_at(fb, n, int(n[c.COUNTS])))
        fb[c.ENC_POS] = float(position_at(fb, n, int(n[c.COUNTS])))
        n[c.DEV] = error_of(fb, x_actual)

    def _exchange_with_encoder(self, writes: bool) -> None:
        """An SPI encoder's own registers: DATA_TO_ENC stores at ADDR_TO_ENC, ADDR_TO_ENC asks what is there."""
        if self._word(0x00) >> 10 & 3 != c.SPI or int(self._n[c.KIND]) != c.SPI:
            return
        address = self._word(0x68)
        if writes:
            self._memory[address] = self._word(0x69)
        self._n[c.WORD + 0x6A] = address
        self._n[c.WORD + 0x6B] = self._memory.get(address, 0)
        self._n[c.DATA_DONE] = 1

    def _changed(self) -> None:
        """The motor may have something to do again."""
        if self.driver is None:
            self._n[k.REST] = 0
        self._n[c.SETTLED] = 0

    # --- a driver behind ---------------------------------------------------------------------------

    def catch_up(self, clock: int) -> None:
        """Bring a driver that rests, and is passed over while it does, to `clock` before something changes in it."""
        driver = self.driver
        if driver is not None and clock > driver.drive.clocks:
            driver.drive.advance(clock)

    def exchange_with_driver(self, driver: DriverBehind, datagram: int, bits: int) -> int:
        """A datagram of `bits` bits to the driver, now; its answer. Its status is known from then on."""
        self.told_by_chip(driver)
        self._n[c.POLLED] = driver.flags
        answer = driver.exchange(datagram, bits)
        self._plant_changed()
        return answer

    def told_by_chip(self, driver: DriverBehind) -> None:
        """Have the driver's registers show what datagrams of the chip's own have written."""
        n = self._n
        by_currents = driver.takes_currents and self._word(0x04) & 15 == CURRENTS[driver.kind]
        sent = (int(n[c.SENT_A]), int(n[c.SENT_B])) if n[c.STRAY] or by_currents else None
        n[c.STRAY] = 0
        driver.told(int(n[k.IRUN]), sent)

    @property
    def flags_from_outside(self) -> int:
        """Flags of the driver that follow from temperature, supply, shorts and coils, as STATUS 31:24 has them."""
        return int(self._n[c.HOT])

    def sent_by_itself(self, *, moving: bool, falling: bool) -> Sent | None:
        """What the SPI output sends for the currents of now."""
        n = self._n
        a, b = (0, 0) if n[c.FREE] else (int(n[c.CURRENT_A_SPI]), int(n[c.CURRENT_B_SPI]))
        return sent(self._word, a, b, int(n[c.SCALE]), moving=moving, falling=falling)

    # --- plant -------------------------------------------------------------------------------------

    @property
    def plant_state(self) -> PlantState:
        """How motor and shaft really are."""
        return plant_state_of(self._n, self.fb, self._drive.motor)

    @property
    def encoder_counts(self) -> int:
        """Where the encoder on the shaft really is [counts], not wrapped."""
        return math.floor(float(true_place(self.fb)) + 0.5)

    def change(self, patch: FeedbackPatch) -> None:
        """Do something to motor, load or encoder. Raises ValueError for what cannot be computed."""
        plant = self.plant
        if patch.inertia_kgm2 is not None:
            load = self._drive.load.model_copy(update={"inertia_kgm2": patch.inertia_kgm2})
            self._drive = DriveOptions(**{**dict(self._drive), "load": load})
            set_physics(self._drive, self._n, self.fb, c.MOTOR_CLOCKS)
            if self.driver is not None:
                self.driver.drive.sense_share = self.driver.drive.sense_share  # the full scale hangs on it
            plant.refit(self._drive)
        for name, value in (
            ("load_torque_nm", patch.load_torque_nm),
            ("extra_friction_nm", patch.friction_nm),
            ("supply_v", patch.supply_v),
            ("temperature_c", patch.temperature_c),
            ("short_to_ground", patch.short_to_ground),
            ("blocked", patch.blocked),
            ("motor_connected", patch.connected),
            ("rotor_fullsteps", patch.rotor_fullsteps),
        ):
            if value is not None:
                setattr(plant, name, value)
        if patch.encoder is not None:
            self._change_encoder(patch.encoder)
        self._plant_changed()

    def listen(self, clock: int, clocks: int, bit_clocks: float) -> None:
        """Somebody clocks at the serial encoder output, now."""
        self._heard = self.output.listen(int(self.fb[c.ENC_POS]), float(clock), clocks, bit_clocks)

    def _change_encoder(self, patch: EncoderPatch) -> None:
        n, plant = self._n, self.plant
        swapped = {name: getattr(patch, name) for name in _SWAPPED if getattr(patch, name) is not None}
        if patch.status_bit_count is not None:
            swapped["status_bits"] = patch.status_bit_count
        if swapped:  # another encoder is put on the shaft
            encoder = self.options.encoder.model_copy(update=swapped)
            self.options = self.options.model_copy(update={"encoder": encoder})
        if patch.slip_fullsteps is not None:
            plant.encoder_slip_fullsteps = patch.slip_fullsteps
        if patch.eccentricity_deg is not None:
            plant.eccentricity_deg = patch.eccentricity_deg
        self._mount(
            self._zero_fullsteps if patch.zero_fullsteps is None else patch.zero_fullsteps,
            self._phase_deg if patch.eccentricity_phase_deg is None else patch.eccentricity_phase_deg,
        )
        if swapped:
            self._start_counting()
            self._scale()
        if patch.status_bits is not None:
            n[c.STATUS_WORD] = patch.status_bits & ((1 << int(n[c.STATUS_BITS])) - 1)
        if patch.spoil_next is not None:
            n[c.GLITCH] = patch.spoil_next

    def _mount(self, zero_fullsteps: float, phase_deg: float) -> None:
        """Put the encoder on the shaft."""
        encoder, n, fb = self.options.encoder, self._n, self.fb
        self._zero_fullsteps, self._phase_deg = zero_fullsteps, phase_deg
        fb[k.ZERO] = zero_fullsteps * self.plant.fullstep_rad
        fb[k.P1] = math.radians(phase_deg)
        fb[k.SCALE_I] = encoder.counts / (2 * math.pi) * (-1 if encoder.reversed else 1)
        fb[k.LINES] = encoder.counts / 4
        fb[k.EXS] = encoder.line_error * 2 * math.pi / fb[k.LINES]
        n[c.KIND], n[c.PER_TURN] = _KINDS[encoder.kind], encoder.counts
        fb[c.COUNT_TURNS] = 1.0 / encoder.counts
        n[c.SINGLE_BITS], n[c.MULTI_BITS] = encoder.single_turn_bits, encoder.multi_turn_bits
        n[c.GRAY], n[c.STATUS_BITS] = encoder.gray, encoder.status_bits

    def describe(self) -> FeedbackState:
        """Everything, for whoever stands beside the bench."""
        plant, motor, state, fb = self.plant, self._drive.motor, self.plant_state, self.fb
        period = self._word(0x1F) & 0xFFFF
        return FeedbackState(
            motor=FeedbackMotor(
                **motor_state(plant, motor).model_dump(),
                full_scale_a=self.options.full_scale_a,
                inertia_kgm2=self._drive.inertia_kgm2,
            ),
            load_torque_nm=plant.load_torque_nm,
            blocked=plant.blocked,
            friction_nm=plant.extra_friction_nm,
            inertia_kgm2=self._drive.load.inertia_kgm2,
            supply_v=plant.supply_v,
            encoder=EncoderState(
                kind=self.options.encoder.kind,
                counts_per_turn=self.options.encoder.counts,
                counts=self.encoder_counts,
                slip_fullsteps=plant.encoder_slip_fullsteps,
                zero_fullsteps=self._zero_fullsteps,
                eccentricity_deg=plant.eccentricity_deg,
                eccentricity_phase_deg=self._phase_deg,
                status_bits=int(self._n[c.STATUS_WORD]),
                single_turn_bits=self.options.encoder.single_turn_bits,
                multi_turn_bits=self.options.encoder.multi_turn_bits,
                gray=self.options.encoder.gray,
                status_bit_count=self.options.encoder.status_bits,
            ),
            encoder_output=EncoderOutputState(
                enabled=self.output.enabled,
                length=self.output.length,
                heard="" if self._heard is None else "".join(map(str, self._heard.bits)),
                repeated=self._heard is not None and self._heard.repeated,
            ),
            pwm=PwmState(
                frequency_hz=float(fb[c.CLK_FREQ]) / period,
                duty_a=float(fb[c.DUTY_A]),
                duty_b=float(fb[c.DUTY_B]),
            )
            if self._word(0x00) >> 23 & 1 and period
            else None,
            truth=truth_state(state).model_copy(update={"current_scale": int(self._n[c.SCALE])}),
        )

    def _bridges_changed(self) -> None:
        plant = self.plant
        works = plant.supply_v >= UNDERVOLTAGE_V and not self._hot and plant.short_to_ground == "none"
        self._n[k.DRIVER_ON] = works and plant.motor_connected

    def _plant_changed(self) -> None:
        if self.driver is not None:
            self._n[c.HOT] = self.driver.flags & ~(_SG | _STST)
            self._changed()
            return
        plant = self.plant
        self._hot = plant.temperature_c >= (OTPW_C if self._hot else OT_C)
        warm = plant.temperature_c >= OTPW_C
        flags = (0 if plant.motor_connected else _OLA | _OLB) | (_OT if self._hot else 0) | (_OTPW if warm else 0)
        if self._word(0x04) & 15 in (c.TMC23X, c.TMC24X):
            flags |= _UV if plant.supply_v < UNDERVOLTAGE_V else 0
            flags |= _OCHS if plant.short_to_ground != "none" else 0
        else:
            flags |= _SHORT[plant.short_to_ground]
        self._n[c.HOT] = flags
        self._bridges_changed()
        self._changed()
