"""Looking for chips on a UART: reads versions and writes nothing, finds them at any rate, leaves devices alone."""

from __future__ import annotations

import asyncio
import os
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from app.clock import WallClock
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel
from app.errors import LinkDown, UsageError, WrongState
from app.links import discovery
from app.links.datagram_uart import IFCNT, UartForm
from app.links.discovery import FoundModule, ProbeProgress, probe_chips
from app.links.uart_line import uart_port
from tests.links.pty_chip import pty_chip
from tests.links.pty_module import silent
from tests.peers.served_line import served

NODECONF = 0x03


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(discovery, "WAIT_S", 0.3)  # for chips that are threads on a busy machine


@pytest.mark.parametrize("echo", [False, True], ids=["two wires", "one wire"])
async def test_chips_are_found_by_their_version_and_nothing_is_written(echo: bool, tmp_path: Path) -> None:
    clock, models = WallClock(), (("tmc5160", 0), ("tmc5072", 2))
    chips: list[EmulatedTmc5xxx] = []
    for model, node in models:
        chips.append(EmulatedTmc5xxx(model, clock))  # type: ignore[arg-type]  # a Literal, said above
        chips[-1].write(NODECONF, node)
    await asyncio.to_thread(os.getpid)  # a thread for short work stays
    where, before = str(tmp_path / "uart"), (len(os.listdir("/proc/self/fd")), threading.active_count())
    with served(uart_line(chips, clock, nodes=(0, 2), echo=echo), tmp_path / "uart"):
        progress: list[ProbeProgress] = []
        found = await probe_chips(where, [115_200, 9600], [0, 1, 2], progress.append)
        assert [replace(one, candidates=()) for one in found] == [
            FoundModule(where, 115_200, 0, 0x30, "version 0x30", "", "TMC5160", 0, uart=True),
            FoundModule(where, 115_200, 2, 0x10, "version 0x10", "", "TMC5072", 2, uart=True),
        ]
        assert progress[1].asking == "node 1 at 115200 baud"
        assert (progress[-1].done, progress[-1].total, progress[-1].asking) == (8, 8, "")
        assert [chip.read(IFCNT) for chip in chips] == [0, 0]
    assert (len(os.listdir("/proc/self/fd")), threading.active_count()) == before


async def test_one_without_a_node_is_found_too(tmp_path: Path) -> None:
    model: Tmc5xxxModel = "tmc5062"
    with served(uart_line([EmulatedTmc5xxx(model, WallClock())], WallClock()), tmp_path / "uart"):
        (found,) = await probe_chips(str(tmp_path / "uart"), [57_600], [0])
        assert (found.chip, found.node, found.baud, found.uart) == ("TMC5062", None, 57_600, True)


async def test_a_line_that_a_device_has_open_is_asked_as_it_is() -> None:
    with pty_chip((1, 3)) as chip:
        device = uart_port(chip.path, UartForm(1), baud=9600, echo="auto")
        await device.exchange(UartForm(1).read(0))
        found = await probe_chips(chip.path, None, [1, 2, 3])
        assert [(one.node, one.baud, one.chip) for one in found] == [(1, 9600, ""), (3, 9600, "")]
        with pytest.raises(WrongState, match="9600 baud"):
            await probe_chips(chip.path, [115_200])
        assert await device.exchange(UartForm(1).read(0))
        await device.aclose()


async def test_nobody_and_nothing_there() -> None:
    with pty_chip(behave=silent) as chip:
        assert await probe_chips(chip.path, [115_200], [0]) == []
    threads = threading.active_count()
    with pytest.raises(LinkDown, match="not there"):
        await probe_chips(chip.path, [115_200], [0])
    assert threading.active_count() == threads, "the line is given back"
    with pytest.raises(UsageError):
        await probe_chips("http://x")
