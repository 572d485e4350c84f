"""Studies of TMCL modules: their settings are parameters, in the driver's units or in pps, and all go back."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from app.profiles.capture import read_held
from app.studies.kinds import KINDS
from app.studies.store import StudyStore
from tests.devices.tmcl.harness import bench
from tests.studies.harness import Studied

MODULES = ("pd42-1241", "tmcm-1161")
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
HEAVIER = {"inertia_kgm2": 5e-3, "friction_nm": 0.1}
LIGHT = {"inertia_kgm2": 2e-5, "friction_nm": 0.02}
MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
COIL: dict[str, Any] = {"resistance_ohm": 2.3, "inductance_h": 4.4e-3, "run_current_a": 1.485, "supply_v": 36.0}
DRIVER_UNITS = 0
"""Unit mode (AP 255)."""


@asynccontextmanager
async def studied(folder: Path, model: str = "pd42-1241", **options: object) -> AsyncIterator[Studied]:
    async with bench(model, **options) as b:
        yield Studied(b, StudyStore(folder, aside=False))


async def words(s: Studied) -> dict[Any, int | None]:
    """All that is configuration, as it is set now."""
    return dict((await read_held(s.device)).words)


@pytest.mark.parametrize("model", MODULES)
async def test_a_first_look_finds_the_encoder_of_a_module(tmp_path: Path, model: str) -> None:
    async with studied(tmp_path, model) as s:
        before = await words(s)
        record = await s.finish(s.begin(s.document({"kind": "first_look"})))
        assert (record.state, record.verdict) == ("done", "all is well"), record.message
        assert {each.name: each.sure for each in record.findings}["encoder"] == "measured"
        assert await words(s) == before


@pytest.mark.parametrize("model", MODULES)
async def test_a_faster_ramp_of_a_module_is_found_proved_and_put_back(tmp_path: Path, model: str) -> None:
    async with studied(tmp_path, model, load=HEAVY) as s:
        before = await words(s)
        plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
        assert plan.missing == []
        record = await s.finish(s.begin(s.document(MOVE, budget={"trials": 8})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await words(s) == before
        best = record.trial(record.best)
        assert best is not None
        assert record.evidence is not None
        assert record.evidence.interval_s.high < 0
        assert "maximum_positioning_speed" in {each.name for each in best.registers}
        assert best.setting["speed"] > record.baseline_setting["speed"]


async def test_a_ramp_counts_in_the_units_of_the_driver_where_the_module_does(tmp_path: Path) -> None:
    found = []
    for folder in ("pps", "driver"):
        async with studied(tmp_path / folder, load=HEAVY) as s:
            if folder == "driver":
                for name in ("maximum_positioning_speed", "maximum_acceleration", "maximum_deceleration"):
                    await s.device.registers.write(name, 0, 50_000)
                await s.device.registers.write("unit_mode", 0, DRIVER_UNITS)
            plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
            record = await s.finish(s.begin(s.document(MOVE, budget={"trials": 4})))
            assert record.state == "done", record.message
            found.append((plan, record))
    in_pps, in_units = found
    one_pps = 16e6 / (1 << 24)
    assert in_units[1].baseline_setting["speed"] == pytest.approx(in_units[1].baseline[0].value * one_pps), (
        "a number of the driver is 0.95 pps"
    )
    assert in_pps[1].baseline_setting["speed"] == in_pps[1].baseline[0].value


async def test_a_stall_threshold_of_a_module_is_one_parameter_that_also_stops_the_motor(tmp_path: Path) -> None:
    stage = {"left_at_fullsteps": -5000.0, "right_at_fullsteps": 5000.0, "left_end_fullsteps": -300.0}
    study = {
        "kind": "stallguard",
        "within_fullsteps": 500.0,
        "stop_confirmed": True,
        "speeds_rps": [1.0],
        "free_runs": 20,
        "stops": 20,
    }
    async with studied(tmp_path, load=LIGHT, stage=stage) as s:
        before = await words(s)
        record = await s.finish(s.begin(s.document(study)))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        best = record.trial(record.best)
        assert best is not None
        held = {each.name: each.value for each in best.registers}
        assert held["stop_on_stall"] == round(best.setting["armed from"]) > 0
        assert "stop_on_stall was 0: it never stopped the motor" in record.verdict
        assert await words(s) == before


async def test_a_move_by_hand_that_a_stall_ends_is_scored_of_a_module_too(tmp_path: Path) -> None:
    stage = {"left_at_fullsteps": -5000.0, "right_at_fullsteps": 5000.0, "right_end_fullsteps": 300.0}
    async with studied(tmp_path, load=LIGHT, stage=stage) as s:
        await s.device.registers.write("stallguard2_threshold", 0, 0)
        await s.device.registers.write("stop_on_stall", 0, 30_000)
        begin = (await s.device.monitor.axis_state(0)).position
        document = s.document({"kind": "scored_move", "distance": 2 * 51_200, "repeats": 2})
        record = await s.finish(s.begin(document), 100)
        found = record.scored
        assert (record.state, found is not None) == ("done", True), record.message
        assert found is not None
        assert (found.moves, found.stalls, found.time_s, found.load_margin) == (1, 1, None, None)
        assert 0.5 < found.reached < 1
        assert record.trials[0].setting["smartenergy hysteresis start"] == 0
        assert (await s.device.monitor.axis_state(0)).position == begin


async def test_the_least_current_of_a_module_keeps_two_parameters(tmp_path: Path) -> None:
    study = {"kind": "least_current", "distance": 25_600, "loss_rate_max": 0.2, "coolstep": False, "speed_margin": 0.0}
    async with studied(tmp_path, load=LIGHT) as s:
        before = await words(s)
        record = await s.finish(s.begin(s.document(study)))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        best = record.trial(record.best)
        assert best is not None
        held = {each.name: each.value for each in best.registers}
        # 255 is the whole current, of which the driver makes 32 steps.
        assert held["maximum_current"] == 8 * (best.setting["run current scale"] + 1) - 1
        assert held["standby_current"] <= held["maximum_current"]
        assert await words(s) == before


@pytest.mark.parametrize("model", MODULES)
async def test_coolstep_of_a_module_is_looked_for_too(tmp_path: Path, model: str) -> None:
    async with studied(tmp_path, model, load=LIGHT) as s:
        document = s.document({"kind": "least_current", "distance": 25_600, "loss_rate_max": 0.2})
        plan = await KINDS["least_current"].plan(s.device, 0, document)
        assert plan.missing == []
        assert any(line.startswith("CoolStep at the run current") for line in plan.steps)
        assert "smartenergy_hysteresis_start" in plan.registers


async def test_what_hangs_on_a_module_is_identified_without_its_encoders_counts(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LIGHT) as s:
        before = await words(s)
        record = await s.finish(s.begin(s.document({"kind": "identification", "hops": 8})))
        assert (record.state, record.left) == ("done", []), record.message
        assert record.identified is not None
        assert record.identified.resonance_hz is not None
        # By the ripple of slow turns, a study of another kind, it was 152.7 Hz.
        assert record.identified.resonance_hz.value == pytest.approx(152.7, rel=0.02)
        told = {each.name: each.sure for each in record.findings}
        assert (told["damping"], told["encoder counts"]) == ("measured", "cannot be told")
        assert await words(s) == before


async def test_a_stop_leaves_a_module_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        before = await words(s)
        run = s.begin(s.document(MOVE))
        await s.clock.advance(6.1)
        assert run.running
        await s.device.stop_axes([0])
        record = await s.finish(run, 20)
        assert (record.state, record.left) == ("aborted", []), record.message
        assert await words(s) == before


@pytest.mark.parametrize(
    ("study", "why"),
    [
        ({"kind": "stealthchop", **COIL}, "no study sets the StealthChop of a PD42-1241 yet"),
        ({"kind": "microstep_calibration"}, "a PD42-1241 has no table of differences"),
        ({"kind": "closed_loop"}, "no study sets a position loop of a PD42-1241"),
    ],
)
async def test_what_no_study_of_a_module_can_do_is_told(tmp_path: Path, study: dict[str, Any], why: str) -> None:
    async with studied(tmp_path) as s:
        plan = await KINDS[study["kind"]].plan(s.device, 0, s.document(study))
        assert any(why in each for each in plan.missing), plan.missing


async def test_a_module_without_an_encoder_is_refused(tmp_path: Path) -> None:
    async with studied(tmp_path, unknown_parameters=[209]) as s:
        plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
        assert any("no encoder" in each for each in plan.missing), plan.missing


RIPPLING: dict[str, Any] = {
    "motor": {"rotor_teeth": 50, "detent_torque_nm": 0.005},
    "ripple": True,
    "supply_v": 36.0,
    "encoders": {"internal_counts": 40_000},
}
"""A motor whose chopper bends its currents, and an encoder that shows it: the usual one, of 1,024 counts, does not."""


def split_of(hysteresis: int, least: int) -> tuple[int, int]:
    """Start, which counts from 1 to 8, and end, whose `least` number means -3."""
    start = min(8, hysteresis + 3)
    return start, hysteresis - start + 3 + least


@pytest.mark.parametrize("model", MODULES)
async def test_a_calmer_chopper_of_a_module_is_found_and_put_back(tmp_path: Path, model: str) -> None:
    async with studied(tmp_path, model, **RIPPLING) as s:
        row = s.device.family.table.find("chopper_hysteresis_end", 0)
        assert row is not None
        least = row[0].minimum
        for name, value in (("chopper_hysteresis_start", 1), ("chopper_hysteresis_end", least)):
            await s.device.registers.write(name, 0, value)
        before = await words(s)
        study = {"kind": "chopper", **COIL, "speeds_rps": [0.5, 1.0]}
        plan = await KINDS["chopper"].plan(s.device, 0, s.document(study))
        assert plan.missing == []
        assert any("how fine its encoder is" in each for each in plan.warnings)
        record = await s.finish(s.begin(s.document(study, budget={"trials": 4})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        found = record.chopper
        assert found is not None
        assert found.before is not None
        assert found.calculated is not None
        assert found.before.hysteresis == -2
        assert found.calculated.hysteresis >= 4
        best = record.trial(record.best)
        assert best is not None
        assert found.chosen is not None
        start, end = (
            each.value for each in best.registers if each.name in ("chopper_hysteresis_start", "chopper_hysteresis_end")
        )
        assert {start, end} == {*split_of(found.chosen.hysteresis, least)}
        assert await words(s) == before


@pytest.mark.parametrize("model", MODULES)
async def test_a_faster_ramp_of_a_module_is_found_by_a_switch_alone(tmp_path: Path, model: str) -> None:
    stage = {"left_at_fullsteps": -21.3}
    async with studied(tmp_path, model, load=HEAVIER, stage=stage) as s:
        before = await words(s)
        study = {**MOVE, "seen_by": "left switch"}
        assert (await KINDS["fastest_move"].plan(s.device, 0, s.document(study))).missing == []
        record = await s.finish(s.begin(s.document(study, budget={"trials": 8})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert any(trial.state == "infeasible" and trial.figures.lost_fullsteps for trial in record.trials)
        assert await words(s) == before
        state = await s.device.monitor.axis_state(0)
        assert state.position == 0
        # the encoder, which the study did not ask, tells that no step is missing
        assert state.encoder_position == pytest.approx(0, abs=256)
