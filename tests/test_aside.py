"""Work beside the server's loop: other things go on meanwhile, and it ends when it has to."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from app.aside import NotWorkedOut, in_process, worked_out
from app.clock import VirtualClock, WallClock

ROOT = Path(__file__).parent.parent
LONG_S = 60.0


def until_there_is(path: str) -> int:
    """What works until somebody else has come to something."""
    until_s = time.monotonic() + LONG_S
    while not Path(path).exists():
        if time.monotonic() > until_s:
            raise TimeoutError("nobody else came to anything")
    return os.getpid()


def refuses(what: str) -> None:
    raise ValueError(f"not {what}")


def is_killed() -> None:
    os.kill(os.getpid(), 9)


def where() -> tuple[int, str]:
    return os.getpid(), threading.current_thread().name


async def test_everything_else_goes_on_while_something_is_worked_out(tmp_path: Path) -> None:
    sign = tmp_path / "sign"

    async def else_() -> None:
        for _ in range(3):
            await asyncio.sleep(0)
        sign.touch()

    found, _ = await asyncio.gather(worked_out(WallClock(), until_there_is, str(sign), within_s=LONG_S), else_())
    assert found != os.getpid()


async def test_what_is_raised_there_is_raised_here() -> None:
    with pytest.raises(ValueError, match="not this"):
        await in_process(refuses, "this", within_s=LONG_S)


async def test_a_process_that_is_gone_and_one_that_takes_too_long_are_told(tmp_path: Path) -> None:
    with pytest.raises(NotWorkedOut, match="is gone"):
        await in_process(is_killed, within_s=LONG_S)
    with pytest.raises(NotWorkedOut, match="not through within"):
        await in_process(until_there_is, str(tmp_path / "never"), within_s=0.01)


def says_who_it_is(path: str) -> None:
    Path(path).write_text(str(os.getpid()))
    time.sleep(LONG_S)


SERVER = """
import asyncio, sys
from app.aside import in_process
from tests.test_aside import says_who_it_is
if __name__ == "__main__":
    asyncio.run(in_process(says_who_it_is, sys.argv[1], within_s=60))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="looks at /proc")
def test_a_server_that_is_killed_leaves_no_process(tmp_path: Path) -> None:
    script, said = tmp_path / "server.py", tmp_path / "pid"
    script.write_text(SERVER)
    server = subprocess.Popen([sys.executable, script, said], env={**os.environ, "PYTHONPATH": str(ROOT)})
    try:
        wait_for(lambda: said.exists() and said.read_text() != "", "it works")
    finally:
        server.kill()
        server.wait()
    worker = Path("/proc") / said.read_text()
    wait_for(lambda: not worker.exists() or "(zombie)" in (worker / "status").read_text(), "it is gone")


def wait_for(is_so: Callable[[], bool], what: str) -> None:
    until_s = time.monotonic() + LONG_S / 2
    while not is_so():
        assert time.monotonic() < until_s, what
        time.sleep(0.02)


async def test_who_gives_up_waits_no_longer(tmp_path: Path) -> None:
    task = asyncio.create_task(in_process(until_there_is, str(tmp_path / "never"), within_s=LONG_S))
    await asyncio.sleep(0)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task


async def test_where_time_waits_it_is_worked_out_here_and_not_in_the_loop() -> None:
    process, thread = await worked_out(VirtualClock(), where, within_s=LONG_S)
    assert process == os.getpid()
    assert thread != threading.current_thread().name
