"""A script has the bench: on a real server, both clients, and the commands of the terminal."""

from __future__ import annotations

import asyncio
import sys
import threading
import time
from collections.abc import Awaitable, Callable

import pytest
from typer.testing import CliRunner, Result

from app.cli import cli
from app.client import AsyncBench, Bench, BenchNotTaken, BenchTaken
from app.client import lease as leases

DEADLINE_S = 20.0


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same signs and questions, only sooner: nobody has to wait for them here."""
    monkeypatch.setattr(leases, "KEEP_EVERY_S", 0.05)
    monkeypatch.setattr(leases, "ASK_EVERY_S", 0.05)


async def until(met: Callable[[], Awaitable[bool]]) -> None:
    async with asyncio.timeout(DEADLINE_S):
        while True:
            if await met():
                return
            await asyncio.sleep(0.01)


async def run(server: str, *arguments: str) -> Result:
    return await asyncio.to_thread(CliRunner(env={"STEPSCOPE_URL": server}).invoke, cli, list(arguments))


async def test_a_plain_script_has_the_bench_alone(server: str) -> None:
    def script() -> None:
        with Bench(server) as mine, Bench(server) as other:
            with mine.lease("tuning", on_vanish="hold") as lease:
                state = mine.lease_state()
                assert (state.state, state.holder, state.mine, state.on_vanish) == ("taken", "tuning", True, "hold")
                mine.write("bench", "V_MAX", 900, axis=0)
                with pytest.raises(BenchTaken, match="tuning has the bench") as refused:
                    other.write("bench", "V_MAX", 100, axis=0)
                assert (refused.value.holder, refused.value.exit_code) == ("tuning", 6)
                with pytest.raises(BenchTaken), other.lease("too"):
                    pytest.fail("it is taken")
                assert other.read("bench", "V_MAX", 0).value == 900
                assert all(result["ok"] for result in other.stop_all())
                with mine.lease("within"):  # the same lease
                    assert other.lease_state().holder == "tuning"
                assert other.lease_state().holder == "tuning"
                assert lease.lost is None
            assert other.lease_state().state == "free"
            mine.write("bench", "V_MAX", 800, axis=0)  # borrowed again
            with other.lease("later"), pytest.raises(BenchTaken, match="later"):
                mine.write("bench", "V_MAX", 700, axis=0)

    await asyncio.to_thread(script)


async def test_in_asyncio_too(server: str) -> None:
    async with AsyncBench(server) as mine, AsyncBench(server) as other:
        async with mine.lease("tuning") as lease:
            async with mine.lease("within"):
                assert (await other.lease_state()).holder == "tuning"
            await mine.write("bench", "V_MAX", 900, axis=0)
            with pytest.raises(BenchTaken) as refused:
                await other.write("bench", "V_MAX", 100, axis=0)
            assert refused.value.holder == "tuning"
            with pytest.raises(BenchTaken):
                async with other.lease("too"):
                    pytest.fail("it is taken")
            assert lease.lost is None
        assert (await mine.lease_state()).state == "free"
        await other.write("bench", "V_MAX", 800, axis=0)


async def test_signs_keep_it_and_when_it_has_ended_that_is_told(server: str) -> None:
    async with AsyncBench(server) as mine, AsyncBench(server) as other, mine.lease("tuning") as lease:
        before_s = (await other.lease_state()).expires_in_s or 0.0

        async def has_come() -> bool:
            return ((await other.lease_state()).expires_in_s or 0.0) > before_s

        await until(has_come)
        await mine.call("DELETE", "lease")
        with pytest.raises(BenchNotTaken, match="POST /lease"):
            await mine.write("bench", "V_MAX", 900, axis=0)

        async def is_told() -> bool:
            return isinstance(lease.lost, BenchNotTaken)

        await until(is_told)


async def test_one_who_waits_gets_it_when_it_is_handed_over(server: str) -> None:
    async with AsyncBench(server) as mine, AsyncBench(server) as other:
        async with mine.lease("first") as first:

            async def second() -> str | None:
                async with other.lease("second", wait_s=DEADLINE_S):
                    return (await other.lease_state()).holder

            async def asks() -> bool:
                return bool((await mine.lease_state()).asking)

            async def is_lost() -> bool:
                return first.lost is not None

            waiting = asyncio.create_task(second())
            await until(asks)
            (asking,) = (await mine.lease_state()).asking
            assert asking["name"] == "second"
            await mine.call("POST", "lease/hand-over", {"to": asking["id"]})
            assert await waiting == "second"
            await until(is_lost)
        assert (await mine.lease_state()).asking == ()


async def test_a_blocking_one_waits_too_and_is_told_when_it_lost_it(server: str) -> None:
    def script() -> None:
        with Bench(server) as mine, Bench(server) as other, mine.lease("first") as first:
            got: list[str | None] = []

            def second() -> None:
                with other.lease("second", wait_s=DEADLINE_S):
                    got.append(other.lease_state().holder)

            thread = threading.Thread(target=second)
            thread.start()
            until_s = time.monotonic() + DEADLINE_S
            while not (asking := mine.lease_state().asking) and time.monotonic() < until_s:
                time.sleep(0.01)
            mine.call("POST", "lease/hand-over", {"to": asking[0]["id"]})
            thread.join(DEADLINE_S)
            while first.lost is None and time.monotonic() < until_s:
                time.sleep(0.01)
            assert got == ["second"]
            assert first.lost is not None

    await asyncio.to_thread(script)


async def test_the_terminal_shows_it(server: str) -> None:
    assert (await run(server, "lease")).stdout == "the bench is free\n"
    async with AsyncBench(server) as bench, bench.lease("tuning"):
        shown = await run(server, "lease")
        assert "tuning" in shown.stdout
        assert '"holder": "tuning"' in (await run(server, "lease", "--json")).stdout
        for command in (["write", "bench", "V_MAX=1", "--axis", "0"], ["lease", "ask", "--wait", "0"]):
            refused = await run(server, *command)
            assert refused.exit_code == 6
            assert "tuning has the bench" in refused.stderr
        assert (await run(server, "stop")).exit_code == 0
    assert (await run(server, "lease", "ask", "--wait", "5")).stdout == "the bench is free\n"


SCRIPT = """
import sys
from app.client import Bench, BenchTaken
with Bench() as bench:
    bench.write("bench", "V_MAX", 900, axis=0)
    with bench.lease("inner"):
        print(bench.lease_state().holder, bench.lease_state().mine)
    bench.write("bench", "V_MAX", 901, axis=0)
sys.exit(7)
"""


async def test_a_program_runs_under_one_lease(server: str, capfd: pytest.CaptureFixture[str]) -> None:
    ended = await run(server, "lease", "run", "--name", "nightly", "--", sys.executable, "-c", SCRIPT)
    assert ended.exit_code == 7, ended.output
    assert capfd.readouterr().out == "nightly True\n"
    async with AsyncBench(server) as bench:
        assert (await bench.read("bench", "V_MAX", 0)).value == 901
        assert (await bench.lease_state()).state == "free"
        async with bench.lease("tuning"):
            refused = await run(server, "lease", "run", "--", sys.executable, "-c", SCRIPT)
            assert (refused.exit_code, "tuning" in refused.stderr) == (6, True)
    missing = await run(server, "lease", "run", "--", "no-such-program-here")
    assert missing.exit_code == 2
    assert "no-such-program-here" in missing.stderr
