"""What is the TMC4210's own: switches on pins of their own, a step/direction output, and a type register."""

from __future__ import annotations

import numpy as np

from ...errors import WrongState
from ...registers.model import RegisterTable
from ...registers.tmc428.status import STATUS_TMC4210
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.register_samples import Asked
from ..core.sample_plan import Decoder, FloatArray, IntArray
from .axis_roles import AxisRoles
from .identity import RampIdentity
from .memory import RampMemory
from .switching import Switching

GLOBAL = "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER"
COMPARE = "POS_COMP_4210"
COMPARE_INTERRUPT = "POS_COMP_INT_4210"
LEFT_BIT = STATUS_TMC4210.index("R_L")
RIGHT_INPUT = 0
"""Bit of r_r in REFERENCE_SWITCHES."""
REACHED_BIT = STATUS_TMC4210.index("xEQt1")


def axis_roles(table: RegisterTable, axis: int) -> AxisRoles:
    """The registers of `axis` by their names in this chip's data sheet."""
    return AxisRoles.of(
        table,
        axis,
        reference="lp_REF_CONF_RAMP_MODE",
        dividers="PULSE_DIV_RAMP_DIV",
        interrupts="INTERRUPT_MASK_INTERRUPT_FLAGS",
        mode="RAMP_MODE",
    )


class Tmc4210Identity(RampIdentity):
    """Reads the type register."""

    async def probe(self) -> str:
        kind = await self.link.read_once(self.link.table.get("TYPE_VERSION_4210"))
        if kind != TYPE_VERSION:
            raise WrongState(
                f"no TMC4210 answers here: the type register reads {kind:#08x} instead of {TYPE_VERSION:#08x}",
                "choose another model, or check the wiring",
            )
        return f"a TMC4210 answers, type {kind:#08x}"


class Tmc4210Switching(Switching):
    """The left switch in the status bits, the right one on an input of its own where mot1r has it."""

    status_names = STATUS_TMC4210

    def __init__(self, link: RegisterLink, memory: RampMemory) -> None:
        self._memory = memory
        self._global = link.table.get(GLOBAL)
        self._interface = link.table.get("IF_CONFIGURATION_4210")
        self._inputs = link.table.get("REFERENCE_SWITCHES")

    async def motion_warnings(self, io: RegisterIO) -> list[str]:
        enabled = self._interface.unpack(await io.read(self._interface))["en_sd"]
        return [] if enabled else ["en_sd is off: no step reaches the driver (DS-TMC4210 1.4)"]

    def _right_wired(self) -> bool:
        """With mot1r the right switch is one, and read from its register; the status bit is then 0 (DS-TMC4210
        5.2.2.2)."""
        return bool(self._global.unpack(self._memory.word(self._global))["mot1r"])

    async def read(self, io: RegisterIO, axis: int) -> tuple[bool | None, bool | None]:
        self._memory.saw(self._global, await io.read(self._global))
        inputs = self._inputs.unpack(await io.read(self._inputs))
        return bool(inputs["r_l"]), bool(inputs["r_r"]) if self._right_wired() else None

    def reached(self, status: int, axis: int) -> bool:
        return bool(status >> REACHED_BIT & 1)

    def reached_column(self, status: IntArray, axis: int) -> FloatArray:
        return (status >> REACHED_BIT & 1).astype(np.float64)

    def decoder(self, side: str, axis: int, asked: Asked) -> Decoder:
        if side == "left":
            return lambda _, __, status: (status >> LEFT_BIT & 1).astype(np.float64)
        column = asked.column(self._inputs)
        rows = self._memory.rows[axis]

        def right(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if not self._right_wired():
                return np.full(len(times_s), np.nan)
            return (words[:, column] >> RIGHT_INPUT & 1).astype(np.float64)

        def reference(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            word = self._memory.word(rows.reference)
            if rows.reference_right.unpack(word):
                return right(times_s, words, status)
            return (status >> LEFT_BIT & 1).astype(np.float64)

        return right if side == "right" else reference
