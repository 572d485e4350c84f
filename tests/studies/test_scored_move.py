"""A move by hand on an emulated axis: scored with the settings in force, of which it sets none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.studies.document import StudyDocument
from app.studies.kinds import KINDS
from app.studies.ramp_settings import held_of
from app.studies.record import Figures
from app.studies.report import html_of
from app.studies.scored_move.in_force import as_in_a_move, in_force
from app.studies.scored_move.noticed import MoveFinder
from app.studies.store import RECORD, StudyStore
from tests.devices.tmc5xxx.harness import bench
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, Studied, studied

MOVE: dict[str, Any] = {"kind": "scored_move", "distance": 25_600, "repeats": 2}
PLANT: dict[str, Any] = {"load": {"inertia_kgm2": 2e-4, "friction_nm": 0.02}, "full_scale_a": 2.0}


async def test_a_move_is_scored_with_the_settings_in_force(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(START, irun=20), **PLANT) as s:
        document = s.document(MOVE)
        plan = await KINDS["scored_move"].plan(s.device, 0, document)
        assert (plan.missing, plan.registers, plan.moves_max) == ([], [], 4)
        slow = await s.finish(s.begin(document), 60)
        assert (slow.state, slow.left, slow.baseline) == ("done", [], []), slow.message
        found = slow.scored
        assert found is not None
        assert found.moves == 4
        assert found.time_s is not None
        assert 0.6 < found.time_s < 25_600 / 50_000 + 0.3
        assert found.interval_s is not None
        assert found.vibration_fullsteps is not None
        assert 0 < found.vibration_fullsteps < found.peak_fullsteps < 2
        assert found.rest_fullsteps is not None
        assert found.lost_fullsteps == 0
        assert found.load_min is not None
        trial = slow.trial(slow.best)
        assert trial is not None
        assert trial.setting["run current scale"] == 20
        assert round(trial.setting["acceleration [pps^2]"], -1) == 200_000
        assert {"IHOLD_IRUN", "CHOPCONF", "COOLCONF", "AMAX"} <= {each.name for each in trial.registers}
        assert "Settings in force" in html_of(slow)

        amax = (await s.settings("AMAX"))[0]
        await s.device.registers.write("AMAX", 0, 2 * amax)
        fast = await s.finish(s.begin(document), 60)
        assert fast.scored is not None
        assert fast.scored.time_s is not None
        assert fast.scored.time_s < found.time_s
        assert await s.settings("AMAX") == [2 * amax]


async def test_lost_steps_are_told(tmp_path: Path) -> None:
    weak = replace(START, irun=0, ihold=0, amax=5_000_000, vmax=256_000)
    async with studied(tmp_path, weak, load={"inertia_kgm2": 5e-4, "friction_nm": 0.05}) as s:
        record = await s.finish(s.begin(s.document({**MOVE, "repeats": 1})), 60)
        assert record.scored is not None, record.message
        assert record.scored.lost_fullsteps >= 4
        assert record.trials[0].state == "infeasible"
        assert "lost" in record.verdict


async def test_the_gains_of_a_loop_are_settings_by_hand_too(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        document = s.document(MOVE)
    async with bench_4361(START_4361) as b:
        ground = (await KINDS["scored_move"].plan(b.device, 0, document)).missing
        assert ground == []


def rows(position: list[float], *, encoder: list[float] | None = None, first_s: float = 0.0) -> tuple[Any, Any]:
    """Samples of 100 Hz: position, encoder, velocity."""
    place = np.array(position, dtype=float)
    velocity = np.gradient(place) * 100
    return first_s + np.arange(len(place)) / 100, np.stack([place, np.array(encoder or position), velocity])


def test_a_move_is_found_from_rest_to_rest() -> None:
    finder = MoveFinder(3, 256)
    way = [0.0] * 30 + [float(at) for at in range(0, 2000, 100)] + [2000.0] * 60
    times, columns = rows(way, encoder=[at + 7 for at in way])
    found = []
    for begin in range(0, len(way), 7):  # in pieces, as they come
        found += finder.feed(times[begin : begin + 7], columns[:, begin : begin + 7])
    (one,) = found
    assert (one.sampled.start, one.target, one.before, one.sampled.deviation) == (0, 2000, 7, 7)
    assert one.sampled.time_s[0] == pytest.approx(-0.1, abs=0.02)
    assert one.sampled.time_s[-1] == pytest.approx(0.2 + 0.4, abs=0.03)
    assert (finder.moving, finder.missed) == (False, 0)


def test_what_is_no_whole_move_is_not_scored() -> None:
    there = [float(at) for at in range(0, 2000, 100)]
    cases = {
        "to and fro": ([0.0] * 30 + there + there[::-1] + [0.0] * 60, 1),
        "from the middle": (there + [2000.0] * 60, 1),
        "less than a full step": ([0.0] * 30 + [20.0, 40.0, 60.0, 80.0] + [100.0] * 60, 0),
    }
    for case, (way, missed) in cases.items():
        finder = MoveFinder(3, 256)
        assert finder.feed(*rows(way)) == [], case
        assert finder.missed == missed, case
    finder = MoveFinder(3, 256)
    times, columns = rows([0.0] * 30 + [5000.0] * 60)
    columns[2] = 0.0  # the counter was set at rest
    assert finder.feed(times, columns) == []
    assert finder.missed == 0
    finder = MoveFinder(3, 256)
    finder.feed(*rows([0.0] * 30 + there))
    finder.gap()
    assert finder.feed(*rows([2000.0] * 60, first_s=0.5)) == []
    assert finder.missed == 1


async def test_one_whose_server_was_killed_tells_that_the_motor_may_still_turn_and_bars_nothing(tmp_path: Path) -> None:
    store = StudyStore(tmp_path, aside=False)
    record = store.begin(StudyDocument.model_validate({"device": "slide", "study": MOVE}))
    await store.save(record)
    (found,) = StudyStore(tmp_path, aside=False).load()
    assert (found.state, found.left) == ("interrupted", [])
    assert "the motor may still turn" in found.message


async def test_a_record_that_tells_what_this_version_tells_no_more_is_read_all_the_same(tmp_path: Path) -> None:
    store = StudyStore(tmp_path, aside=False)
    record = store.begin(StudyDocument.model_validate({"device": "slide", "study": MOVE}))
    record.baseline_figures = Figures(runs=3)
    await store.save(record)
    path = store.folder(record.id) / RECORD
    told = json.loads(path.read_text())
    told["baseline_figures"]["lost_runs"] = 0
    path.write_text(json.dumps(told))
    (found,) = StudyStore(tmp_path, aside=False).load()
    assert found.baseline_figures == record.baseline_figures


TURN = 51_200
STAGE = {"left_at_fullsteps": -5000, "right_at_fullsteps": 5000, "right_end_fullsteps": 300.0}
STALLING = replace(START, stops=False, vmax=102_400, amax=400_000)


async def arm(s: Studied, sgt: int) -> None:
    """A stall stops the motor from a good part of its speed on."""
    await s.device.registers.write("COOLCONF", 0, None, {"sgt": sgt})
    await s.device.registers.write("TCOOLTHRS", 0, 174)
    await s.device.registers.write("SW_MODE", 0, None, {"sg_stop": 1})


async def test_a_move_that_a_stall_ends_is_scored_as_far_as_it_went(tmp_path: Path) -> None:
    async with studied(tmp_path, STALLING, stage=STAGE, motor={"load_value": {}}) as s:
        await arm(s, -8)
        free = await s.finish(s.begin(s.document({**MOVE, "distance": TURN, "repeats": 1})), 60)
        assert (free.state, free.scored is not None) == ("done", True), free.message
        assert free.scored is not None
        assert (free.scored.stalls, free.scored.stalled_at, free.scored.reached) == (0, None, 1)
        assert free.scored.load_min is not None
        assert free.scored.load_margin == free.scored.load_min > 0
        # A hard stop is in the way there: it stalls, goes back to where it began, and moves no more.
        record = await s.finish(s.begin(s.document({**MOVE, "distance": 2 * TURN, "repeats": 3})), 60)
        found = record.scored
        assert (record.state, found is not None) == ("done", True), record.message
        assert found is not None
        assert (found.moves, found.stalls, found.time_s, found.overshoot_fullsteps) == (1, 1, None, None)
        assert found.stalled_at is not None
        assert found.stalled_at == pytest.approx(300 * 256, abs=8 * 256)
        assert found.reached == pytest.approx(found.stalled_at / (2 * TURN))
        assert found.load_margin is None  # the value that was a stall lies between two samples, perhaps
        assert (record.trials[0].state, record.trials[0].why) == ("infeasible", "a stall stopped it")
        assert "a stall stopped it at" in record.verdict
        assert (await s.b.state()).position == 0
        assert "stopped by a stall" in html_of(record)


async def test_a_threshold_that_stops_a_free_motor_is_told_as_a_stall(tmp_path: Path) -> None:
    async with studied(tmp_path, STALLING, motor={"load_value": {}}) as s:
        await arm(s, -64)
        record = await s.finish(s.begin(s.document({**MOVE, "distance": TURN, "repeats": 2})), 60)
        found = record.scored
        assert found is not None, record.message
        assert (found.stalls, found.lost_fullsteps, found.time_s) == (1, 0, None)
        assert 0 < found.reached < 0.9


async def test_what_else_stops_a_move_is_no_stall(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(STALLING, stops=True)) as s:
        run = s.begin(s.document({**MOVE, "distance": TURN, "repeats": 1}))
        await s.clock.advance(0.4)
        s.b.switches(right=True)
        record = await s.finish(run, 60)
        assert (record.state, record.scored) == ("failed", None)
        assert "the motor stands at" in record.message


@pytest.mark.parametrize(
    ("model", "names"),
    [
        ("tmc5240", {"A2", "V2", "D2", "GLOBAL_SCALER", "CURRENT_RANGE", "SEMIN", "SEIMIN", "sg_stop", "chm"}),
        ("tmc5160", {"GLOBAL_SCALER", "SEMAX", "THIGH", "pwm_autoscale", "tpfd", "IHOLDDELAY"}),
        ("tmc5072", {"VCOOLTHRS", "VHIGH", "PWM_AMPL", "SEUP", "vsense"}),
    ],
)
async def test_what_changes_how_a_move_looks_is_among_the_settings(model: str, names: set[str]) -> None:
    async with bench(model) as b:
        found = await in_force(b.device, 0, await held_of(b.device))
        assert names <= found.values.keys()
        assert "mres" not in found.values  # positions would count otherwise


async def test_settings_of_a_move_are_set_again_and_what_is_beside_them_stays() -> None:
    async with bench("tmc5240", START) as b:
        registers = b.device.registers
        await registers.write("A2", 0, 1234)
        await registers.write("SW_MODE", 0, None, {"sg_stop": 1, "stop_l_enable": 0})
        then = await in_force(b.device, 0, await held_of(b.device))
        await registers.write("A2", 0, 99)
        await registers.write("SW_MODE", 0, None, {"sg_stop": 0, "stop_l_enable": 1})
        wanted = as_in_a_move(b.device, 0, await held_of(b.device), then.registers)
        values = {each.name: each.value for each in wanted}
        assert values["A2"] == 1234
        fields = b.device.family.table.get("SW_MODE", 0).unpack(values["SW_MODE"])
        assert (fields["sg_stop"], fields["stop_l_enable"]) == (1, 1)


async def test_an_address_with_two_meanings_bears_the_one_that_counts() -> None:
    async with bench_4361(START_4361) as b:
        registers = b.device.registers
        await registers.write("CL_DELTA_P", 0, 70_000)
        regulated = await in_force(b.device, 0, await held_of(b.device))
        assert regulated.values["PID_D"] == 70_000
        assert not {"CL_DELTA_P", "CL_BETA", "cl_imax"} & regulated.values.keys()
        assert {"hold_scale_val", "VBREAK", "RAMP_PROFILE", "stop_on_stall"} <= regulated.values.keys()
        await registers.write("ENC_IN_CONF", 0, None, {"regulation_modus": 1})
        await registers.write("CURRENT_CONF", 0, None, {"closed_loop_scale_en": 1})
        closed = await in_force(b.device, 0, await held_of(b.device))
        assert closed.values["CL_DELTA_P"] == 70_000
        assert {"CL_BETA", "cl_imax"} <= closed.values.keys()
        assert not {"PID_D", "hold_scale_val"} & closed.values.keys()
        # In a profile an address has one name.
        assert ("PID_D", 70_000) in {(each.name, each.value) for each in closed.registers}
