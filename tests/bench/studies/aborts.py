"""A study that ends at any moment: stopped, its server killed (SIGKILL), or its link cut. Is the axis set as before?

The chip is an emulated TMC5160 behind TCP, in this process: it outlives every server, and what was written to each of
its registers last is heard on its wire, also of those that cannot be read. Studies of all kinds are begun in turn,
and ended after a time that is drawn, by one of the three in turn. Afterwards each register of the setting holds what
it held before, or `GET /studies/{id}` says that something is left and `.../left` names the register; and one click
puts it back.
"""

from __future__ import annotations

import asyncio
import os
import random
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

import httpx
from server_process import ServerProcess

from app.clock import ScaledClock, WallClock
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.server import serve_tcp
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions, Tmc5xxxPatch
from app.profiles.items import items_by_key
from app.registers.tmc5xxx.table import TABLES
from tests.bench.table import Row

MODEL: Final = "tmc5160"
TIME_SCALE = 4.0
OPTIONS = Tmc5xxxOptions.model_validate(
    {
        "motor": {},
        "time_scale": TIME_SCALE,
        "load": {"inertia_kgm2": 2e-5, "friction_nm": 0.02},
        "stage": {"left_at_fullsteps": -5000.0, "right_at_fullsteps": 5000.0, "left_end_fullsteps": -300.0},
    }
)
START = {"velocity_pps": 102_400, "acceleration_pps2": 400_000, "counts_per_rev": 40_000, "stops": False}
STUDIES: tuple[dict[str, Any], ...] = (
    {"kind": "fastest_move", "distance": 12_800, "repeats": 1},
    {"kind": "microstep_calibration", "velocity_rps": 0.25},
    {"kind": "stallguard", "within_fullsteps": 500.0, "stop_confirmed": True, "speeds_rps": [1.0], "free_runs": 20},
    {"kind": "first_look", "turns": 8.0},
)
WAYS = ("stop", "kill", "cut")
ABORTS = 200
AFTER_S, CUT_S = 6.0, 3.0
"""An abort comes so long after the beginning at the most, and so long is a link cut at the most [s]."""
WITHIN_S = 300.0
"""Far more than anything takes here, on a machine with much else to do [s]."""
Told = TypeVar("Told")
SETTING = {
    key[1]: row for key in items_by_key(MODEL) if (row := TABLES[MODEL].at(key[1], write=True)) and row.access.writable
}
"""Registers of the setting by address."""


class Heard:
    """The chip, and what was written to it last."""

    def __init__(self, chip: EmulatedTmc5xxx) -> None:
        self.chip = chip
        self.words: dict[int, int] = {}

    @property
    def model(self) -> str:
        return self.chip.model

    @property
    def clock(self) -> ScaledClock:
        return self.chip.clock

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        answer = self.chip.exchange(frame, at_s)
        if frame[0] & 0x80:
            self.words[frame[0] & 0x7F] = int.from_bytes(frame[1:], "big")
        return answer

    def catch_up(self, slice_s: float) -> bool:
        return self.chip.catch_up(slice_s)

    def setting(self) -> dict[str, int]:
        """What each register of the setting holds; its reset value where nothing was written."""
        return {row.name: self.words.get(address, row.reset or 0) for address, row in SETTING.items()}

    def power_cycle(self) -> None:
        """Off and on."""
        self.chip.patch(Tmc5xxxPatch(power_cycle=True))
        self.words.clear()

    def cut(self, *, away: bool) -> None:
        """Cut the link, or mend it."""
        self.chip.patch(Tmc5xxxPatch(faults=ChipFaultsChange(unplugged=away)))


