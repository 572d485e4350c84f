"""A study that ends at any moment: stopped, its server killed (SIGKILL), or its link cut. Is the axis set as before?

The devices, a TMC5160, a TMC4361 and a PD42-1241, are emulated ones behind TCP, in a process that outlives every
server. What was written to each register of a chip last is heard on the wire, also of those that cannot be read; a
module is asked. Studies of all kinds are begun in turn, and ended after a time that is drawn, by one of the three in
turn. Afterwards each register of the setting holds what it held before, or `GET /studies/{id}` says that something is
left and `.../left` names the register; and one click puts it back.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import random
import signal
import socket
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

import httpx
from server_process import ServerProcess

from app.clock import ScaledClock, WallClock
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.line.line import Line
from app.emulators.line.server import LineServer
from app.emulators.line.tcp import TcpEnd
from app.emulators.server import serve_tcp
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions, Tmc5xxxPatch
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Options
from app.emulators.tmc4361.options import Tmc4361Patch
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import FaultsChange, TmclOptions, TmclPatch
from app.links.tmcl import Reply, Request
from app.profiles.items import items_by_key
from app.registers.catalog import find_model
from app.registers.model import Space
from app.registers.tmcl.commands import Opcode
from tests.bench.table import Row

TIME_SCALE = 4.0
LOAD = {"inertia_kgm2": 2e-5, "friction_nm": 0.02}
OPTIONS_5160 = Tmc5xxxOptions.model_validate(
    {
        "motor": {},
        "time_scale": TIME_SCALE,
        "load": LOAD,
        "stage": {"left_at_fullsteps": -5000.0, "right_at_fullsteps": 5000.0, "left_end_fullsteps": -300.0},
    }
)
OPTIONS_4361 = Tmc4361Options.model_validate({"motor": {}, "time_scale": TIME_SCALE, "load": LOAD})
OPTIONS_MODULE = TmclOptions.model_validate({"motor": {}, "time_scale": TIME_SCALE, "load": LOAD})
START = {"velocity_pps": 102_400, "acceleration_pps2": 400_000, "counts_per_rev": 40_000, "stops": False}
COIL = {"resistance_ohm": 2.3, "inductance_h": 4.4e-3, "run_current_a": 1.0, "supply_v": 24.0}
STUDIES: tuple[dict[str, Any], ...] = (
    {"kind": "fastest_move", "distance": 12_800, "repeats": 1},
    {"kind": "microstep_calibration", "velocity_rps": 0.25},
    {"kind": "stallguard", "within_fullsteps": 500.0, "stop_confirmed": True, "speeds_rps": [1.0], "free_runs": 20},
    {"kind": "first_look", "turns": 8.0},
    {"kind": "identification", "velocity_rps": 0.25, "hops": 8},
    {"kind": "torque_curve", "travel_turns": 20.0, "velocity_max_rps": 6.0},
    {"kind": "resonance_map", "speeds": 8},
    {"kind": "least_current", "distance": 12_800},
    {"kind": "chopper", **COIL},
    {"kind": "scored_move", "distance": 51_200, "repeats": 10},
    {
        "kind": "custom_search",
        "space": [
            {"name": "ramp.acceleration", "low": 200_000, "high": 800_000},
            {"name": "CHOPCONF.hend", "low": 0, "high": 8},
        ],
        "distances": [12_800],
        "objectives": ["peak_fullsteps"],
    },
)
LOOPS: tuple[dict[str, Any], ...] = ({"kind": "closed_loop"}, {"kind": "closed_loop", "keep": True, "hops": 6})
OF_MODULES: tuple[dict[str, Any], ...] = (
    {"kind": "fastest_move", "distance": 12_800, "repeats": 1},
    {"kind": "first_look", "turns": 1.0},
    {"kind": "least_current", "distance": 12_800},
    {"kind": "chopper", **COIL},
    {"kind": "identification", "velocity_rps": 0.25, "hops": 8},
)
BEGUN = {"tmc5160": STUDIES, "tmc4361": LOOPS, "pd42-1241": OF_MODULES}
"""What is begun on each device, in turn."""
SHARES = {"tmc4361": 0.1, "pd42-1241": 0.1}
"""So many of the aborts are of closed loops, and of modules: the rest of all other studies of a chip."""
WAYS = ("stop", "kill", "cut")
ABORTS = 200
AFTER_S, LATEST_S, CUT_S = 6.0, 40.0, 3.0
"""An abort comes so long after the beginning on the average, and at the most; a link is cut so long at the most [s]."""
WITHIN_S = 300.0
"""Far more than anything takes here, on a machine with much else to do [s]."""
Told = TypeVar("Told")
Chip = EmulatedTmc5xxx | EmulatedTmc4361
Patch = type[Tmc5xxxPatch] | type[Tmc4361Patch]


class Device(Protocol):
    """What studies are ended on."""

    @property
    def model(self) -> str: ...

    def served(self) -> AbstractContextManager[int]:
        """Behind a TCP port, in a thread of its own."""
        ...

    def setting(self) -> dict[str, int]:
        """What each register of the setting holds."""
        ...

    def power_cycle(self) -> None:
        """Off and on."""
        ...

    def cut(self, *, away: bool) -> None:
        """Cut the link, or mend it."""
        ...


class Module:
    """A module, which is asked what its parameters are: past the wire, so that nobody's link is disturbed."""

    def __init__(self, module: EmulatedModule) -> None:
        self._module, self.model = module, module.model
        table = find_model(module.model).table
        keys = (key for key in items_by_key(module.model) if key[0] is Space.AXIS)
        rows = (table.at(address, space, write=True, axis=axis) for space, address, axis in keys)
        self._rows = [row for row in rows if row is not None and row.access.writable and row.access.readable]

    @contextmanager
    def served(self) -> Iterator[int]:
        """Behind a TCP port, in a thread of its own."""
        listener = socket.create_server(("127.0.0.1", 0))
        port: int = listener.getsockname()[1]
        with LineServer(Line([self._module], WallClock()), [TcpEnd(listener)]) as self._server:
            thread = threading.Thread(target=self._server.run, name="emulated module")
            thread.start()
            try:
                yield port
            finally:
                self._server.stop()
                thread.join()

    def setting(self) -> dict[str, int]:
        """Each axis parameter of the setting."""
        return {row.name: self._value(row.address) for row in self._rows}

    def _value(self, number: int) -> int:
        reply = self._module.receive(Request(self._module.options.address, Opcode.GAP, number).encode())
        assert reply is not None
        return Reply.decode(reply).value

    def power_cycle(self) -> None:
        """Off and on."""
        self._changed(TmclPatch(power_cycle=True))

    def cut(self, *, away: bool) -> None:
        """Cut the link, or mend it."""
        self._changed(TmclPatch(faults=FaultsChange(unplugged=away)))

    def _changed(self, change: TmclPatch) -> None:
        self._server.call(lambda: self._module.patch(change))


