"""Both clients on a real server with emulated chips, as a script would use them."""

from __future__ import annotations

import asyncio
import inspect
import socket

import httpx
import numpy as np
import pytest

from app.client import AsyncBench, Bench, MoveEnded, MoveStarted, NoAnswer, NoServer, Refused
from app.client.errors import ClientError


def test_both_clients_have_the_same_calls() -> None:
    def calls(kind: type) -> dict[str, str]:
        found = inspect.getmembers(kind, inspect.isfunction)
        return {
            name: str(inspect.signature(call)).replace("Async", "") for name, call in found if not name.startswith("_")
        }

    blocking, awaited = calls(Bench), calls(AsyncBench)
    assert awaited.pop("aclose") == blocking.pop("close")
    assert blocking == awaited
    assert len(blocking) >= 15


async def test_a_session_in_asyncio(server: str) -> None:
    async with AsyncBench(server) as bench:
        assert [device.id for device in await bench.devices()] == ["bench", "slider"]
        written = await bench.write("bench", "V_MAX", 1500, axis=0)
        assert written.verified
        assert (await bench.read("bench", "v_max", 0)).value == 1500
        shares: list[float] = []
        flowing = asyncio.Event()

        async def move() -> MoveStarted:
            await flowing.wait()
            return await bench.move("bench", 0, 5000, on_look=lambda share, _: shares.append(share))

        started, run = await asyncio.gather(
            move(),
            bench.watch(
                "bench", ["position.0", "velocity.0"], seconds=1.5, rate_hz=200, on_rows=lambda _: flowing.set()
            ),
        )
        assert started.target_position == 5000
        state = await bench.axis("bench", 0)
        assert (state.position, state.moving) == (5000, False)
        assert shares == sorted(shares)
        assert shares[-1] == 1.0
        assert run.channels == ("position.0", "velocity.0")
        assert run["position.0"][-1] > run["position.0"][0]
        assert np.all(np.diff(run.time_s) > 0)
        assert run.time_s[-1] - run.time_s[0] <= 1.5


async def test_a_call_without_a_name_keeps_its_query(server: str) -> None:
    async with AsyncBench(server) as bench:
        found = await bench.call("GET", "devices/bench/registers?axis=1")
        assert found
        assert {reading["axis"] for reading in found} == {1}
        with pytest.raises(Refused):
            await bench.call("GET", "devices/bench/registers?axis=9")


async def test_a_session_in_a_plain_script(server: str) -> None:
    def script() -> None:
        with Bench(server) as bench:
            bench.write("bench", "lp_ref_conf_rm", {"SOFT_STOP": 1}, axis=1)
            bench.move("bench", 1, -3200, relative=True)
            assert bench.axis("bench", 1).position == -3200
            run = bench.watch("bench", ["position.1"], seconds=0.05)
            assert set(run["position.1"]) == {-3200}
            with pytest.raises(KeyError, match=r"velocity\.0"):
                run["velocity.0"]
            assert bench.calc("pmul-pdiv", chip="tmc428", a_max=500, ramp_div=7, pulse_div=5)["pmul"] == 109
            assert bench.call("GET", "catalog/tmc428")["title"] == "TMC428"
            added = bench.add("third", "tmc4210", clock_hz=16e6)
            assert added.emulated
            bench.remove(added.id)
            assert added.id not in [device.id for device in bench.devices()]

    await asyncio.to_thread(script)


async def test_a_recording_as_arrays(server: str) -> None:
    async with AsyncBench(server) as bench:
        trigger = {"kind": "move", "axis": 0, "pre_s": 0.1}
        begun = await bench.record("bench", ["position.0", "velocity.0"], 200, trigger=trigger, name="a move")
        assert begun.state == "waiting"
        await bench.move("bench", 0, 3000)
        done = await bench.stop_recording(begun.id)
        assert (done.state, done.name) == ("done", "a move")
        run = await bench.recorded(begun.id)
        assert run.channels == ("position.0", "velocity.0")
        assert run.units == ("microsteps", "pps")
        assert run["position.0"][0] == 0
        assert run["position.0"].max() > 0
        assert run.values.shape == (2, len(run.time_s))
        assert b"position.0" in (await bench.recording_file(begun.id)).splitlines()[0]
        assert [each.id for each in await bench.recordings("move")] == [begun.id]
        scope = b"time (s),CH1 (V)\n0,1\n0.1,2\n"
        added = await bench.add_file(begun.id, "scope.csv", scope, offset_s=0.5)
        assert (added["channels"][0]["name"], added["from_s"], added["to_s"]) == ("CH1", 0.5, 0.6)
        moved = await bench.align_file(begun.id, added["number"], offset_s=0.25)
        assert moved["offset_s"] == 0.25
        with pytest.raises(Refused, match="no recording"):
            await bench.recording_file("20200101-000000-0000")


