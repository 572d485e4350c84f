"""A first start compiles behind the answers: what is asked for comes first, and what fails keeps nobody."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

import httpx
import pytest

from app import preparation
from app.clock import WallClock
from app.main import create_app
from app.preparation import Preparation
from app.settings import Settings

ROOT = Path(__file__).parent.parent


class Children:
    """Stands for the processes that compile: each ends when the test says so."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.told: list[str] = []
        """What is remembered as compiled."""
        self.have_begun = asyncio.Event()
        self.may_end = asyncio.Event()

    async def __call__(self, name: str) -> None:
        self.begun.append(name)
        self.have_begun.set()
        await self.may_end.wait()


MOVED: dict[str, tuple[str, dict[str, int]]] = {
    "tmc428": ("move", {"target": 500}),
    "tmc4361": ("move", {"target": 500}),
    "tmc5160": ("move", {"target": 5000}),
    "tmc2209": ("rotate", {"velocity": 2000}),
    "pd42-1241": ("move", {"target": 5000}),
}
"""A model of each family, and what moves it."""


@pytest.fixture
def children(monkeypatch: pytest.MonkeyPatch) -> Children:
    children = Children()
    monkeypatch.setattr(preparation, "all_compiled", lambda parts: False)
    monkeypatch.setattr(preparation, "tell_compiled", children.told.append)
    monkeypatch.setattr(preparation, "_compiled_by_a_child", children)
    return children


async def settled() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


async def test_what_somebody_waits_for_is_the_next(children: Children) -> None:
    loaded: list[str] = []
    jobs: dict[str, Callable[[], None]] = {name: lambda name=name: loaded.append(name) for name in "abcd"}  # type: ignore[misc]
    preparing = Preparation(processes=1, jobs=jobs)
    await preparing.start()
    await settled()
    assert (children.begun, preparing.progress.doing) == (["a"], ["a"])
    waiting = asyncio.create_task(preparing.ready("d"))
    await preparing.ready("of no job")
    await settled()
    assert not waiting.done()
    children.may_end.set()
    async with asyncio.timeout(10):
        await waiting
        for name in jobs:
            await preparing.ready(name)
    assert loaded == children.begun == ["a", "d", "b", "c"]
    assert (preparing.progress.done, preparing.progress.doing) == (4, [])
    assert children.told == children.begun, "each by itself: a few are not all"
    await preparing.close()


