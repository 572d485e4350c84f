"""The drawing process itself: where it listens, what it answers, how it ends."""

from __future__ import annotations

import asyncio
import os
import re
import signal
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from app.twin.child import script_hashes
from app.twin.process import DrawingProcess, TwinFailed
from app.twin.shape import AxisPose, Shape

STAGE = Shape("bench", 0, "X", microsteps=16, travel_mm_per_rev=8.0)


@pytest.fixture
async def drawing() -> AsyncIterator[DrawingProcess]:
    process = await DrawingProcess.start()
    yield process
    await process.close()


def listening(pid: int) -> list[tuple[str, int]]:
    """Addresses [hex] and ports at which a process listens for TCP, IPv4 and IPv6."""
    inodes = set()
    for entry in Path(f"/proc/{pid}/fd").iterdir():
        try:
            found = re.fullmatch(r"socket:\[(\d+)\]", os.readlink(entry))
        except FileNotFoundError:
            continue
        if found:
            inodes.add(found[1])
    sockets = []
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and words[9] in inodes:  # 0A: listening
                address, port = words[1].split(":")
                sockets.append((address, int(port, 16)))
    return sockets


async def test_it_listens_on_the_loopback_address_alone(drawing: DrawingProcess) -> None:
    assert listening(drawing.pid) == [("0100007F", drawing.address.port)]


async def test_it_shows_what_it_is_told_and_says_so(drawing: DrawingProcess) -> None:
    for shape in (STAGE, Shape("pair", 1, "turn", microsteps=256)):
        await drawing.show({"shape": shape.message(), "scheme": "dark"})
        for look in (AxisPose(), AxisPose(position=1.0, commanded_deg=5.0, field_deg=3.0, load_deg=100.0)):
            await drawing.show({"look": look.message()})
    assert len(drawing.address.scripts) == 2


async def test_killed_it_is_told_how(drawing: DrawingProcess) -> None:
    os.kill(drawing.pid, signal.SIGKILL)
    with pytest.raises(TwinFailed, match="signal 9"):
        await drawing.show({"look": AxisPose().message()})


async def test_its_last_words_are_told(drawing: DrawingProcess) -> None:
    with pytest.raises(TwinFailed, match="TypeError"):
        await drawing.show({"shape": {"limits": [], "channels": []}, "scheme": "dark", "look": {}})


async def test_without_the_server_it_ends() -> None:
    """What happens to it when the server is killed: its standard input ends."""
    process = await DrawingProcess.start()
    stdin = process._process.stdin
    assert stdin is not None
    stdin.close()
    async with asyncio.timeout(20):
        assert await process._process.wait() == 0
    await process.close()


def test_a_page_of_another_form_has_no_hashes() -> None:
    assert script_hashes("<html><script>1</script></html>") == []
    assert script_hashes('<html><script data-p="x" data-ss="1" data-cs="2">const B="x"</script></html>') == []