async def test_a_move_that_is_stopped_ends(server: str) -> None:
    async with AsyncBench(server) as bench:
        stopped = False

        def stop_underway(share: float, _: object) -> None:
            nonlocal stopped
            if share > 0.1 and not stopped:
                stopped = True
                stopping.append(asyncio.ensure_future(bench.stop("bench", 0)))

        stopping: list[asyncio.Future[object]] = []
        with pytest.raises(MoveEnded) as ended:
            await bench.move("bench", 0, 50_000, on_look=stop_underway)
        await asyncio.gather(*stopping)
        assert 5000 < ended.value.position < 50_000


async def test_what_the_server_refuses_is_raised_with_its_facts(server: str) -> None:
    async with AsyncBench(server) as bench:
        with pytest.raises(Refused) as refused:
            await bench.write("bench", "V_MAX", 5000, axis=0)
        assert refused.value.status == 422
        assert refused.value.type.endswith("out-of-range")
        assert refused.value.facts["maximum"] == 2047
        with pytest.raises(Refused, match="known: bench, slider"):
            await bench.axis("nobody")
        with pytest.raises(Refused, match="colour"):
            await bench.watch("bench", ["colour.0"], seconds=1)


def test_the_way_out_is_told_once() -> None:
    assert str(Refused(409, {"detail": "it moves; stop it", "way_out": "stop it"})) == "it moves; stop it"
    assert str(Refused(504, {"detail": "no reply", "way_out": "ask again"})) == "no reply (ask again)"
    assert str(Refused(500, {})) == "status 500"


def test_nobody_there() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{free.getsockname()[1]}"
    with Bench(url) as bench:
        with pytest.raises(NoServer, match="stepscope serve"):
            bench.devices()
        with pytest.raises(NoServer):
            bench.watch("bench", ["position.0"], seconds=1)


def test_an_answer_that_never_comes_is_not_asked_for_twice() -> None:
    asked = []

    def lose(request: httpx.Request) -> httpx.Response:
        asked.append(request.url.path)
        raise httpx.ReadTimeout("lost")

    with Bench("http://bench", transport=httpx.MockTransport(lose)) as bench, pytest.raises(NoAnswer, match="may have"):
        bench.move("bench", 0, 100)
    assert asked == ["/api/v1/devices/bench/axes/0/move"]


def test_a_server_that_is_another() -> None:
    page = httpx.MockTransport(lambda _: httpx.Response(200, text="<html>"))
    with Bench("http://bench", transport=page) as bench, pytest.raises(ClientError, match="is it stepscope"):
        bench.devices()
    other = httpx.MockTransport(lambda _: httpx.Response(200, json=[{"id": 1}]))
    with Bench("http://bench", transport=other) as bench, pytest.raises(ClientError, match="another shape"):
        bench.devices()


def test_the_token_goes_with_every_request(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def note(request: httpx.Request) -> httpx.Response:
        seen.append(request.headers.get("Authorization"))
        return httpx.Response(200, json=[])

    with Bench("http://bench", token="secret", transport=httpx.MockTransport(note)) as bench:
        bench.devices()
    monkeypatch.setenv("STEPSCOPE_TOKEN", "other")
    with Bench("http://bench", transport=httpx.MockTransport(note)) as bench:
        bench.devices()
    assert seen == ["Bearer secret", "Bearer other"]


@pytest.mark.parametrize("url", ["bench:8000", "ftp://bench", "http://"])
def test_what_is_no_address(url: str) -> None:
    with pytest.raises(ValueError, match="http://HOST:PORT"):
        Bench(url)