async def test_what_several_need_is_compiled_once_before_them(
    children: Children, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two processes at a time: whoever needs what is under way waits, and others go on meanwhile."""
    ends = {name: asyncio.Event() for name in "abcs"}

    async def compiled(name: str) -> None:
        children.begun.append(name)
        await ends[name].wait()

    monkeypatch.setattr(preparation, "_compiled_by_a_child", compiled)
    jobs: dict[str, Callable[[], None]] = {name: lambda: None for name in "abcs"}
    preparing = Preparation(processes=2, jobs=jobs, needs={"a": ("s",), "b": ("s",), "c": ("of no job",)})
    await preparing.start()
    await settled()
    assert children.begun == ["c", "s"]
    ends["c"].set()
    async with asyncio.timeout(10):
        await preparing.ready("c")
    await settled()
    assert children.begun == ["c", "s"]
    ends["s"].set()
    async with asyncio.timeout(10):
        await preparing.ready("s")
        while len(children.begun) < 4:
            await settled()
        assert sorted(children.begun[2:]) == ["a", "b"]
        ends["a"].set()
        ends["b"].set()
        for name in jobs:
            await preparing.ready(name)
    await preparing.close()


async def test_who_waits_for_a_job_has_what_it_needs_done_first(children: Children) -> None:
    jobs: dict[str, Callable[[], None]] = {name: lambda: None for name in "abcs"}
    preparing = Preparation(processes=1, jobs=jobs, needs={"c": ("s",)})
    await preparing.start()
    await settled()
    waiting = asyncio.create_task(preparing.ready("c"))
    await settled()
    children.may_end.set()
    async with asyncio.timeout(10):
        await waiting
    assert children.begun[:3] == ["a", "s", "c"]
    await preparing.close()


async def test_what_is_on_disk_is_loaded_behind_the_start_and_what_somebody_waits_for_is_the_next(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(preparation, "all_compiled", lambda parts: True)
    loaded: list[str] = []
    may_go = threading.Event()

    def load(name: str) -> None:
        may_go.wait(10)
        loaded.append(name)
        if name == "d":
            raise RuntimeError("torn")

    preparing = Preparation(jobs={name: partial(load, name) for name in "abcd"})
    await preparing.start()
    assert preparing.progress.done == preparing.progress.total, "nothing is compiled"
    await settled()
    waiting = asyncio.create_task(preparing.ready("d"))
    await settled()
    assert (loaded, waiting.done()) == ([], False)
    may_go.set()
    async with asyncio.timeout(10):
        await waiting
        for name in "abc":
            await preparing.ready(name)
    assert loaded == ["a", "d", "b", "c"]
    assert "d could not be loaded beforehand" in caplog.text
    await preparing.close()


async def test_a_start_leaves_the_core_to_the_page_until_somebody_waits_for_a_kernel(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked: list[str] = []
    monkeypatch.setattr(preparation, "all_compiled", lambda parts: not looked.append("at the disk"))  # type: ignore[func-returns-value]
    jobs: dict[str, Callable[[], None]] = {"served by plain Python": lambda: None, "waited for": lambda: None}
    preparing = Preparation(jobs=jobs, plain={"served by plain Python"}, after_s=3600.0)
    starting = asyncio.create_task(preparing.start())
    await preparing.ready("served by plain Python")
    await settled()
    assert looked == []
    async with asyncio.timeout(10):
        await preparing.ready("waited for")
        await starting
    assert looked == ["at the disk"]
    await preparing.close()


async def test_what_cannot_be_compiled_keeps_nobody_waiting(
    children: Children, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise RuntimeError("no compiler")

    children.may_end.set()
    preparing = Preparation(processes=2, jobs={"a": fail, "b": lambda: None})
    await preparing.start()
    async with asyncio.timeout(10):
        await preparing.ready("a")
        await preparing.ready("b")
    assert "a could not be compiled beforehand" in caplog.text
    assert children.told == ["b"]
    await preparing.close()


async def test_who_needs_compiled_code_waits_while_it_is_taken_from_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(preparation, "all_compiled", lambda parts: True)
    may_go = threading.Event()

    def wait() -> None:
        may_go.wait(30)

    preparing = Preparation(jobs={"a": wait}, plain={"a"}, after_s=3600.0)
    starting = asyncio.create_task(preparing.start())
    await settled()
    waiting = asyncio.create_task(preparing.compiled())
    async with asyncio.timeout(30):
        await starting
        await settled()
        assert not waiting.done()
        may_go.set()
        assert await waiting
    await preparing.close()


async def test_who_needs_compiled_code_does_not_wait_for_a_compiler(children: Children) -> None:
    preparing = Preparation(processes=1, jobs={"a": lambda: None}, plain={"a"})
    await preparing.start()
    async with asyncio.timeout(30):
        assert not await preparing.compiled()
    children.may_end.set()
    await preparing.close()


async def test_an_image_is_made_when_all_is_compiled_what_plain_python_could_serve_too(children: Children) -> None:
    told: list[str] = []
    jobs: dict[str, Callable[[], None]] = dict.fromkeys([*preparation.PLAIN, "ramps"], lambda: None)
    compiling = asyncio.create_task(preparation.compile_all(told.append, jobs))
    async with asyncio.timeout(30):
        await children.have_begun.wait()
        await settled()
        assert told == []
        children.may_end.set()
        await compiling
    assert told == [f"compiled {name}" for name in jobs]
    assert sorted(children.begun) == sorted(jobs)


async def test_emulated_motors_of_all_families_move_before_anything_is_compiled(
    children: Children, tmp_path: Path
) -> None:
    """Compiling is held back until the end; a study waits for it, for its trials would time plain Python."""
    saved = [{"name": model, "model": model, "link": {"kind": "emulator"}} for model in MOVED]
    path = tmp_path / "connections.json"
    path.write_text(
        json.dumps({"format": "stepscope-connections", "version": 1, "connections": saved}), encoding="utf-8"
    )
    app = create_app(Settings(data_dir=tmp_path), WallClock(), list)
    transport = httpx.ASGITransport(app)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/", timeout=60) as client,
        asyncio.timeout(60),
    ):
        for model, command in MOVED.items():
            axis = f"devices/{model}/axes/0"
            started = await client.post(f"devices/{model}/start-up", json={"axes": [0]})
            assert started.status_code < 300, started.text
            moved = await client.post(f"{axis}/{command[0]}", json=command[1])
            assert moved.status_code < 300, moved.text
            while not (await client.get(axis)).json()["position"]:  # noqa: ASYNC110 - nothing tells
                await asyncio.sleep(0.01)
            await client.delete(f"devices/{model}")
        while not (compiling := (await client.get("health/details")).json()["compiling"])["total"]:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        assert (compiling["done"], compiling["total"]) == (0, len(preparation.JOBS))
        await client.post("devices", json={"name": "tuned", "model": "tmc5160", "link": {"kind": "emulator"}})
        refused = await client.post("studies", json={"device": "tuned", "axis": 0, "study": {"kind": "first_look"}})
        assert (refused.status_code, "compiled" in refused.json()["detail"]) == (409, True), refused.text
        children.may_end.set()


NOWHERE = """
import asyncio, os
from pathlib import Path
from app import kernels, preparation
from app.calc.ramps import ticked_kernel

preparation.can_keep = preparation.all_compiled = lambda parts=(): False
preparation.BEHIND = 0

async def main():
    preparing = preparation.Preparation(processes=1, jobs={"ramps": preparation.JOBS["ramps"]})
    await preparing.start()
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    await preparing.ready("ramps")
    print(oct(folder.stat().st_mode & 0o777), sum(ticked_kernel.advance.stats.cache_hits.values()))
    await preparing.close()
    print(folder.exists())

asyncio.run(main())
"""


@pytest.mark.slow
def test_where_nothing_can_be_kept_a_child_hands_it_on_in_a_folder_that_ends_with_the_server(tmp_path: Path) -> None:
    """A read-only root, and a user without a home."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", NOWHERE],
        env=environment | {"PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.stdout.split() == ["0o700", "1", "False"], done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_server_imports_no_kernel_that_the_preparation_does_not_compile() -> None:
    # Else what an image was prepared with would never be all, and each of its starts would begin to compile.
    code = (
        "import app.preparation, app.kernels as kernels; known = set(kernels._sources); import app.main; "
        "print(sorted(path.name for path in kernels._sources - known))"
    )
    told = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