@contextmanager
def _served(chip: Heard) -> Iterator[int]:
    """The chip behind a TCP port, in a thread of its own."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, name="emulated chip")
    thread.start()
    server = asyncio.run_coroutine_threadsafe(serve_tcp(chip, "127.0.0.1", 0), loop).result()
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        asyncio.run_coroutine_threadsafe(_closed(server), loop).result()
        loop.call_soon_threadsafe(loop.stop)
        thread.join()


async def _closed(server: asyncio.Server) -> None:
    server.close()
    for task in asyncio.all_tasks() - {asyncio.current_task()}:
        task.cancel()
    await asyncio.sleep(0.1)


def _until(said: str, asked: Callable[[], Told | None]) -> Told:
    """What `asked` answers, as soon as that is something. Raises AssertionError."""
    end_s = time.monotonic() + WITHIN_S
    while time.monotonic() < end_s:
        try:
            found = asked()
        except httpx.HTTPError:
            found = None
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"not within {WITHIN_S:g} s: {said}")


@dataclass
class Bench:
    """The chip, and a server that comes and goes."""

    chip: Heard
    server: ServerProcess
    api: httpx.Client

    def connected(self) -> None:
        """Return when the device is connected."""
        _until("connected", lambda: self.api.get("/devices/slide").json().get("state") == "connected")

    def new(self) -> None:
        """The chip switched off and on, and started up: a new server does not know what can only be written."""
        self.chip.power_cycle()

        def known() -> bool:
            self.api.post("/devices/slide/start-up", json=START)
            plans = [self.api.post("/studies/plan", json=_document(study)).json() for study in STUDIES]
            return all(plan.get("missing") == [] for plan in plans)

        _until("started up", known)

    def at_rest(self) -> None:
        """Return when the motor stands."""
        _until("at rest", lambda: not self.api.get("/devices/slide/axes/0").json()["moving"])

    def in_place(self) -> None:
        """At rest where it began, as the encoder has it."""
        self.at_rest()
        self.api.post("/devices/slide/axes/0/position-from-encoder").raise_for_status()
        self.api.post("/devices/slide/axes/0/move", json={"target": 0}).raise_for_status()
        _until("back", lambda: self.api.get("/devices/slide/axes/0").json()["position"] == 0)
        self.at_rest()

    def end(self, way: str, study: str, cut_s: float) -> dict[str, Any]:
        """End the study by one of the ways, and its record when it is over and the device there again."""
        if way == "stop":
            self.api.post(f"/studies/{study}/stop").raise_for_status()
        elif way == "kill":
            os.kill(self.server.pid, signal.SIGKILL)
            self.server.stop()
            self.server.start(int(self.server.url.rpartition(":")[2]))
        else:
            self.chip.cut(away=True)
            time.sleep(cut_s)
            self.chip.cut(away=False)
        found = _until("over", lambda: self._over(study))
        self.connected()
        return found

    def _over(self, study: str) -> dict[str, Any] | None:
        found: dict[str, Any] = self.api.get(f"/studies/{study}").json()
        return found if found["state"] != "running" else None


def _document(study: dict[str, Any]) -> dict[str, Any]:
    return {"device": "slide", "study": study, "budget": {"trials": 20}}


def _other(before: dict[str, int], now: dict[str, int]) -> list[str]:
    return [name for name, value in before.items() if now[name] != value]


def _abort(bench: Bench, way: str, study: dict[str, Any], chance: random.Random) -> tuple[str, str]:
    """One study that is ended: what became of it, and what is wrong with that; empty where nothing is."""
    bench.in_place()
    before = bench.chip.setting()
    begun = bench.api.post("/studies", json=_document(study))
    if not begun.is_success:
        return "not begun", begun.text
    name = begun.json()["id"]
    time.sleep(chance.uniform(0, AFTER_S))
    record = bench.end(way, name, chance.uniform(0, CUT_S))
    state = str(record["state"])
    left = [*record["left"], *bench.api.get(f"/studies/{name}/left").raise_for_status().json()["left"]]
    untold = [one for one in _other(before, bench.chip.setting()) if one not in " ".join(left)] if left else []
    if left:
        bench.at_rest()  # where the link was cut, the motor has gone on to its target
        answer = bench.api.post(f"/studies/{name}/take", json={"which": "baseline"})
        if not answer.is_success:
            return state, f"what is left cannot be put back: {answer.text}"
        state = f"{state}, told and put back"
    bench.in_place()  # what a stop has written over VMAX comes back with the next move
    untold += _other(before, bench.chip.setting())
    if way == "kill":
        bench.new()
    return state, f"{', '.join(untold)} other than before, and nothing tells it" if untold else ""


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: a few aborts."""
    aborts = 12 if quick else ABORTS
    chance = random.Random(18)
    became: Counter[str] = Counter()
    wrong: list[str] = []
    chip = Heard(EmulatedTmc5xxx(MODEL, WallClock(), OPTIONS))
    with (
        tempfile.TemporaryDirectory(prefix="stepscope-") as folder,
        _served(chip) as port,
        ServerProcess(Path(folder), "--no-demo", start_within_s=WITHIN_S) as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=30) as api,
    ):
        bench = Bench(chip, server, api)
        link = {"kind": "tcp", "host": "127.0.0.1", "port": port}
        api.post("/devices", json={"name": "Slide", "model": MODEL, "link": link}).raise_for_status()
        bench.connected()
        bench.new()
        for number in range(aborts):
            way, study = WAYS[number % len(WAYS)], STUDIES[number // len(WAYS) % len(STUDIES)]
            state, told = _abort(bench, way, study, chance)
            became[f"{way}: {state}"] += 1
            print(f"abort {number}, {way} of {study['kind']}: {state} {told}", file=sys.stderr, flush=True)
            if told:
                wrong.append(f"abort {number}, {way} of {study['kind']}: {told}")
    return [
        Row(
            what=f"studies stopped, killed with their server (SIGKILL) or cut off, {aborts} times",
            measured=f"{aborts - len(wrong)} as before, or told and put back",
            peer=f"{aborts}",
            ratio=1 - len(wrong) / aborts,
            required="all",
            ok=not wrong,
            notes=(", ".join(f"{count} {what}" for what, count in sorted(became.items())), *wrong),
        )
    ]
