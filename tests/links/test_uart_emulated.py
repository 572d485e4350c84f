"""Our end of the single wire against emulated chips behind a pty and a TCP port, also with a bad wire between."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from app.clock import WallClock
from app.emulators.line.faults import LinePatch
from app.emulators.line.line import Line
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxPatch
from app.errors import LinkDown, LinkError, LinkTimeout
from app.links.datagram_uart import UartForm, form_of
from app.links.queue import LinkQueue
from app.links.register_access import UartAccess
from app.links.uart_line import UartPort, uart_port
from tests.peers.served_line import served

PATIENCE_S = 20.0
NODECONF, XACTUAL, XTARGET = 0x03, 0x21, 0x2D


class Wire:
    """One chip, and our port to it."""

    def __init__(self, line: Line, chip: EmulatedTmc5xxx, url: str, model: str, timeout_s: float) -> None:
        self.line = line
        self.chip = chip
        self.access = UartAccess(form=form_of(model))
        self.port: UartPort = uart_port(url, self.access.form, timeout_s=timeout_s)
        self.queue = LinkQueue(self.port)

    async def read(self, *registers: int) -> list[int]:
        frames = self.access.read_frames(registers)
        replies = await self.queue.exchange_many(frames)
        self.access.check_all(frames, replies)
        return self.access.words(replies)

    async def write(self, *writes: tuple[int, int]) -> None:
        frames = self.access.write_frames(writes)
        self.access.check_all(frames, await self.queue.exchange_many(frames))

    def fault(self, **faults: object) -> None:
        self.line.patch(LinePatch.model_validate({"faults": faults}))


@asynccontextmanager
async def wire(
    path: Path,
    model: Tmc5xxxModel = "tmc5160",
    *,
    echo: bool = True,
    baud: int | None = None,
    timeout_s: float = PATIENCE_S,
    tcp: bool = False,
) -> AsyncIterator[Wire]:
    clock = WallClock()
    chip = EmulatedTmc5xxx(model, clock)
    line = uart_line([chip], clock, echo=echo, baud=baud)
    with served(line, path / "uart") as (host, number):
        made = Wire(line, chip, f"socket://{host}:{number}" if tcp else str(path / "uart"), model, timeout_s)
        try:
            yield made
        finally:
            await made.port.aclose()


@pytest.mark.parametrize("tcp", [False, True], ids=["pty", "tcp"])
@pytest.mark.parametrize("model", ["tmc5062", "tmc5072", "tmc5130", "tmc5160"])
async def test_every_chip(model: Tmc5xxxModel, tcp: bool, tmp_path: Path) -> None:
    async with wire(tmp_path, model, tcp=tcp) as far:
        await far.write((XTARGET, 0xFFFF_FFFE), (XACTUAL, 0x8000_0000))
        assert await far.read(XACTUAL, XTARGET, XACTUAL) == [0x8000_0000, 0xFFFF_FFFE, 0x8000_0000]
        assert set(far.port.incidents.counts) == {"opened"}


@pytest.mark.parametrize("echo", [False, True], ids=["two wires", "one wire"])
async def test_the_wire_is_never_spoken_into(echo: bool, tmp_path: Path) -> None:
    """The emulated wire takes its time, and spoils what meets on it: all comes through, so nothing met."""
    async with wire(tmp_path, echo=echo, baud=115_200) as far:
        for number in range(10):
            await far.write((XTARGET, number), (XACTUAL, number))
            assert await far.read(*[XTARGET, XACTUAL] * 5) == [number] * 10
        assert set(far.port.incidents.counts) == {"opened"}


@pytest.mark.parametrize(
    "faults",
    [{"bit_error_rate": 0.003}, {"half_frame_rate": 0.2}, {"bit_error_rate": 0.003, "late_reply_s": 0.02}],
    ids=["flipped", "cut", "late"],
)
@pytest.mark.parametrize("echo", [False, True], ids=["two wires", "one wire"])
async def test_bad_answers_are_never_believed(faults: dict[str, float], echo: bool, tmp_path: Path) -> None:
    async with wire(tmp_path, echo=echo, timeout_s=0.03) as far:
        for _ in range(20):
            with contextlib.suppress(LinkError):
                await far.write((XTARGET, 0))
                break
        far.fault(**faults)
        bad, possible = 0, {0}
        for number in range(1, 21):
            try:
                (word,) = await far.read(XTARGET)
                assert word in possible
                possible = {word}
            except LinkError:
                bad += 1
            possible.add(number)  # a write that failed may have arrived all the same, even later than it failed
            with contextlib.suppress(LinkError):
                await far.write((XTARGET, number))
                possible = {number}
        assert bad
        far.fault(bit_error_rate=0.0, half_frame_rate=0.0, late_reply_s=0.0)
        far.port.timeout_s = PATIENCE_S
        for _ in range(10):
            with contextlib.suppress(LinkError):
                await far.read(XTARGET)
        await far.write((XTARGET, 7))
        assert await far.read(XTARGET) == [7]


async def test_a_silent_wire_and_one_that_is_pulled(tmp_path: Path) -> None:
    async with wire(tmp_path, timeout_s=0.1) as far:
        far.port.timeout_s = PATIENCE_S
        assert await far.read(XACTUAL) == [0]
        far.fault(silence=True)
        far.port.timeout_s = 0.1
        with pytest.raises(LinkTimeout):
            await far.read(XACTUAL)
        far.fault(silence=False)
        far.port.timeout_s = PATIENCE_S
        assert await far.read(XACTUAL) == [0]


async def test_a_chip_that_was_switched_off_and_on_is_told_at_the_next_write(tmp_path: Path) -> None:
    async with wire(tmp_path) as far:
        await far.write((XTARGET, 1), (XTARGET, 2))
        far.chip.patch(Tmc5xxxPatch(power_cycle=True))
        with pytest.raises(LinkError, match="it was reset, or another master writes to it"):
            await far.write((XTARGET, 3))
        await far.write((XTARGET, 4))
        assert await far.read(XTARGET) == [4]


async def test_a_pulled_plug_is_noticed_and_the_next_question_opens_it_again(tmp_path: Path) -> None:
    clock = WallClock()
    chip = EmulatedTmc5xxx("tmc5160", clock)
    line = uart_line([chip], clock)
    access = UartAccess(form=UartForm(0))
    with served(line, tmp_path / "uart"):
        port = uart_port(str(tmp_path / "uart"), access.form, timeout_s=PATIENCE_S)
        gone = asyncio.Event()
        port.on_down(lambda _: gone.set())
        await port.exchange(access.read_frames([XACTUAL])[0])
    await asyncio.wait_for(gone.wait(), PATIENCE_S)
    with pytest.raises(LinkDown, match="not there"):
        await port.exchange(access.read_frames([XACTUAL])[0])
    with served(uart_line([chip], clock), tmp_path / "uart"):
        assert access.words([await port.exchange(access.read_frames([XACTUAL])[0])]) == [0]
        await port.aclose()
