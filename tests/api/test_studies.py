"""Studies over REST: planned, run, taken, undone, kept, reported; and what is left of one that was cut off."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.main import bench_of, create_app
from app.settings import Settings
from app.studies.kinds import KINDS
from app.studies.stallguard.found import StallFound
from app.studies.store import StudyStore

LOAD = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
MOVE = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
NAMES = ("VMAX", "AMAX", "DMAX")
STEP_S = 0.1
SEEN_S = 1.0
"""From one look at a study that runs to the next [s]."""


@pytest.fixture
async def slide(client: httpx.AsyncClient) -> str:
    """An emulated TMC5160 with a motor, a load and an encoder, that moves: its id."""
    link = {"kind": "emulator", "load": LOAD}
    answer = await client.post("devices", json={"name": "Slide", "model": "tmc5160", "link": link})
    assert answer.status_code == 201, answer.text
    start = {"velocity_pps": 50_000, "acceleration_pps2": 200_000, "counts_per_rev": 40_000}
    answer = await client.post("devices/slide/start-up", json=start)
    assert answer.status_code == 200, answer.text
    return "slide"


async def held(client: httpx.AsyncClient) -> dict[str, int]:
    found = (await client.get("devices/slide/profile")).json()["registers"]
    return {one["name"]: one["value"] for one in found if one["name"] in NAMES}


async def over(client: httpx.AsyncClient, clock: VirtualClock, study: str, within_s: float = 600) -> dict[str, Any]:
    for _ in range(int(within_s / SEEN_S)):
        await clock.advance(SEEN_S)
        found: dict[str, Any] = (await client.get(f"studies/{study}")).json()
        if found["state"] != "running":
            return found
    raise AssertionError(found["message"])


async def test_a_study_from_its_plan_to_its_report(client: httpx.AsyncClient, clock: VirtualClock, slide: str) -> None:
    before = await held(client)
    document = {"device": slide, "axis": 0, "study": MOVE, "budget": {"trials": 3}, "name": "Slide, faster"}
    plan = (await client.post("studies/plan", json=document)).json()
    assert plan["missing"] == []
    assert plan["position_to"] == 12_800 + 1024
    assert await held(client) == before
    begun = await client.post("studies", json=document)
    assert begun.status_code == 201, begun.text
    study = begun.json()["id"]
    # nothing else may set the device meanwhile, and no second study begins
    profile = (await client.get("devices/slide/profile")).json()
    assert (await client.put("devices/slide/profile", json=profile)).status_code == 409
    assert (await client.post("studies", json=document)).status_code == 409
    await clock.advance(0.1)
    assert (await client.get(f"studies/{study}")).json()["left_s"] > 0, "as its plan tells, before its first move"
    found = await over(client, clock, study)
    assert (found["state"], found["improved"], found["left"]) == ("done", True, []), found["message"]
    assert found["message"] == "", "what it did last is over"
    assert await held(client) == before
    assert (await client.get("studies")).json()["studies"][0]["verdict"] == found["verdict"]
    marks = (await client.get(f"recordings/{found['recording']}")).json()["marks"]
    assert any(mark["text"].startswith("trial 0:") for mark in marks)
    # the best is taken and undone by a call each; both are kept as profiles
    best = next(trial for trial in found["trials"] if trial["number"] == found["best"])
    taken = await client.post(f"studies/{study}/take", json={"which": "best"})
    assert taken.status_code == 200, taken.text
    assert await held(client) == {one["name"]: one["value"] for one in best["registers"] if one["name"] in NAMES}
    kept = (await client.post(f"studies/{study}/profiles")).json()["profiles"]
    assert [("before" in one["name"], "best" in one["name"]) for one in kept] == [(True, False), (False, True)]
    await client.post(f"studies/{study}/take", json={"which": "baseline"})
    assert await held(client) == before
    report = await client.get(f"studies/{study}/report")
    assert report.headers["content-type"].startswith("text/html")
    assert "Slide, faster" in report.text
    assert (await client.delete(f"studies/{study}")).status_code == 204
    assert (await client.get(f"studies/{study}")).status_code == 404


async def test_any_setting_of_a_front_is_taken_as_not_proved_and_undone(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str, app: FastAPI
) -> None:
    before = await held(client)
    document = {"device": slide, "study": {**MOVE, "margin": 0.0, "quiet": True}, "budget": {"trials": 4}}
    study = (await client.post("studies", json=document)).json()["id"]
    record = bench_of(app).studies.get(study)
    while not record.message.startswith("pair 2 "):
        await clock.advance(STEP_S)
    await client.post("stop")
    found = await over(client, clock, study, 20)
    assert (found["state"], found["improved"], found["taken"]) == ("aborted", None, None), found["message"]
    assert found["best"] in found["front"]
    assert len(found["front"]) > 1
    take = f"studies/{study}/take"
    other = next(
        trial for trial in found["trials"] if trial["number"] in found["front"] and trial["number"] != found["best"]
    )
    taken = await client.post(take, json={"which": "trial", "trial": other["number"]})
    assert taken.status_code == 200, taken.text
    assert taken.json()["taken"] == {"trial": other["number"], "proved": False}
    assert await held(client) == {one["name"]: one["value"] for one in other["registers"] if one["name"] in NAMES}
    assert (await client.get(f"studies/{study}")).json()["taken"] == taken.json()["taken"]
    for proved in (False, True):
        record.improved = proved or None
        for body in ({"which": "best"}, {"which": "trial", "trial": found["best"]}):
            taken = await client.post(take, json=body)
            assert taken.json()["taken"] == {"trial": found["best"], "proved": proved}
    taken = await client.post(take, json={"which": "trial", "trial": other["number"]})
    assert not taken.json()["taken"]["proved"], "the best alone is proved"
    refused = await client.post(take, json={"which": "trial", "trial": 77})
    assert refused.status_code == 409
    assert f"the front has {', '.join(map(str, sorted(found['front'])))}" in refused.text
    for wrong in ({"which": "trial"}, {"which": "best", "trial": found["best"]}, {"which": "best of all"}):
        assert (await client.post(take, json=wrong)).status_code == 422
    undone = (await client.post(take, json={"which": "baseline"})).json()
    assert undone["taken"] is None
    assert await held(client) == before


async def test_a_threshold_that_is_proved_at_one_speed_is_taken_by_its_trial(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str, app: FastAPI
) -> None:
    """The record is given one: a study of StallGuard takes minutes."""
    study = (await client.post("studies", json={"device": slide, "study": MOVE})).json()["id"]
    record = bench_of(app).studies.get(study)
    while not record.trials:
        await clock.advance(STEP_S)
    await client.post("stop")
    found = await over(client, clock, study, 30)
    record.front = []
    number = found["trials"][0]["number"]
    own = {"threshold": 3, "filtered": False, "level": -24.0, "from_pps": 900.0, "trial": number}
    speeds = [{"speed_rps": 1.0, "speed_pps": 51_200.0, "own": own}, {"speed_rps": 2.0, "speed_pps": 102_400.0}]
    told = {"generation": 2, "run_fullsteps": 200.0, "push_fullsteps": 8.0, "speeds": speeds}
    take, body = f"studies/{study}/take", {"which": "trial", "trial": number}
    refused = await client.post(take, json=body)
    assert refused.status_code == 409, "before it is proved at a speed"
    record.stallguard = StallFound.model_validate(told)
    taken = await client.post(take, json=body)
    assert taken.status_code == 200, taken.text
    assert taken.json()["taken"] == {"trial": number, "proved": True}
    refused = await client.post(take, json={"which": "trial", "trial": 77})
    assert f"it has {number}" in refused.text


async def test_the_red_button_ends_it_and_the_setting_goes_back(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    before = await held(client)
    document = {"device": slide, "study": MOVE}
    study = (await client.post("studies", json=document)).json()["id"]
    await clock.advance(7.0)
    await client.post("stop")
    found = await over(client, clock, study, 30)
    assert (found["state"], found["left"]) == ("aborted", [])
    assert "stop" in found["message"]
    assert await held(client) == before


@pytest.mark.parametrize(
    ("by", "gone_on_with"), [("stop", False), ("devices/slide/axes/0/stop", False), ("stop", True), ("study", True)]
)
async def test_a_stop_while_it_is_prepared_keeps_it_from_beginning(
    client: httpx.AsyncClient,
    clock: VirtualClock,
    slide: str,
    settings: Settings,
    monkeypatch: pytest.MonkeyPatch,
    by: str,
    gone_on_with: bool,
) -> None:
    before = await held(client)
    path, body = "studies", {"device": slide, "study": MOVE}
    if gone_on_with:
        study = (await client.post(path, json=body)).json()["id"]
        await clock.advance(7.0)
        await client.post("stop")
        await over(client, clock, study, 30)
        path, by = f"studies/{study}/resume", f"studies/{study}/stop" if by == "study" else by
    prepares, may_go_on = asyncio.Event(), threading.Event()
    loop = asyncio.get_running_loop()

    def prepare() -> None:
        loop.call_soon_threadsafe(prepares.set)
        assert may_go_on.wait(30)

    monkeypatch.setattr("app.studies.service._import_scipy", prepare)
    begun = asyncio.create_task(client.post(path, json=body))
    await prepares.wait()
    stopped = await client.post(by)
    assert stopped.is_success, stopped.text
    may_go_on.set()
    refused = await begun
    assert refused.status_code == 409, refused.text
    assert "a stop of axis 0 overtook" in refused.text
    await clock.advance(1.0)
    assert not (await client.get("devices/slide/axes/0")).json()["moving"]
    assert await held(client) == before
    assert {one["state"] for one in (await client.get("studies")).json()["studies"]} <= {"failed"}
    (found,) = StudyStore(settings.data_dir, aside=False).load()
    assert (found.state, found.left) == ("failed", []), "for the next start, too"


async def test_a_stop_while_it_waits_for_machine_code_keeps_it_from_beginning(
    client: httpx.AsyncClient, slide: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits, may_go_on = asyncio.Event(), asyncio.Event()

    async def compiled(*_: object) -> None:
        waits.set()
        await may_go_on.wait()

    monkeypatch.setattr("app.api.studies.routes._require_speed", compiled)
    begun = asyncio.create_task(client.post("studies", json={"device": slide, "study": MOVE}))
    await waits.wait()
    await client.post("stop")
    may_go_on.set()
    refused = await begun
    assert refused.status_code == 409, refused.text
    assert "a stop of axis 0 overtook" in refused.text
    assert (await client.get("studies")).json()["studies"][0]["state"] == "failed"


async def test_what_a_killed_server_has_left_is_told_and_put_back(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str, app: FastAPI, settings: Settings
) -> None:
    before = await held(client)
    study = (await client.post("studies", json={"device": slide, "study": MOVE})).json()["id"]
    while await held(client) == before:
        await clock.advance(0.3)
    record = bench_of(app).studies.get(study)
    folder = settings.data_dir / "studies" / study
    text = (folder / "study.json").read_text()
    assert '"state": "running"' in text
    assert record.baseline
    later = create_app(settings, VirtualClock(2000.0))
    bench_of(later).studies.load()  # what the next start does
    left = bench_of(later).studies.get(study)
    assert left.state == "interrupted"
    assert any("VMAX" in line for line in left.left)
    await client.post("stop")
    await over(client, clock, study, 30)
    assert await held(client) == before


async def add_loop(client: httpx.AsyncClient) -> None:
    """A TMC4361 with motor and encoder, set up, whose loop is off."""
    link = {"kind": "emulator", "motor": {"viscous_nms": 4e-4}}
    answer = await client.post("devices", json={"name": "Loop", "model": "tmc4361", "link": link})
    assert answer.status_code == 201, answer.text
    start = {"velocity_pps": 50_000, "acceleration_pps2": 200_000, "counts_per_rev": 40_000, "stops": False}
    assert (await client.post("devices/loop/start-up", json=start)).status_code == 200


async def test_gains_that_a_study_has_kept_are_put_back_with_the_loop_on(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    async def loop_now() -> list[int]:
        names = ("ENC_IN_CONF", "RAMPMODE", "VMAX")  # what can be read
        read = [await client.get(f"devices/loop/registers/{name}", params={"axis": 0}) for name in names]
        return [one.json()["value"] for one in read]

    await add_loop(client)
    before = await loop_now()
    wanted = {"kind": "closed_loop", "hops": 6, "keep": True}
    study = (await client.post("studies", json={"device": "loop", "study": wanted})).json()["id"]
    found = await over(client, clock, study, 300)
    assert (found["state"], found["improved"]) == ("done", True), found["message"] or found["verdict"]
    assert await loop_now() != before
    taken = await client.post(f"studies/{study}/take", json={"which": "baseline"})
    assert taken.status_code == 200, taken.text
    assert await loop_now() == before


async def test_a_loop_that_a_killed_server_has_left_on_is_told_and_switched_off(
    client: httpx.AsyncClient, clock: VirtualClock, app: FastAPI
) -> None:
    async def modus() -> int:
        read = await client.get("devices/loop/registers/ENC_IN_CONF", params={"axis": 0})
        found: int = read.json()["fields"]["regulation_modus"]
        return found

    async def ramp() -> list[int]:
        read = [await client.get(f"devices/loop/registers/{name}", params={"axis": 0}) for name in ("RAMPMODE", "VMAX")]
        return [one.json()["value"] for one in read]

    await add_loop(client)
    before = await ramp()
    begun = await client.post("studies", json={"device": "loop", "study": {"kind": "closed_loop", "hops": 6}})
    assert begun.status_code == 201, begun.text
    study = begun.json()["id"]
    studies = bench_of(app).studies
    for _ in range(2000):
        if await modus() == 2:
            break
        await clock.advance(0.05)
    assert await modus() == 2, studies.get(study).message
    text = studies.get(study).model_dump_json()  # as it is on disk
    # its steps go by another ramp and speed, which are put back as well
    assert {"RAMPMODE", "VMAX"} <= {each.name for each in studies.get(study).baseline}
    await client.post("stop")
    await over(client, clock, study, 30)
    # the server is killed with the loop on: the next one finds this record, and this chip
    for name, body in (
        ("ENC_IN_CONF", {"fields": {"regulation_modus": 2}}),
        ("VMAX", {"value": before[1] // 2}),
        ("RAMPMODE", {"value": 4}),
    ):
        written = await client.put(f"devices/loop/registers/{name}", params={"axis": 0}, json=body)
        assert written.status_code == 200, written.text
    folder = bench_of(app).settings.data_dir / "studies" / study
    (folder / "study.json").write_text(text)
    later = StudyStore(bench_of(app).settings.data_dir, aside=False)
    (killed,) = [record for record in later.load() if record.id == study]
    assert killed.state == "interrupted"
    assert any("ENC_IN_CONF (regulation_modus was 0)" in line for line in killed.left)
    studies.get(study).left = killed.left
    left = (await client.get(f"studies/{study}/left")).json()["left"]
    assert "regulation_modus of ENC_IN_CONF is 2, and was 0" in left
    taken = await client.post(f"studies/{study}/take", json={"which": "baseline"})
    assert taken.status_code == 200, taken.text
    assert await modus() == 0
    assert await ramp() == before


@pytest.mark.parametrize(
    ("study", "said"),
    [
        ({"kind": "fastest_move", "distance": 0}, "goes somewhere"),
        ({"kind": "fastest_move", "distance": 10, "pairs": 3}, "greater than or equal to 10"),
        ({"kind": "guess"}, "first_look"),
    ],
    ids=["no way", "few pairs", "no study"],
)
async def test_a_document_that_cannot_be_is_refused_by_its_place(
    client: httpx.AsyncClient, slide: str, study: dict[str, Any], said: str
) -> None:
    answer = await client.post("studies", json={"device": slide, "study": study})
    assert answer.status_code == 422
    assert said in answer.text


async def test_a_chip_without_an_encoder_is_told_so(client: httpx.AsyncClient) -> None:
    plan = (await client.post("studies/plan", json={"device": "bench", "study": MOVE})).json()
    assert len(plan["missing"]) == 1
    assert "TMC428" in plan["missing"][0]
    assert (await client.post("studies", json={"device": "bench", "study": MOVE})).status_code == 409


async def test_a_plan_tells_why_nothing_is_tried_on_a_twin(client: httpx.AsyncClient, slide: str) -> None:
    told = {}
    for study in (MOVE, {"kind": "scored_move", "distance": 6400}, {"kind": "identification"}):
        plan = await client.post("studies/plan", json={"device": slide, "study": study})
        told[study["kind"]] = plan.json()["no_twin"]
    assert "was not identified" in told["fastest_move"]
    assert "searches nothing" in told["scored_move"]
    assert "made of what it finds" in told["identification"]
    for name, kind in KINDS.items():
        assert not (kind.no_twin and kind.on_twin), name


async def test_each_kind_tells_whether_it_goes_on(client: httpx.AsyncClient, slide: str) -> None:
    kinds = {one["kind"]: one["goes_on"] for one in (await client.get("studies")).json()["kinds"]}
    anew = {"first_look", "scored_move", "identification", "microstep_calibration"}
    assert {kind for kind, goes_on in kinds.items() if not goes_on} == anew
    for study in (MOVE, {"kind": "identification"}):
        plan = await client.post("studies/plan", json={"device": slide, "study": study})
        assert plan.json()["goes_on"] == kinds[study["kind"]]


async def test_what_was_set_meanwhile_goes_back_before_a_study_goes_on(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    before = await held(client)
    document = {"device": slide, "study": MOVE, "budget": {"trials": 3, "time_s": 60}}
    study = (await client.post("studies", json=document)).json()["id"]
    await clock.advance(7.0)
    await client.post("stop")
    cut = await over(client, clock, study, 30)
    assert cut["ran_s"] == pytest.approx(7.0, abs=1.0)
    await client.put("devices/slide/registers/VMAX?axis=0", json={"value": 20_000})
    assert await held(client) != before
    resumed = await client.post(f"studies/{study}/resume")
    assert resumed.is_success, resumed.text
    assert {one["name"]: one["value"] for one in resumed.json()["baseline"] if one["name"] in NAMES} == before
    await client.post("stop")
    await over(client, clock, study, 30)
    assert await held(client) == before


async def test_one_that_was_cut_off_in_its_switch_goes_on_and_a_new_one_does_not_begin_there(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    study = {**MOVE, "seen_by": "left switch"}
    stage = {"left_at_fullsteps": -9.3}
    answer = await client.patch("devices/slide/emulator", json={"axes": [{"axis": 0, "stage": stage}]})
    assert answer.is_success, answer.text
    document = {"device": slide, "study": study, "budget": {"trials": 3, "time_s": 300}}
    begun = (await client.post("studies", json=document)).json()["id"]
    await clock.advance(4.0)
    await client.post("stop")
    await over(client, clock, begun, 30)
    stage["left_at_fullsteps"] = 100.0  # it is in it wherever it was stopped
    answer = await client.patch("devices/slide/emulator", json={"axes": [{"axis": 0, "stage": stage}]})
    assert answer.is_success, answer.text
    await clock.advance(0.1)
    assert any(
        "switch is pressed" in each for each in (await client.post("studies/plan", json=document)).json()["missing"]
    )
    assert (await client.post("studies", json=document)).status_code == 409
    resumed = await client.post(f"studies/{begun}/resume")
    assert resumed.is_success, resumed.text
    await clock.advance(0.5)
    assert "out of the left switch" in (await client.get(f"studies/{begun}")).json()["message"]
    await client.post("stop")
    assert (await over(client, clock, begun, 30))["left"] == []


async def test_a_study_whose_budget_is_used_up_does_not_go_on(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str, app: FastAPI
) -> None:
    study = (await client.post("studies", json={"device": slide, "study": MOVE})).json()["id"]
    await clock.advance(3.0)
    await client.post("stop")
    await over(client, clock, study, 30)
    record = bench_of(app).studies.get(study)
    record.ran_s = record.document.budget.time_s + 1
    refused = await client.post(f"studies/{study}/resume")
    assert refused.status_code == 409
    assert "budget is used up" in refused.json()["detail"]
    assert record.state == "aborted"


async def test_an_own_search_over_rest_is_taken_kept_and_undone(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    before = await held(client)
    told = (await client.get(f"studies/searchable/{slide}/0")).json()["settings"]
    ramp = next(one for one in told if one["name"] == "ramp.acceleration")
    study = {
        "kind": "custom_search",
        "space": [{"name": ramp["name"], "low": ramp["now"], "high": 4 * ramp["now"], "log": True}],
        "distances": [6_400],
        "objectives": ["time_s"],
        "repeats": 1,
    }
    document = {"device": slide, "study": study, "budget": {"trials": 3}}
    begun = await client.post("studies", json=document)
    assert begun.status_code == 201, begun.text
    found = await over(client, clock, begun.json()["id"])
    assert (found["state"], found["improved"], found["left"]) == ("done", True, []), found["verdict"]
    assert await held(client) == before
    await client.post(f"studies/{found['id']}/take", json={"which": "best"})
    taken = await held(client)
    assert taken["AMAX"] == taken["DMAX"] > before["AMAX"]
    kept = (await client.post(f"studies/{found['id']}/profiles")).json()["profiles"]
    assert ["before" in one["name"] for one in kept] == [True, False]
    await client.post(f"studies/{found['id']}/take", json={"which": "baseline"})
    assert await held(client) == before
    assert "Own search" in (await client.get(f"studies/{found['id']}/report")).text
    refused = await client.post("studies", json={**document, "study": {**study, "space": []}})
    assert refused.status_code == 422


async def test_a_scored_move_is_taken_and_undone(client: httpx.AsyncClient, clock: VirtualClock, slide: str) -> None:
    document = {"device": slide, "study": {"kind": "scored_move", "distance": 6400, "repeats": 1}}
    begun = await client.post("studies", json=document)
    assert begun.status_code == 201, begun.text
    done = await over(client, clock, begun.json()["id"], 20)
    assert done["state"] == "done", done["message"]
    listed = (await client.get("studies")).json()["studies"][0]
    assert listed["scored"] == done["scored"]
    assert listed["setting"] == done["trials"][0]["setting"]
    then = await held(client)
    changed = await client.put("devices/slide/registers/VMAX?axis=0", json={"value": 20_000})
    assert changed.status_code == 200, changed.text
    now = await held(client)
    assert now != then
    for which, expected in (("best", then), ("baseline", now)):
        taken = await client.post(f"studies/{done['id']}/take", json={"which": which})
        assert taken.status_code == 200, taken.text
        assert await held(client) == expected


async def test_taking_a_move_leaves_what_is_no_setting_of_it(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    """Which switches stop the motor is in one register with whether a stall does."""

    async def switches(**fields: int) -> dict[str, int]:
        where = f"devices/{slide}/registers/SW_MODE?axis=0"
        if fields:
            assert (await client.put(where, json={"fields": fields})).status_code == 200
        found: dict[str, int] = (await client.get(where)).json()["fields"]
        return found

    assert (await switches(sg_stop=0))["stop_l_enable"] == 1
    document = {"device": slide, "study": {"kind": "scored_move", "distance": 6400, "repeats": 1}}
    done = await over(client, clock, (await client.post("studies", json=document)).json()["id"], 20)
    assert (done["state"], done["trials"][0]["setting"]["sg_stop"]) == ("done", 0), done["message"]
    changed = await switches(sg_stop=1, stop_l_enable=0)
    taken = await client.post(f"studies/{done['id']}/take", json={"which": "best"})
    assert taken.status_code == 200, taken.text
    assert await switches() == {**changed, "sg_stop": 0}
    assert (await client.post(f"studies/{done['id']}/take", json={"which": "baseline"})).status_code == 200
    assert await switches() == changed


async def test_a_noticed_move_that_a_stall_ends_is_scored(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    for name, body in (
        ("COOLCONF", {"fields": {"sgt": -64}}),
        ("TCOOLTHRS", {"value": 400}),
        ("SW_MODE", {"fields": {"sg_stop": 1}}),
    ):
        written = await client.put(f"devices/{slide}/registers/{name}?axis=0", json=body)
        assert written.status_code == 200, written.text
    assert (await client.put(f"devices/{slide}/axes/0/noticed-moves")).status_code == 200
    await clock.advance(STEP_S)
    assert (await client.post(f"devices/{slide}/axes/0/move", json={"target": 51_200})).status_code == 200
    for _ in range(200):
        await clock.advance(STEP_S)
        found = (await client.get("studies")).json()
        if found["studies"]:
            break
    assert (found["watches"][0]["noticed"], found["watches"][0]["missed"]) == (1, 0)
    (one,) = found["studies"]
    stands = (await client.get(f"devices/{slide}/axes/0")).json()["position"]
    assert 0 < stands < 51_200
    assert (one["scored"]["stalls"], one["scored"]["stalled_at"]) == (1, stands)
    assert one["scored"]["distance"] == 51_200
    assert one["scored"]["reached"] == pytest.approx(stands / 51_200)
    assert one["scored"]["time_s"] is None


async def test_moves_of_anybody_are_noticed_recorded_and_scored(
    client: httpx.AsyncClient, clock: VirtualClock, slide: str
) -> None:
    async def move(target: int, after_s: float = 3.0) -> None:
        assert (await client.post(f"devices/{slide}/axes/0/move", json={"target": target})).status_code == 200
        for _ in range(int(after_s / STEP_S)):
            await clock.advance(STEP_S)

    async def noticed(count: int = 0) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        """Those that are kept and the watches, when that many are: a thread writes them."""
        for _ in range(200):
            found = (await client.get("studies")).json()
            kept = [one for one in found["studies"] if one["noticed"]]
            assert all(one["scored"] for one in kept)
            if len(kept) >= count:
                return kept, found["watches"]
            await clock.advance(STEP_S)
        raise AssertionError(found)

    watch = f"devices/{slide}/axes/0/noticed-moves"
    await move(3_200)
    assert await noticed() == ([], [])
    begun = await client.put(watch)
    assert (begun.status_code, begun.json()["noticed"]) == (200, 0), begun.text
    await clock.advance(STEP_S)
    await move(16_000)
    amax = next(
        one["value"]
        for one in (await client.get(f"devices/{slide}/profile")).json()["registers"]
        if one["name"] == "AMAX"
    )
    slower = await client.put(f"devices/{slide}/registers/AMAX", params={"axis": 0}, json={"value": amax // 4})
    assert slower.status_code == 200, slower.text
    await move(3_200)
    (second, first), (state,) = await noticed(2)
    assert (state["noticed"], state["missed"], state["message"]) == (2, 0, "")
    assert [first["scored"]["distance"], second["scored"]["distance"]] == [12_800, -12_800]
    assert first["scored"]["time_s"] < second["scored"]["time_s"]
    name = "acceleration [pps^2]"
    assert first["setting"][name] == pytest.approx(4 * second["setting"][name], rel=0.01)
    # its recording has the move, and the setting that it was made with
    record = (await client.get(f"studies/{second['id']}")).json()
    recording = (await client.get(f"recordings/{record['recording']}")).json()
    assert recording["rows"] > 200
    assert [mark["kind"] for mark in recording["marks"]] == ["move"]
    # the setting of one of them is taken as that of any other study
    assert (await client.post(f"studies/{first['id']}/take", json={"which": "best"})).status_code == 200
    # one that is stopped on its way is told, and not scored
    await move(100_000, 0.5)
    await client.post(f"devices/{slide}/axes/0/stop")
    for _ in range(200):
        await clock.advance(STEP_S)
        found, (state,) = await noticed()
        if state["missed"]:
            break
    assert (len(found), state["noticed"], state["missed"]) == (2, 2, 1)
    # moves of a procedure are its own
    document = {"device": slide, "study": {"kind": "scored_move", "distance": 3_200, "repeats": 1}}
    begun = await client.post("studies", json=document)
    assert begun.status_code == 201, begun.text
    await over(client, clock, begun.json()["id"])
    assert len((await noticed())[0]) == 2
    assert (await client.delete(watch)).status_code == 204
    await move(0)
    found, watches = await noticed()
    assert (len(found), watches) == (2, [])


async def test_a_noticed_move_is_listed_when_its_recording_is_on_disk(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, slide: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    watch = f"devices/{slide}/axes/0/noticed-moves"
    recordings = bench_of(app).recordings
    keep, writes, held_back = recordings.keep, threading.Event(), threading.Event()

    def slow(*args: Any, **more: Any) -> str:
        writes.set()
        assert held_back.wait(60)
        return keep(*args, **more)

    monkeypatch.setattr(recordings, "keep", slow)
    assert (await client.put(watch)).status_code == 200
    await clock.advance(STEP_S)
    assert (await client.post(f"devices/{slide}/axes/0/move", json={"target": 16_000})).status_code == 200
    for _ in range(200):
        await clock.advance(STEP_S)
        if writes.is_set():
            break
    assert writes.is_set()
    found = (await client.get("studies")).json()
    assert ([one for one in found["studies"] if one["noticed"]], found["watches"][0]["noticed"]) == ([], 0)
    held_back.set()
    for _ in range(200):
        await clock.advance(STEP_S)
        found = (await client.get("studies")).json()
        if found["studies"]:
            break
    assert ([one["noticed"] for one in found["studies"]], found["watches"][0]["noticed"]) == ([True], 1)
