"""A register chip of which much cannot be read, so that its driver keeps in mind what was seen and what was sent.

What a wire can carry, and tasks of the driver's own, belong to every such chip too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from ...clock import Clock
from ...errors import BadReply, WrongState
from ...links import landungsbruecke
from ...links.port import FramePort
from ...links.register_access import access_of
from ...links.wire_budget import WireBudget
from ...registers.model import Register
from .background_tasks import OwnTasks
from .changes import DONE, register_changed
from .config import DeviceConfig
from .register_chip import RegisterChip, reading, written
from .register_io import Held, Words
from .results import RegisterReading, RegisterWritten

NOTHING = (0, 0xFFFF_FFFF)
"""What a bus reads on which nobody drives the line."""


class KeepingChip(RegisterChip):
    """A chip behind whatever link reaches its registers."""

    READ_AT_ONCE = 16

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock, access_of(config.link, config.model))
        self.tasks = OwnTasks()
        self._known: dict[int, int] = {}
        """Words as last seen, by address, of registers that are remembered."""
        self._blind: dict[int, int] = {}
        """Words as last written since the chip's reset, by address, of registers that cannot be read."""

    # --- who it is ------------------------------------------------------------------------------

    async def _on_board(self) -> str:
        """Where the chip is, for people. Raises WrongState where an evaluation board is expected and none answers."""
        if self.link.get("kind") != "landungsbruecke":
            return ""
        board = await landungsbruecke.identify(self.queue)
        if board is None:
            raise WrongState("no evaluation board answers here", "a PD42-1241 has a model of its own")
        return f" on {board}"

    # --- what is kept in mind -------------------------------------------------------------------

    async def _remember(self, words: Words, registers: Sequence[Register]) -> None:
        self._saw(Held(registers, await words.read_many(registers)))

    def _saw(self, held: Held) -> None:
        """The chip was seen to hold these."""
        for register in held.registers:
            self._saw_word(register, held.word(register))

    def remembered_word(self, address: int) -> int | None:
        return self._known.get(address, self._blind.get(address))

    def known(self, register: Register) -> int | None:
        """A remembered word; None where it was not seen yet."""
        return self._known.get(register.address)

    # --- write-only registers -------------------------------------------------------------------

    async def _held(self, words: Words, register: Register) -> int:
        if register.access.readable:
            return await words.read(register)
        held = self._blind.get(register.address, register.reset)
        return 0 if held is None else held

    def kept_word(self, register: Register) -> int | None:
        """What a register that cannot be read holds, as far as is known; None where nobody knows."""
        return self._blind.get(register.address)

    def kept(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        found = []
        for register in self.table:
            if register.access.readable or (groups and register.group not in groups):
                continue
            word = self.kept_word(register) if axis is None or register.axis == axis else None
            if word is not None:
                found.append(replace(reading(register, None, word), kept=True))
        return found

    def _wrote_table(self, written: Iterable[tuple[Register, int]], arrived: bool) -> None:
        """The words of a microstep table went out: those that are others now are told."""
        outcome = DONE if arrived else "not proven: it may have arrived otherwise"
        for register, word in written:
            old = self.kept_word(register)
            self._sent(register, word)
            if word != old:
                self._tell(
                    register_changed(register, old, word, self.port.last_exchange_s, outcome, "the microstep table")
                )

    def _written_blind(self, register: Register, word: int, arrived: bool, notes: Sequence[str]) -> RegisterWritten:
        if not arrived:
            raise BadReply(self.port.name, f"what was sent to {register.name} may have arrived otherwise", b"")
        said = "; ".join(filter(None, [*notes, register.write_note, "the link has shown that it arrived"]))
        return written(reading(register, None, word), word, True, said)

    # --- the link -------------------------------------------------------------------------------

    @property
    def calls_per_s_possible(self) -> float | None:
        wire = self._wire
        return None if wire is None else wire.calls_per_s_possible

    @property
    def calls_per_s(self) -> float:
        wire = self._wire
        return super().calls_per_s if wire is None else wire.calls_per_s

    @property
    def _wire(self) -> WireBudget | None:
        """What the wire can carry, where the port knows of one."""
        wire = getattr(self.port, "wire", None)
        return wire if isinstance(wire, WireBudget) else None

    async def let_go(self) -> None:
        await self.tasks.end()
