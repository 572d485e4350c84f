"""Drivers behind a controller: datagrams that it carries for them, and the port of a link that goes through it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from ...clock import Clock
from ...errors import BadReply, BenchError, LinkDown, LinkError, OutOfRange, UnknownThing, UsageError
from ...links.port import PortTraits
from ...links.registry import Link
from ...links.spi_access import HIDDEN
from ...registers.catalog import MODELS, find_model
from ...registers.spi_format import TaggedFormat
from .device import Device

COVER = "cover"
"""The kind of such a link."""
AXIS_MAX = 7


@dataclass(frozen=True, slots=True)
class CoverReply:
    """What came back from a driver. `known` has a 1 for each bit of `word` that the controller shows."""

    word: int
    known: int


class CoverCarrier(Protocol):
    """Sends datagrams to the drivers behind a controller."""

    async def cover(self, axis: int, bits: int, words: Sequence[int]) -> list[CoverReply]:
        """Send `words` of so many bits to the driver of `axis`, one after another in one turn; what came back for each.

        Without words nothing is sent, but everything found out that could keep one from getting there.

        A reply is what the driver sent while it got its word. Raises LinkError, and WrongState where the controller is
        not set up for a driver with such datagrams there.
        """
        ...


class CoverPort:
    """`ChainPort` to a driver behind the device that `find` gives for an id, which may not be there yet, or no more."""

    def __init__(self, find: Callable[[str], Device], device_id: str, axis: int, model: str, clock: Clock) -> None:
        self.device_id = device_id
        self.axis = axis
        self.traits = PortTraits(chains=self, way=self)
        self._find = find
        self._clock = clock
        spi = find_model(model).spi
        self._frame_bytes = 5 if spi is None else spi.frame_bytes
        self._bits = spi.word_bits if isinstance(spi, TaggedFormat) else 8 * self._frame_bytes
        self._last_exchange_s = self.device_time_s()

    @property
    def name(self) -> str:
        return f"{COVER} {self.device_id} axis {self.axis}"

    @property
    def last_exchange_s(self) -> float:
        return self._last_exchange_s

    def device_time_s(self) -> float:
        """The controller's, where there is one."""
        try:
            return self._find(self.device_id).device_time_s()
        except BenchError:
            return self._clock.now()

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        return (await self.exchange_chain((frame,), timeout_s))[0]

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """As `ChainPort` says; how long it may take is the controller's business."""
        del timeout_s
        words = [int.from_bytes(frame, "big") & (1 << self._bits) - 1 for frame in frames]
        replies = await self._cover(words)
        self._last_exchange_s = self.device_time_s()
        return [self._frame(reply) for reply in replies]

    async def require_way(self) -> None:
        """As `WayPort` says: the controller is asked whether it is set up for such a driver there."""
        await self._cover(())

    async def _cover(self, words: Sequence[int]) -> list[CoverReply]:
        try:
            return await self._carrier().cover(self.axis, self._bits, words)
        except LinkError:
            raise
        except BenchError as error:
            raise LinkDown(self.name, str(error)) from error

    async def aclose(self) -> None:
        """The link is the controller's."""

    def _carrier(self) -> CoverCarrier:
        try:
            controller = self._find(self.device_id)
        except BenchError as error:
            raise LinkDown(self.name, f"the controller is not there ({error}); add it, or change this link") from error
        if controller.state == "disconnected":
            raise LinkDown(self.name, f"the controller {controller.name} is not connected: connect it first")
        carrier = controller.part(CoverCarrier)
        if carrier is None:
            raise LinkDown(self.name, f"a {controller.family.title} carries no datagrams for drivers")
        return carrier

    def _frame(self, reply: CoverReply) -> bytes:
        """What a wire of its own would have brought: the word first."""
        spare = 8 * self._frame_bytes - self._bits
        hidden = reply.known != (1 << self._bits) - 1
        word = (reply.word & reply.known) << spare
        if hidden and not spare:
            raise BadReply(self.name, "the controller does not show all bits of the answer", word.to_bytes(5, "big"))
        return (word | (HIDDEN if hidden else 0)).to_bytes(self._frame_bytes, "big")


def cover_port(find: Callable[[str], Device], model: str, link: Link, clock: Clock) -> CoverPort:
    """The port of `{"kind": "cover", "device", "axis"?}`. Raises UsageError for options that cannot be."""
    if COVER not in find_model(model).wires:
        having = sorted(known.name for known in MODELS.values() if COVER in known.wires)
        raise UsageError(f"a {model} has no {COVER} link; {', '.join(having)} has")
    unknown = set(link) - {"kind", "device", "axis"}
    if unknown:
        raise UnknownThing(f"option of a {COVER} link", min(unknown), ["device", "axis"])
    device_id, axis = link.get("device"), link.get("axis", 0)
    if not isinstance(device_id, str) or not device_id.strip():
        raise UsageError(f"a {COVER} link needs the device that is the controller")
    if isinstance(axis, bool) or not isinstance(axis, int) or not 0 <= axis <= AXIS_MAX:
        raise OutOfRange("axis", axis, 0, AXIS_MAX)
    return CoverPort(find, device_id.strip(), axis, model, clock)


def driver_place(link: Link) -> tuple[str, int] | None:
    """The controller and the axis that a link goes through; None of other kinds."""
    return (str(link.get("device")), int(str(link.get("axis", 0)))) if link.get("kind") == COVER else None
