"""Telemetry channels of a TMC5xxx: which registers they need and what the words mean.

No sample clears a flag: RAMP_STAT is only asked where reading it clears nothing (TMC5160). Elsewhere arrival is
XACTUAL = XTARGET, switches come from the SPI status byte or from IOIN as far as they show them, and otherwise from the
latest look. Over SPI the status byte comes with every row for nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ...registers.model import Register
from ..core.motion_watch import MotionReading
from ..core.planned_motion import POSITION_BITS
from ..core.register_link import RegisterLink
from ..core.register_samples import Asked, field, number, residual, words_plan
from ..core.row_telemetry import RowTelemetry
from ..core.sample_plan import Decoder, FloatArray, IntArray, SamplePlan
from . import roles as r
from .decoded_registers import DecodedRegisters
from .events import Events
from .memory import ChipMemory
from .motions import Motions
from .predictions import Predictions
from .roles import AxisRoles, ChipRoles

MICROSTEPS = "microsteps"
QUANTITIES = {
    "position": MICROSTEPS,
    "target_position": MICROSTEPS,
    "velocity": "pps",
    "target_velocity": "pps",
    "acceleration": "pps^2",
    "encoder_position": MICROSTEPS,
    "deviation": MICROSTEPS,
    "load_value": "",
    "actual_current_scale": "1/32",
    "mscnt": "1/1024 turn",
    "current_a": "1/256",
    "current_b": "1/256",
    "switch_left": "0/1",
    "switch_right": "0/1",
    "position_reached": "0/1",
    "tstep": "tCLK",
    "driver_flags": "bits",
    "predicted_position": MICROSTEPS,
    "predicted_velocity": "pps",
    "residual": MICROSTEPS,
}
"""Every channel quantity and its unit, of an axis with everything."""
FROM_ENCODER = frozenset({"encoder_position", "deviation"})
FROM_PREDICTION = frozenset({"predicted_position", "predicted_velocity", "residual"})
DRIVER_FLAGS_LSB = 24
"""DRV_STATUS from StallGuard to stst: as a TMCL module tells them."""
STATUS_STOP_LEFT = 5
"""Bit of the SPI status byte of a chip with two axes: that of axis 1 is the next one, and the right switches are not
there."""
SINGLE_PINS = {"switch_left": "REFL_STEP", "switch_right": "REFR_DIR"}


def quantities(rows: AxisRoles) -> dict[str, str]:
    """The channel quantities of an axis, and their units."""
    missing = set() if rows.x_enc is not None else set(FROM_ENCODER)
    if rows.tstep is None:
        missing.add("tstep")
    return {name: unit for name, unit in QUANTITIES.items() if name not in missing}


class SixPointTelemetry(RowTelemetry):
    """The channels of every axis, and what rows of them tell besides."""

    def __init__(
        self,
        link: RegisterLink,
        memory: ChipMemory,
        decoded: DecodedRegisters,
        log: Events,
        predictions: Predictions,
        motions: Motions,
    ) -> None:
        super().__init__(link.session, [quantities(rows) for rows in memory.chip.axes])
        self._access = link.access
        self._chip: ChipRoles = memory.chip
        self._memory = memory
        self._decoded = decoded
        self._log = log
        self._predictions = predictions
        self._motions = motions

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        asked = Asked()
        for axis in {channel.axis for channel in chosen if channel.quantity in FROM_PREDICTION}:
            # It tells where something stopped the motor that no command told of.
            asked.column(self._memory.rows(axis).vactual)
        decoders = tuple(self._decoder(channel.quantity, self._memory.rows(channel.axis), asked) for channel in chosen)
        if not asked.registers:
            asked.column(self._chip.gconf)
        return words_plan(self._access, asked, chosen, decoders, partial(self._saw_rows, tuple(asked.registers)))

    # --- channels -------------------------------------------------------------------------------

    def _decoder(self, quantity: str, rows: AxisRoles, asked: Asked) -> Decoder:
        unit_pps = self._decoded.ramp(rows.axis).velocity_unit_pps
        position = rows.xactual
        if quantity in ("position", "target_position"):
            row = position if quantity == "position" else rows.xtarget
            return number(asked.column(row), row)
        if quantity == "velocity":
            return number(asked.column(rows.vactual), rows.vactual, unit_pps)
        if quantity == "target_velocity":
            return self._target_velocity(rows, unit_pps, asked)
        if quantity == "mscnt":
            return number(asked.column(rows.mscnt), rows.mscnt)
        if quantity in ("current_a", "current_b"):
            return field(asked.column(rows.mscuract), r.part(rows.mscuract, quantity.replace("current", "CUR")))
        if quantity in ("load_value", "actual_current_scale"):
            name = "SG_RESULT" if quantity == "load_value" else "CS_ACTUAL"
            return field(asked.column(rows.drv_status), r.part(rows.drv_status, name))
        if quantity == "driver_flags":
            column = asked.column(rows.drv_status)
            return lambda _, words, __: (words[:, column] >> DRIVER_FLAGS_LSB & 0xFF).astype(np.float64)
        if quantity == "tstep":
            assert rows.tstep is not None  # there is no such channel otherwise
            return number(asked.column(rows.tstep), rows.tstep)
        if quantity in FROM_ENCODER:
            return self._encoder_column(quantity, rows, asked)
        if quantity in ("switch_left", "switch_right"):
            return self._switch(quantity, rows, asked)
        if quantity == "position_reached":
            return self._arrival(rows, asked)
        return self._expected(quantity, rows, asked)

    def _target_velocity(self, rows: AxisRoles, unit_pps: float, asked: Asked) -> Decoder:
        """Of velocity mode, by VMAX as it was written; NaN in other modes and where nobody knows VMAX."""
        column = asked.column(rows.rampmode)

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            del times_s, status
            vmax = self._memory.word(rows.vmax)
            mode = words[:, column] & rows.rampmode.mask
            speed = np.nan if vmax is None else vmax * unit_pps
            return np.select([mode == r.FORWARD, mode == r.BACKWARD], [speed, -speed], np.nan)

        return decode

    def _encoder_column(self, quantity: str, rows: AxisRoles, asked: Asked) -> Decoder:
        """NaN while nobody has set how the encoder's counts count."""
        assert rows.x_enc is not None  # there is no such channel otherwise
        encoder = number(asked.column(rows.x_enc), rows.x_enc)
        position = number(asked.column(rows.xactual), rows.xactual) if quantity == "deviation" else None

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if not self._decoded.counts_encoder(rows.axis):
                return np.full(len(times_s), np.nan)
            counts = encoder(times_s, words, status)
            return counts if position is None else counts - position(times_s, words, status)

        return decode

    def _switch(self, quantity: str, rows: AxisRoles, asked: Asked) -> Decoder:
        left = quantity == "switch_left"
        if not self._chip.clears_on_read:
            name = "status_stop_l" if left else "status_stop_r"
            return field(asked.column(rows.ramp_stat), r.part(rows.ramp_stat, name))
        if not self._chip.two_axes:
            return self._by_pin(quantity, rows, asked)
        if left and self._spi:
            bit = STATUS_STOP_LEFT + rows.axis
            return lambda _, __, status: (status >> bit & 1).astype(np.float64)
        return lambda times_s, _, __: np.full(len(times_s), self._switch_seen(rows.axis, left=left))

    def _by_pin(self, quantity: str, rows: AxisRoles, asked: Asked) -> Decoder:
        """Of one axis by the level of the pin. Polarity is the pin's, and the sides change places behind it: a reading,
        as the data sheets give each no more than a sentence."""
        levels = {
            name: field(asked.column(self._chip.inputs), r.part(self._chip.inputs, pin))
            for name, pin in SINGLE_PINS.items()
        }
        polarities = {name: r.part(rows.sw_mode, f"pol_stop_{name[len('switch_')]}") for name in SINGLE_PINS}
        other = "switch_right" if quantity == "switch_left" else "switch_left"
        swapped = r.part(rows.sw_mode, "swap_lr")

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            sw_mode = self._memory.known(rows.sw_mode) or 0
            pin = other if swapped.unpack(sw_mode) else quantity
            level = levels[pin](times_s, words, status)
            return 1.0 - level if polarities[pin].unpack(sw_mode) else level

        return decode

    def _switch_seen(self, axis: int, *, left: bool) -> float:
        """As the latest look saw it; NaN where none did."""
        stat = self._log.polled_stat(axis)
        known = stat is not None and (left or self._decoded.has_right_switch())
        return float((stat or 0) >> (0 if left else 1) & 1) if known else float("nan")

    def _arrival(self, rows: AxisRoles, asked: Asked) -> Decoder:
        position, target = (number(asked.column(row), row) for row in (rows.xactual, rows.xtarget))
        return lambda *block: (position(*block) == target(*block)).astype(np.float64)

    def _expected(self, quantity: str, rows: AxisRoles, asked: Asked) -> Decoder:
        book = self._predictions.book(rows.axis)
        if quantity == "predicted_position":
            return lambda times_s, _, __: book.at(times_s)[0]
        if quantity == "predicted_velocity":
            return lambda times_s, _, __: book.at(times_s)[1]
        if quantity == "acceleration":
            return lambda times_s, _, __: self._accelerations(rows.axis, times_s)
        position = number(asked.column(rows.xactual), rows.xactual)
        return residual(position, book.at, POSITION_BITS)

    def _accelerations(self, axis: int, times_s: FloatArray) -> FloatArray:
        """No register tells the acceleration, so it is what was expected [pps^2]; NaN where nothing was."""
        acceleration = np.full(times_s.shape, np.nan)
        for motion in self._predictions.book(axis).over(times_s):
            expected = motion.acceleration_at(times_s)
            known = ~np.isnan(expected)
            acceleration[known] = expected[known]
        return acceleration

    @property
    def _spi(self) -> bool:
        """Whether replies bring a status byte."""
        return self._access.reply_bytes == 5

    # --- what rows tell besides -----------------------------------------------------------------

    def _saw_rows(self, asked: Sequence[Register], times_s: FloatArray, words: IntArray, status: IntArray) -> None:
        """A block of samples of a plan that asks for these registers is about to be decoded."""
        reset = bool(status[-1] & 1)  # then the counter does not count what it did
        for rows in self._chip.axes:
            self._saw_axis_roles(rows, times_s, words, asked, reset=reset)

    def _saw_axis_roles(
        self, rows: AxisRoles, times_s: FloatArray, words: IntArray, asked: Sequence[Register], *, reset: bool
    ) -> None:
        none = np.zeros(0, dtype=np.int64)

        def values(register: Register) -> FloatArray:
            return number(asked.index(register), register)(times_s, words, none)

        if rows.xactual in asked and not reset:
            encoder = rows.x_enc if self._decoded.counts_encoder(rows.axis) else None
            seen = None if encoder is None or encoder not in asked else int(values(encoder)[-1])
            self._session.saw_position(rows.axis, int(values(rows.xactual)[-1]), float(times_s[-1]), seen)
        if rows.vactual not in asked:
            return
        velocity = values(rows.vactual)
        book = self._predictions.book(rows.axis)
        if book.present() is not None:
            _, expected = book.at(times_s)
            # NaN, where nothing is expected, compares false, and so does a speed that reads 0 itself.
            book.observe(
                times_s, (velocity == 0) & (np.abs(expected) > self._decoded.ramp(rows.axis).velocity_unit_pps)
            )
        if rows.xactual in asked and rows.xtarget in asked:
            position, target = values(rows.xactual), values(rows.xtarget)
            watch = self._motions.of(rows.axis)
            wanted = velocity != 0 if watch.under_way is None else np.ones(len(times_s), dtype=np.bool_)
            for row in np.flatnonzero(wanted):
                reached = bool(position[row] == target[row]) and self._memory.known(rows.rampmode) == r.POSITION
                watch.update(MotionReading(float(times_s[row]), int(position[row]), float(velocity[row]), reached))
