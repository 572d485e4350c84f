"""A twin first by itself: made of what was identified of the axis, said before, frozen as the study begins."""

from __future__ import annotations

import json
import math
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.main import bench_of
from app.settings import Settings
from app.studies.document import Identification, StudyDocument
from app.studies.fitted import Estimate
from app.studies.identification.found import Identified
from app.studies.parts import Interval
from app.studies.store import StudyStore
from tests.api.test_studies import over

INERTIA, FRICTION = 2e-5, 0.02
MOTOR = {"rotor_inertia_kgm2": INERTIA, "friction_nm": FRICTION, "viscous_nms": 1.5e-3, "detent_torque_nm": 0.02}
IDENTIFY = {
    "kind": "identification",
    "velocity_rps": 0.2,
    "hops": 6,
    "hold_torque_nm": 0.45,
    "run_current_a": 1.5,
}
MOVE = {"kind": "fastest_move", "distance": 3_200, "repeats": 1, "margin": 0.0}
CYCLE = {"kind": "least_current", "distance": 12_800}
STEP_S = 0.1


async def add(client: httpx.AsyncClient, **limits: float) -> str:
    """An axis whose motor has no load, 1.5 A at its greatest scale, and an encoder: its id."""
    link = {"kind": "emulator", "motor": MOTOR, "full_scale_a": 1.5 * math.sqrt(2)}
    body = {"name": "Slide", "model": "tmc5160", "link": link, "axes": [{"limits": limits}]}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    start = {"velocity_pps": 50_000, "acceleration_pps2": 200_000, "counts_per_rev": 40_000, "run_scale": 31}
    answer = await client.post("devices/slide/start-up", json=start)
    assert answer.status_code == 200, answer.text
    return "slide"


async def plan_of(client: httpx.AsyncClient, study: dict[str, Any]) -> tuple[str, str]:
    """Its step on a twin, and why there is none; each empty where it is not told."""
    answer = await client.post("studies/plan", json={"device": "slide", "study": study})
    assert answer.status_code == 200, answer.text
    told = answer.json()
    assert told["missing"] == []
    return next((step for step in told["steps"] if "on an emulated twin" in step), ""), told["no_twin"]


async def identified(client: httpx.AsyncClient, clock: VirtualClock) -> str:
    """Its id, when it is done."""
    done = await over(client, clock, (await begun(client, IDENTIFY))["id"])
    assert done["state"] == "done", done["message"]
    return str(done["id"])


async def begun(client: httpx.AsyncClient, study: dict[str, Any]) -> dict[str, Any]:
    answer = await client.post("studies", json={"device": "slide", "study": study, "budget": {"trials": 3}})
    assert answer.status_code == 201, answer.text
    found: dict[str, Any] = answer.json()
    return found


async def test_an_identified_axis_is_tried_on_its_twin_first_and_resumed_with_the_same(
    client: httpx.AsyncClient, clock: VirtualClock, app: FastAPI
) -> None:
    await add(client, current_full_scale_a=1.5)
    step, why = await plan_of(client, MOVE)
    assert step == ""
    assert "was not identified: a study of motor and machine" in why
    study = await identified(client, clock)
    step, why = await plan_of(client, MOVE)
    assert why == ""
    assert step.startswith("40 settings on an emulated twin (torque, inertia, friction, damping, detent torque")
    assert f"by study {study} of motor and machine, 20" in step
    assert "the rest as usual of a motor" in step
    step, why = await plan_of(client, CYCLE)
    assert step.startswith("32 currents on an emulated twin (torque, inertia, friction")
    # not where it is not to be, nor where none can see
    assert await plan_of(client, {**MOVE, "twin": None}) == ("", "")
    step, why = await plan_of(client, {**MOVE, "candidate": {"speed": 60_000.0, "acceleration": 300_000.0}})
    assert (step, why) == ("", "a candidate is proved on the axis, and nothing is searched")

    record = bench_of(app).studies.get((await begun(client, MOVE))["id"])
    while record.phase != "search":
        await clock.advance(STEP_S)
    await client.post("stop")
    cut = await over(client, clock, record.id, 30)
    assert len(cut["twin"]) >= 1
    (told,) = (one["text"] for one in cut["findings"] if one["name"] == "twin")
    assert "of 40 settings held" in told
    tried = cut["document"]["study"]["twin"]
    motor = tried["motor"]
    assert (motor["holding_torque_nm"], motor["rated_current_a"]) == (pytest.approx(0.45), 1.5)
    assert (motor["rotor_inertia_kgm2"], motor["load_inertia_kgm2"]) == (pytest.approx(INERTIA, rel=0.1), 0)
    assert (motor["load_friction_nm"], motor["friction_nm"]) == (pytest.approx(FRICTION, abs=5e-3), 0)
    assert (motor["resistance_ohm"], motor["counts_per_turn"]) == (2.3, 40_000), "the former was not told"
    assert study in (await client.get(f"studies/{record.id}/report")).text
    # what is identified later is another study's
    other = bench_of(app).studies.get(study).identified
    assert other is not None
    assert other.inertia_kgm2 is not None
    other.inertia_kgm2.value *= 2
    resumed = await client.post(f"studies/{record.id}/resume")
    assert resumed.is_success, resumed.text
    assert resumed.json()["document"]["study"]["twin"] == tried
    await client.post("stop")
    await over(client, clock, record.id, 30)
    later = (await begun(client, MOVE))["document"]["study"]["twin"]["motor"]
    assert later["rotor_inertia_kgm2"] == pytest.approx(2 * motor["rotor_inertia_kgm2"])
    await client.post("stop")


