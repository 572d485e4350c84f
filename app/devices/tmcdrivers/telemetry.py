"""Telemetry channels of a driver: which registers they need, what the words mean. There is no position among them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..core.register_link import RegisterLink
from ..core.register_samples import Asked, field, number, words_plan
from ..core.row_telemetry import RowTelemetry
from ..core.sample_plan import Decoder, FloatArray, IntArray, SamplePlan
from .memory import DriverMemory
from .roles import FINEST, STANDS, part

SUPPLY_V, ZERO_C, PER_C = 9.732e-3, 2038, 7.7
"""The ADC's steps (KLIPPER)."""
QUANTITIES = {
    "velocity": "pps",
    "target_velocity": "pps",
    "load_value": "",
    "actual_current_scale": "1/32",
    "mscnt": "1/1024 turn",
    "current_a": "1/256",
    "current_b": "1/256",
    "tstep": "tCLK",
    "driver_flags": "bits",
}
"""Every channel quantity and its unit."""
OF_SOME = {
    "stallguard4": ("SG4_RESULT", ""),
    "chip_temperature": ("ADC_TEMP", "degC"),
    "supply": ("ADC_VSUPPLY_AIN", "V"),
}
"""What only chips have that measure it: the register, and the unit."""
DRIVER_FLAGS = ("stall", "ot", "otpw", "s2ga", "s2gb", "ola", "olb", "stst")
"""Bits of the channel, as a TMCL module tells them; a driver that shows a stall at a pin alone has none of that."""


class DriverTelemetry(RowTelemetry):
    """The channels of the axis."""

    def __init__(self, link: RegisterLink, memory: DriverMemory) -> None:
        found = {name: unit for name, (row, unit) in OF_SOME.items() if memory.rows.find(row) is not None}
        super().__init__(link.session, [QUANTITIES | found])
        self._access = link.access
        self._memory = memory

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        asked = Asked()
        decoders = tuple(self._decoder(channel.quantity, asked) for channel in chosen)
        return words_plan(self._access, asked, chosen, decoders)

    def _decoder(self, quantity: str, asked: Asked) -> Decoder:
        rows = self._memory.rows
        if quantity == "velocity":
            return self._velocity(asked)
        if quantity == "target_velocity":
            asked.column(rows.tstep)  # a sample asks something
            return lambda times_s, _, __: np.full(times_s.shape, self._target_pps())
        if quantity == "load_value":
            register, load = rows.load
            column = asked.column(register)
            return number(column, register) if load is None else field(column, load)
        if quantity == "actual_current_scale":
            return field(asked.column(rows.drv_status), part(rows.drv_status, "CS_ACTUAL"))
        if quantity == "mscnt":
            return number(asked.column(rows.mscnt), rows.mscnt)
        if quantity in ("current_a", "current_b"):
            return field(asked.column(rows.mscuract), part(rows.mscuract, quantity.replace("current", "CUR")))
        if quantity == "tstep":
            return number(asked.column(rows.tstep), rows.tstep)
        if quantity in OF_SOME:
            return self._measured(quantity, asked)
        return self._flags(asked)

    def _measured(self, quantity: str, asked: Asked) -> Decoder:
        row = self._memory.rows.get(OF_SOME[quantity][0])
        column = asked.column(row)
        if quantity == "stallguard4":
            return number(column, row)
        raw = number(column, row) if quantity == "chip_temperature" else field(column, part(row, "ADC_VSUPPLY"))
        if quantity == "supply":
            return lambda *sample: raw(*sample) * SUPPLY_V
        return lambda *sample: (raw(*sample) - ZERO_C) / PER_C

    def _target_pps(self) -> float:
        """NaN where the motor is stepped from outside, or nobody knows."""
        velocity = self._memory.velocity
        return velocity * self._memory.velocity_unit_pps if velocity else float("nan")

    def _velocity(self, asked: Asked) -> Decoder:
        """By TSTEP; its direction is that of VACTUAL, else of DIR."""
        rows = self._memory.rows
        tstep, inputs = asked.column(rows.tstep), asked.column(rows.inputs)

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            del times_s, status
            clocks = (words[:, tstep] & rows.tstep.mask).astype(np.float64)
            scale = self._session.clock_hz * self._memory.microsteps / FINEST
            speed = np.where((clocks < STANDS) & (clocks > 0), scale / np.maximum(clocks, 1.0), 0.0)
            velocity = self._memory.velocity
            if velocity:
                return speed if velocity > 0 else -speed
            return np.where(words[:, inputs] & rows.direction_pin.mask, -speed, speed)

        return decode

    def _flags(self, asked: Asked) -> Decoder:
        row = self._memory.rows.drv_status
        column = asked.column(row)
        fields = [self._memory.rows.stalled, *(row.field_named(name) for name in DRIVER_FLAGS[1:])]
        found = [(bit, part.lsb) for bit, part in enumerate(fields) if part is not None]

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            del times_s, status
            bits = np.zeros(len(words), dtype=np.int64)
            for bit, lsb in found:
                bits |= (words[:, column] >> lsb & 1) << bit
            return bits.astype(np.float64)

        return decode