class Heard:
    """The chip, and what was written to it last."""

    def __init__(self, chip: Chip, patch: Patch) -> None:
        self.chip, self._patch = chip, patch
        self.words: dict[int, int] = {}
        table = find_model(chip.model).table
        written = ((key[1], table.at(key[1], write=True)) for key in items_by_key(chip.model))
        self._rows = {address: row for address, row in written if row is not None and row.access.writable}

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

    @contextmanager
    def served(self) -> Iterator[int]:
        """Behind a TCP port, in a thread of its own."""
        loop = asyncio.new_event_loop()
        thread = threading.Thread(target=loop.run_forever, name="emulated chip")
        thread.start()
        server = asyncio.run_coroutine_threadsafe(serve_tcp(self, "127.0.0.1", 0), loop).result()
        try:
            yield server.sockets[0].getsockname()[1]
        finally:
            asyncio.run_coroutine_threadsafe(_closed(server), loop).result()
            loop.call_soon_threadsafe(loop.stop)
            thread.join()

    def setting(self) -> dict[str, int]:
        """What each register of the setting holds; its reset value where nothing was written."""
        return {row.name: self.words.get(address, row.reset or 0) for address, row in self._rows.items()}

    def power_cycle(self) -> None:
        """Off and on."""
        self._changed(self._patch(power_cycle=True))
        self.words.clear()

    def cut(self, *, away: bool) -> None:
        """Cut the link, or mend it."""
        self._changed(self._patch(faults=ChipFaultsChange(unplugged=away)))

    def _changed(self, change: Any) -> None:
        self.chip.patch(change)


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
    """The chip, and a server that comes and goes. studies : what is begun on it, in turn"""

    chip: Device
    server: ServerProcess
    api: httpx.Client
    studies: Sequence[dict[str, Any]]

    def connected(self) -> None:
        """Return when the device is connected."""
        _until("connected", lambda: self.api.get("/devices/slide").json().get("state") == "connected")

    def new(self) -> None:
        """The chip switched off and on, and started up: a new server does not know what can only be written."""
        self.chip.power_cycle()

        def known() -> bool:
            self.api.post("/devices/slide/start-up", json=START)
            plans = [self.api.post("/studies/plan", json=_document(study)).json() for study in self.studies]
            return all(plan.get("missing") == [] for plan in plans)

        _until("started up", known)

    def at_rest(self) -> None:
        """Return when the motor stands."""
        _until("at rest", lambda: not self.api.get("/devices/slide/axes/0").json()["moving"])

    def in_place(self) -> None:
        """At rest where it began, as the encoder has it where the chip can take the position from it."""
        self.at_rest()
        if self.chip.model == "tmc5160":
            self.api.post("/devices/slide/axes/0/position-from-encoder").raise_for_status()
        answer = self.api.post("/devices/slide/axes/0/move", json={"target": 0})
        assert answer.is_success, answer.text
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


