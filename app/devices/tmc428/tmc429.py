"""What is the TMC429's own: a type register, step/direction outputs, and right switches at pins of their own."""

from __future__ import annotations

from ...errors import OtherModel
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from .identity import RampIdentity
from .memory import RampMemory
from .tmc428 import Tmc428Switching

INTERFACE = "if_configuration_429"
COMPARE = "pos_comp_429"
COMPARE_INTERRUPT = "pos_comp_int_429"


class Tmc429Identity(RampIdentity):
    """Reads the type register."""

    async def probe(self) -> str:
        kind = await self.link.read_once(self.link.table.get("type_version_429"))
        if kind != TYPE_VERSION:
            # The address is unused in a TMC428, where it reads 0 (DS-TMC429 20.3.2).
            found = ("tmc428",) if kind == 0 else ()
            raise OtherModel(
                f"no TMC429 answers here: the type register reads {kind:#08x} instead of {TYPE_VERSION:#08x}",
                self.link.session.model,
                found,
                foreign=not found,
            )
        return f"a TMC429 answers, type {kind:#08x} (a TMC4210 says the same)"


class Tmc429Switching(Tmc428Switching):
    """As a TMC428's, or each right switch at a pin of its own (en_refr)."""

    def __init__(self, link: RegisterLink, memory: RampMemory) -> None:
        super().__init__(link, memory)
        self._interface = link.table.get(INTERFACE)

    @property
    def _own_pins(self) -> bool:
        return bool(self._interface.unpack(self._memory.word(self._interface))["en_refr"])

    def _wired(self, axis: int) -> tuple[bool, bool]:
        return (True, True) if self._own_pins else super()._wired(axis)

    async def read(self, io: RegisterIO, axis: int) -> tuple[bool | None, bool | None]:
        self._memory.saw(self._interface, await io.read(self._interface))
        return await super().read(io, axis)

    def problem(self) -> tuple[str, str] | None:
        if self._own_pins:
            return None
        if not self._memory.drives_chain and self._refmux.unpack(self._memory.word(self._global)):
            return "multiplexed switches are not sampled with en_sd (DS-TMC429 8.2.4)", "set en_refr"
        return super().problem()

    def latency_s(self) -> float:
        return 0.0 if self._own_pins or not self._memory.drives_chain else super().latency_s()
