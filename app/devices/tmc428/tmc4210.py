"""The TMC4210: one ramp generator with step/direction output."""

from __future__ import annotations

import numpy as np

from ...clock import Clock
from ...errors import WrongState
from ...links.datagram32 import STATUS_TMC4210
from ...links.port import FramePort
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from ..core.config import DeviceConfig
from ..core.register_io import Words, read_once_more
from ..core.sample_plan import Decoder, FloatArray
from .axis_rows import AxisRows
from .samples import Frames, IntArray, RampSamples

LEFT_BIT = STATUS_TMC4210.index("R_L")
RIGHT_INPUT = 0
"""Bit of r_r in REFERENCE_SWITCHES."""
REACHED_BIT = STATUS_TMC4210.index("xEQt1")


class Tmc4210(RampSamples):
    """Driver of one TMC4210."""

    status_names = STATUS_TMC4210

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._global = self.table.get("STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER")
        self._interface = self.table.get("IF_CONFIGURATION_4210")
        self._inputs = self.table.get("REFERENCE_SWITCHES")
        self._type = self.table.get("TYPE_VERSION_4210")
        self._remembered |= {self._global.address}

    def _axis_rows(self, axis: int) -> AxisRows:
        return AxisRows.of(
            self.table,
            axis,
            reference="lp_REF_CONF_RAMP_MODE",
            dividers="PULSE_DIV_RAMP_DIV",
            interrupts="INTERRUPT_MASK_INTERRUPT_FLAGS",
            mode="RAMP_MODE",
        )

    async def probe(self) -> str:
        kind = await read_once_more(self.queue, self._type.address)
        if kind != TYPE_VERSION:
            raise WrongState(
                f"no TMC4210 answers here: the type register reads {kind:#08x} instead of {TYPE_VERSION:#08x}",
                "choose another model, or check the wiring",
            )
        return f"a TMC4210 answers, type {kind:#08x}"

    async def refresh(self) -> None:
        await super().refresh()
        self._saw_word(self._global, await read_once_more(self.queue, self._global.address))

    def _microsteps(self, axis: int) -> int | None:
        return self.axes[axis].settings.driver_microsteps

    async def _motion_warnings(self, words: Words) -> list[str]:
        enabled = self._interface.unpack(await words.read(self._interface))["en_sd"]
        return [] if enabled else ["en_sd is off: no step reaches the driver (DS-TMC4210 1.4)"]

    def _right_wired(self) -> bool:
        """With mot1r the right switch is one, and read from its register; the status bit is then 0 (DS-TMC4210
        5.2.2.2)."""
        word = self._known.get(self._global.address, 0)
        return bool(self._global.unpack(word)["mot1r"])

    async def _switches(self, words: Words, axis: int) -> tuple[bool | None, bool | None]:
        self._saw_word(self._global, await words.read(self._global))
        inputs = self._inputs.unpack(await words.read(self._inputs))
        return bool(inputs["r_l"]), bool(inputs["r_r"]) if self._right_wired() else None

    def _reached(self, status: int, axis: int) -> bool:
        return bool(status >> REACHED_BIT & 1)

    def _reached_column(self, status: IntArray, axis: int) -> FloatArray:
        return (status >> REACHED_BIT & 1).astype(np.float64)

    def _switch_decoder(self, side: str, axis: int, frames: Frames) -> Decoder:
        if side == "left":
            return lambda _, __, status: (status >> LEFT_BIT & 1).astype(np.float64)
        column = frames.column(self._inputs)
        rows = self.rows[axis]

        def right(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if not self._right_wired():
                return np.full(len(times_s), np.nan)
            return (words[:, column] >> RIGHT_INPUT & 1).astype(np.float64)

        def reference(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            word = self._known.get(rows.reference.address, 0)
            if rows.reference_right.unpack(word):
                return right(times_s, words, status)
            return (status >> LEFT_BIT & 1).astype(np.float64)

        return right if side == "right" else reference

    def compare_register(self, axis: int) -> str | None:
        self.axis(axis)
        return "POS_COMP_4210"