@dataclass(frozen=True)
class Aborted:
    """One study that was ended. after_s : so long after it had begun; wrong : what is, empty where nothing is"""

    number: int
    way: str
    kind: str
    after_s: float
    state: str
    wrong: str

    def __str__(self) -> str:
        return f"abort {self.number}, {self.way} of {self.kind} after {self.after_s:.2f} s: {self.state} {self.wrong}"


def _abort(bench: Bench, number: int) -> Aborted:
    """The abort of that number, which is the seed of all that is drawn for it."""
    chance = random.Random(number)
    way, study = WAYS[number % len(WAYS)], bench.studies[number // len(WAYS) % len(bench.studies)]
    after_s = min(chance.expovariate(1 / AFTER_S), LATEST_S)

    def told(state: str, wrong: str) -> Aborted:
        return Aborted(number, way, study["kind"], after_s, state, wrong)

    bench.in_place()
    before = bench.chip.setting()
    begun = bench.api.post("/studies", json=_document(study))
    if not begun.is_success:
        return told("not begun", begun.text)
    name = begun.json()["id"]
    time.sleep(after_s)
    record = bench.end(way, name, chance.uniform(0, CUT_S))
    state = str(record["state"])
    if state == "failed":
        print(record["message"], file=sys.stderr)
    left = [*record["left"], *bench.api.get(f"/studies/{name}/left").raise_for_status().json()["left"]]
    untold = [one for one in _other(before, bench.chip.setting()) if one not in " ".join(left)] if left else []
    if state == "done" and study.get("keep") and record["improved"]:  # it was over before, and keeps what it found
        bench.api.post(f"/studies/{name}/take", json={"which": "baseline"}).raise_for_status()
        state = "done, kept and put back"
    may_turn = "turn" in " ".join([*left, record["message"]])
    untold_motion = state == "interrupted" and not may_turn
    if may_turn and not left:  # nothing was set: it goes on to its target, and what a new server knows comes back
        bench.at_rest()
        bench.new()
    if way == "kill" and not left and not may_turn:  # it was over before: what a new server cannot read comes back
        bench.at_rest()
        bench.new()
    if left:
        if may_turn:
            bench.api.post("/devices/slide/axes/0/stop").raise_for_status()
        bench.at_rest()  # where the link was cut, the motor has gone on to its target
        answer = bench.api.post(f"/studies/{name}/take", json={"which": "baseline"})
        if not answer.is_success:
            return told(state, f"what is left cannot be put back: {answer.text}")
        state = f"{state}, told and put back"
    bench.in_place()  # what a stop has written over VMAX comes back with the next move
    untold += _other(before, bench.chip.setting())
    if way == "kill":
        bench.new()
    if untold_motion:
        return told(state, "nothing tells that the motor may still turn")
    return told(state, f"{', '.join(untold)} other than before, and nothing tells it" if untold else "")


def device_of(model: str) -> Device:
    """An emulated one, just switched on."""
    if model == "tmc4361":
        return Heard(EmulatedTmc4361(WallClock(), OPTIONS_4361), Tmc4361Patch)
    if model == "pd42-1241":
        return Module(EmulatedModule(model, WallClock(), OPTIONS_MODULE))
    return Heard(EmulatedTmc5xxx("tmc5160", WallClock(), OPTIONS_5160), Tmc5xxxPatch)


def aborted(model: str, numbers: Sequence[int]) -> list[Aborted]:
    """Aborts of these numbers on one device, one after the other."""
    chip, found = device_of(model), []
    with (
        tempfile.TemporaryDirectory(prefix="stepscope-") as folder,
        chip.served() as port,
        ServerProcess(Path(folder), "--no-demo", start_within_s=WITHIN_S) as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=30) as api,
    ):
        bench = Bench(chip, server, api, BEGUN[model])
        link = {"kind": "tcp", "host": "127.0.0.1", "port": port}
        api.post("/devices", json={"name": "Slide", "model": chip.model, "link": link}).raise_for_status()
        bench.connected()
        bench.new()
        for number in numbers:
            try:
                one = _abort(bench, number)
            except httpx.HTTPStatusError as error:  # which itself does not go from one process to another
                raise RuntimeError(f"abort {number}: {error}: {error.response.text}") from None
            print(one, file=sys.stderr, flush=True)
            found.append(one)
    return found


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: a few aborts."""
    aborts = 15 if quick else ABORTS
    cores, jobs, begin = os.cpu_count() or 1, [], 0
    for model in BEGUN:
        count = round(SHARES.get(model, 1 - sum(SHARES.values())) * aborts)
        jobs += [(model, numbers) for core in range(cores) if (numbers := range(begin + core, begin + count, cores))]
        begin += count
    with ProcessPoolExecutor(cores, multiprocessing.get_context("spawn")) as processes:
        running = [processes.submit(aborted, *job) for job in jobs]
        all_of = [one for done in running for one in done.result()]
    aborts = len(all_of)
    became = Counter(f"{one.way}: {one.state}" for one in all_of)
    kinds = Counter(one.kind for one in all_of)
    wrong = [str(one) for one in all_of if one.wrong]
    return [
        Row(
            what=f"studies stopped, killed with their server (SIGKILL) or cut off, {aborts} times",
            measured=f"{aborts - len(wrong)} as before, or told and put back",
            peer=f"{aborts}",
            ratio=1 - len(wrong) / aborts,
            required="all",
            ok=not wrong,
            notes=(
                ", ".join(f"{count} {what}" for what, count in sorted(became.items())),
                ", ".join(f"{count} of {kind}" for kind, count in sorted(kinds.items())),
                *wrong,
            ),
        )
    ]
