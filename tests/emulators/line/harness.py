"""A line on a virtual clock, with clients that keep what they got."""

from __future__ import annotations

from collections.abc import Sequence

from app.clock import VirtualClock
from app.emulators.line.faults import LineFaults
from app.emulators.line.framing import GAP_S
from app.emulators.line.line import Delivery, Line
from tests.emulators.line.modules import SmallModule


class LineBench:
    """One line, modules at `addresses`, clients "a" and "b"; time goes on only by `wait`."""

    def __init__(
        self,
        addresses: Sequence[int] = (1,),
        *,
        baud: int | None = None,
        shared_bus: bool = False,
        faults: LineFaults | None = None,
        seed: int = 1,
        move_s: float = 0.05,
        scale: float = 1.0,
    ) -> None:
        self.clock = VirtualClock(100.0)
        self.modules = [SmallModule(self.clock, address, move_s=move_s, scale=scale) for address in addresses]
        self.line = Line(
            self.modules, self.clock, baud=baud, shared_bus=shared_bus, faults=faults, addresses=addresses, seed=seed
        )
        self.line.join("a")
        self.line.join("b")
        self.start_s = self.clock.now()

    @property
    def module(self) -> SmallModule:
        return self.modules[0]

    @property
    def elapsed_s(self) -> float:
        return self.clock.now() - self.start_s

    def say(self, data: bytes, client: str = "a") -> None:
        self.line.feed(client, data, self.clock.now())

    def wait(self, seconds: float = 0.0) -> list[Delivery]:
        """Let time pass as the server's loop does, from one due time to the next; what arrived meanwhile."""
        until_s = self.clock.now() + seconds
        arrived = self.line.collect(self.clock.now())
        while (due_s := self.line.next_due_s()) is not None and due_s <= until_s:
            self.clock.set(max(due_s, self.clock.now()))
            arrived += self.line.collect(self.clock.now())
        self.clock.set(until_s)
        return arrived + self.line.collect(until_s)

    def ask(self, data: bytes, client: str = "a", seconds: float = 2 * GAP_S) -> bytes:
        """Say `data`; everything that `client` hears in the next `seconds` [s]."""
        self.say(data, client)
        return b"".join(delivery.data for delivery in self.wait(seconds) if delivery.client == client)