@pytest.fixture
async def kept(settings: Settings) -> str:
    """A study of motor and machine that the server finds when it starts: its id. Ask for it before the client."""
    store = StudyStore(settings.data_dir, aside=False)
    record = store.begin(StudyDocument(device="slide", study=Identification(run_current_a=1.5)))
    record.model, record.state = "tmc5160", "done"
    torque, inertia = (Estimate(value=value, interval=Interval(low=0, high=1)) for value in (0.45, INERTIA))
    record.identified = Identified(microsteps_per_turn=51_200, run_scale=31, torque_nm=torque, inertia_kgm2=inertia)
    await store.save(record)
    return record.id


async def test_a_twin_that_would_be_made_up_is_not_tried_and_the_report_says_why(
    kept: str, client: httpx.AsyncClient, clock: VirtualClock, app: FastAPI
) -> None:
    await add(client)
    record = bench_of(app).studies.get(kept)
    step, why = await plan_of(client, MOVE)
    assert step == ""
    assert "how many amperes a full scale is" in why
    assert why.endswith("set sense_resistor_ohm or current_full_scale_a in its limits")
    for limits in ({"sense_resistor_ohm": 0.325 / (1.5 * math.sqrt(2))}, {"current_full_scale_a": 1.5}):
        axes = {"axes": [{"name": "X", "limits": limits}]}
        assert (await client.patch("devices/slide", json=axes)).status_code == 200
        for _ in range(20):
            await clock.advance(STEP_S)
        assert (await plan_of(client, MOVE))[0] != "", limits
        assert (await plan_of(client, CYCLE))[0] != "", limits
    record.document.wanted(Identification).run_current_a = None
    assert "was not told the run current" in (await plan_of(client, MOVE))[1]
    # a motor that is named has its own torque, and what was identified of the rest
    plate = {"motor": {"holding_torque_nm": 0.59, "rated_current_a": 2.0}, "as_identified": True}
    step, why = await plan_of(client, {**MOVE, "twin": plate})
    assert step.startswith(f"40 settings on an emulated twin (inertia by study {kept} of motor and machine")
    assert "the rest as told" in step
    found = record.identified
    assert found is not None
    found.inertia_kgm2 = None
    step, why = await plan_of(client, MOVE)
    assert f"study {kept} of motor and machine could not tell the inertia" in why
    step, _ = await plan_of(client, {**MOVE, "twin": plate})
    assert "motor as told: study" in step
    begun_alone = await begun(client, MOVE)
    assert begun_alone["document"]["study"]["twin"] is None
    await client.post("stop")
    await over(client, clock, begun_alone["id"], 30)
    assert f"emulated twin first: study {kept}" in (await client.get(f"studies/{begun_alone['id']}/report")).text


async def test_a_study_kept_before_there_were_twins_had_none(
    client: httpx.AsyncClient, clock: VirtualClock, settings: Settings
) -> None:
    await add(client)
    study = (await begun(client, MOVE))["id"]
    await client.post("stop")
    await over(client, clock, study, 30)
    path = settings.data_dir / "studies" / study / "study.json"
    kept = json.loads(path.read_text())
    del kept["document"]["study"]["twin"]
    path.write_text(json.dumps(kept))
    later = StudyStore(settings.data_dir, aside=False)
    (record,) = later.load()
    assert record.document.model_dump()["study"]["twin"] is None
