"""An own space of settings on emulated axes: searched, proved, put back; and what may not be searched."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from app.devices.core.axis_limits import AxisLimits
from app.devices.manager import DeviceChange
from app.emulators.tmc5xxx.options import Tmc5xxxPatch
from app.profiles.capture import read_held
from app.studies.custom_search.space import searchable
from app.studies.kinds import KINDS
from app.studies.plan import StudyPlan, axis_now
from app.studies.report import html_of
from app.studies.store import StudyStore
from tests.devices.tmcl.harness import bench as module_bench
from tests.studies.harness import START, Studied, studied
from tests.studies.test_tmc428 import studied as without_encoder

WEAK = replace(START, irun=20, ihold=20)
PLANT: dict[str, Any] = {"load": {"inertia_kgm2": 2e-4, "friction_nm": 0.02}, "full_scale_a": 2.0}
AMAX: dict[str, Any] = {"name": "AMAX", "low": 50_000, "high": 1_000_000, "log": True}
RUN: dict[str, Any] = {"name": "IHOLD_IRUN.irun", "low": 5, "high": 20}
STUDY: dict[str, Any] = {
    "kind": "custom_search",
    "space": [AMAX, RUN],
    "distances": [6_400],
    "objectives": ["time_s"],
    "repeats": 1,
}
NAMES = ("VMAX", "AMAX", "DMAX", "IHOLD_IRUN", "CHOPCONF", "V1")


def study(*space: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {**STUDY, **({"space": list(space)} if space else {}), **more}


async def planned(s: Studied, document: dict[str, Any]) -> StudyPlan:
    return await KINDS["custom_search"].plan(s.device, 0, s.document(document))


async def test_an_own_space_is_searched_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        before = await s.settings(*NAMES)
        document = s.document(STUDY, budget={"trials": 6})
        plan = await KINDS["custom_search"].plan(s.device, 0, document)
        assert plan.missing == []
        assert (plan.position_from, plan.position_to) == (0, 6_400 + 1024)
        assert plan.acceleration_max_pps2 == pytest.approx(1e6, rel=1e-3)
        assert {"AMAX of axis 0", "IHOLD_IRUN of axis 0"} == set(plan.registers)
        record = await s.finish(s.begin(document), 600)
        assert (record.state, record.improved, record.left) == ("done", True, []), (record.message, record.verdict)
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        found, best = record.custom, record.trial(record.best)
        assert found is not None
        assert best is not None
        (effect,) = found.effects
        assert (effect.figure, effect.unit, effect.significant) == ("time_s", "s", True)
        assert effect.interval.high < 0
        assert len(found.pairs) == 10
        assert best.setting["AMAX"] > record.baseline_setting["AMAX"] == pytest.approx(200_000, rel=1e-3)
        assert record.units == {"AMAX": "pps^2", "IHOLD_IRUN.irun": ""}
        assert all(5 <= one.setting["IHOLD_IRUN.irun"] <= 20 for one in record.trials)
        assert {each.name for each in best.registers} == {"AMAX", "IHOLD_IRUN"}
        assert len({tuple(one.setting.values()) for one in record.trials if one.state != "pruned"}) == 6
        assert record == s.store.get(record.id)
        report = html_of(record)
        assert "time until it rests" in report
        assert report.count("<svg") == 2


async def test_less_deviation_is_an_objective_and_a_bound_holds(tmp_path: Path) -> None:
    ramp = {"name": "ramp.acceleration", "low": 50_000, "high": 1_500_000}
    wanted = study(ramp, objectives=["peak_fullsteps"], bounds=[{"figure": "time_s", "most": 0.25}])
    async with studied(tmp_path, replace(WEAK, amax=1_500_000), **PLANT) as s:
        record = await s.finish(s.begin(s.document(wanted, budget={"trials": 6})), 600)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message or record.verdict
        found, best = record.custom, record.trial(record.best)
        assert found is not None
        assert best is not None
        slow = [one.number for one in found.tried if (one.figures.time_s or 1.0) > 0.25]
        assert slow, "its gentlest settings are too slow"
        states = {trial.number: (trial.state, trial.why) for trial in record.trials}
        assert {states[number] for number in slow} == {("infeasible", "time until it rests above its bound")}
        assert (best.figures.time_s or 1.0) <= 0.25
        assert best.number in {one.number for one in found.again}, "the least of many is measured again"
        assert found.effects[0].interval.high < 0
        assert {"AMAX", "DMAX", "V1"} <= {each.name for each in best.registers}


@pytest.mark.parametrize(("amax", "better"), [(200_000, True), (600_000, False)])
async def test_of_two_objectives_one_is_better_and_none_worse(tmp_path: Path, amax: int, better: bool) -> None:
    """At 200,000 pps^2 the move meets the rotor's resonance; from 600,000 on faster is rougher."""
    ramp = {"name": "ramp.acceleration", "low": 1.1 * amax, "high": 3_000_000}
    wanted = study(ramp, objectives=["time_s", "peak_fullsteps"])
    async with studied(tmp_path, replace(WEAK, amax=amax), **PLANT) as s:
        record = await s.finish(s.begin(s.document(wanted, budget={"trials": 6})), 600)
        assert (record.state, record.improved, record.left) == ("done", better, []), record.message or record.verdict
        assert len(record.front) > 1
        assert better == ("stays as it is" not in record.verdict)
        assert html_of(record).count("<svg") == (3 if record.custom and record.custom.effects else 1)


async def test_a_setting_that_loses_steps_is_mended_and_does_not_count(tmp_path: Path) -> None:
    wanted = study({"name": "IHOLD_IRUN.irun", "low": 0, "high": 20}, objectives=["time_s"])
    async with studied(
        tmp_path, replace(WEAK, amax=400_000, ihold=0), load={"inertia_kgm2": 5e-4, "friction_nm": 0.08}
    ) as s:
        record = await s.finish(s.begin(s.document(wanted, budget={"trials": 6})), 600)
        assert (record.state, record.left) == ("done", []), record.message
        assert any("steps lost" in trial.why or "steps were lost" in trial.why for trial in record.trials)
        assert all(not trial.figures.lost_fullsteps for trial in record.trials if trial.state == "feasible")
        state = await s.b.state()
        assert state.position == 0
        assert state.encoder_position is not None
        assert abs(state.encoder_position) < 256


async def test_where_nothing_is_better_nothing_is_claimed(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        before = await s.settings(*NAMES)
        wanted = study({"name": "TZEROWAIT", "low": 0, "high": 0.001})
        record = await s.finish(s.begin(s.document(wanted, budget={"trials": 4})), 600)
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "stays as it is" in record.verdict
        assert await s.settings(*NAMES) == before


@pytest.mark.parametrize("at_s", [0.5, 5.0, 9.3])
async def test_a_stop_puts_the_setting_back(tmp_path: Path, at_s: float) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(STUDY, budget={"trials": 30}))
        await s.clock.advance(at_s)
        assert run.running, run.record.message
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", []), record.message
        assert await s.settings(*NAMES) == before


async def test_it_goes_on_where_it_was_cut_off(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        run = s.begin(s.document(STUDY, budget={"trials": 5}))
        while len(run.record.trials) < 3:
            await s.clock.advance(0.2)
        start = run.record.start
        cut = await s.killed(run)
        tried = [trial.number for trial in cut.trials]
        record = await s.finish(s.begin(cut.document, cut), 600)
        assert record.state == "done", record.message
        assert (record.start, (await s.b.state()).position) == (start, start), "it went back to where it began"
        numbers = [trial.number for trial in record.trials]
        assert numbers[: len(tried)] == tried
        assert len(set(numbers)) == len(numbers) > len(tried)


async def test_a_killed_server_tells_what_may_be_left(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        run = s.begin(s.document(STUDY, budget={"trials": 5}))
        while len(run.record.trials) < 2:
            await s.clock.advance(0.2)
        (found,) = StudyStore(tmp_path, aside=False).load()
        assert (found.state, len(found.trials)) == ("interrupted", 2)
        assert any("AMAX" in line for line in found.left)


async def test_a_driver_fault_ends_it(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        run = s.begin(s.document(STUDY, budget={"trials": 30}))
        await s.clock.advance(6.0)
        s.b.patch(Tmc5xxxPatch(supply_v=5.0))
        record = await s.finish(run, 60)
        assert record.state == "failed"
        assert "see the condition of the axis" in record.message


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ({"name": "AMAXX", "low": 1, "high": 2}, "AMAXX is no register, field or parameter of axis 0 of Bench: is"),
        ({"name": "CHOPCONF.tof", "low": 1, "high": 2}, "CHOPCONF has no field tof: it has toff"),
        ({"name": "CHOPCONF", "low": 1, "high": 2}, "name one of CHOPCONF.toff"),
        ({"name": "XTARGET", "low": 0, "high": 100}, "XTARGET is no setting: it is a position"),
        ({"name": "XACTUAL", "low": 0, "high": 100}, "XACTUAL is no setting"),
        ({"name": "RAMPMODE", "low": 0, "high": 2}, "RAMPMODE is no setting"),
        ({"name": "X_ENC", "low": 0, "high": 100}, "X_ENC is no setting"),
        ({"name": "ENCMODE.clr_once", "low": 0, "high": 1}, "is no setting"),
        ({"name": "GCONF.test_mode", "low": 0, "high": 1}, "is no setting"),
        ({"name": "TSTEP", "low": 0, "high": 100}, "TSTEP can only be read"),
        ({"name": "SW_MODE.stop_l_enable", "low": 0, "high": 1}, "belongs to 'switches', which stays as it is"),
        ({"name": "ENC_CONST.INTEGER", "low": 0, "high": 100}, "belongs to 'encoder'"),
        ({"name": "GCONF.shaft", "low": 0, "high": 1}, "belongs to 'general'"),
        ({"name": "CHOPCONF.mres", "low": 0, "high": 8}, "says what a microstep is"),
        ({"name": "CHOPCONF.diss2g", "low": 0, "high": 1}, "protects the power stage"),
        ({"name": "MSLUT[0]", "low": 0, "high": 8}, "part of a table"),
        ({"name": "CHOPCONF.toff", "low": 1, "high": 16}, "CHOPCONF.toff takes 0 to 15, not 1 to 16"),
        ({"name": "COOLCONF.sgt", "low": -65, "high": 0}, "takes -64 to 63"),
        ({"name": "CHOPCONF.toff", "low": 0, "high": 5}, "0 switches the motor off"),
        ({"name": "AMAX", "low": 1e5, "high": 1e12}, "AMAX takes 0 to"),
        ({"name": "VMAX", "low": 1.0, "high": 1.1}, "there are no two numbers in this range"),
        ({"name": "VMAX", "low": 10_000, "high": 200_000}, "its soft limit is 100000 pps"),
        ({"name": "AMAX", "low": 10_000, "high": 3e6}, "its soft limit is 2000000 pps^2"),
        ({"name": "ramp.speed", "low": 10_000, "high": 200_000}, "the soft limit and the chip allow 100000 at most"),
        ({"name": "ramp.jerk", "low": 10_000, "high": 200_000}, "there are ramp.speed, ramp.acceleration"),
        ({"name": "ramp.speed", "low": 0, "high": 20_000}, "has to begin above 0 pps"),
        ({"name": "IHOLD_IRUN.irun", "low": 5, "high": 21}, "goes to 21 and is 20: that is more current"),
        ({"name": "IHOLD_IRUN.ihold", "low": 5, "high": 31}, "that is more current"),
        ({"name": "GLOBAL_SCALER", "low": 0.25, "high": 0.9}, "is more current than now"),
    ],
)
async def test_what_may_not_be_searched_is_refused_by_its_name(
    tmp_path: Path, setting: dict[str, Any], words: str
) -> None:
    async with studied(tmp_path, replace(WEAK, select=128), **PLANT) as s:
        limits = AxisLimits(velocity_max_pps=100_000.0, acceleration_max_pps2=2e6)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(replace(s.device.axes[0].settings, limits=limits),)))
        plan = await planned(s, study(setting))
        assert any(words in line for line in plan.missing), plan.missing


async def test_more_current_is_tried_where_it_is_asked_for_and_the_soft_limit_lets_it(tmp_path: Path) -> None:
    more = {"name": "IHOLD_IRUN.irun", "low": 5, "high": 31}
    async with studied(tmp_path, WEAK, **PLANT) as s:
        assert (await planned(s, study(more, more_current=True))).missing == []
        limits = AxisLimits(current_max_a=1.5, current_full_scale_a=2.0)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(replace(s.device.axes[0].settings, limits=limits),)))
        plan = await planned(s, study(more, more_current=True))
        assert any("soft limit" in line or "limit of current" in line for line in plan.missing), plan.missing


async def test_settings_that_set_the_same_are_refused(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        both = study(AMAX, {"name": "ramp.acceleration", "low": 50_000, "high": 400_000})
        assert any("set by the figures of the ramp too" in line for line in (await planned(s, both)).missing)
        names = study(RUN, {"name": "irun", "low": 5, "high": 10})
        assert any("is there twice" in line for line in (await planned(s, names)).missing)
        far = AxisLimits(position_min=-100, position_max=7_000)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(replace(s.device.axes[0].settings, limits=far),)))
        assert any("the soft limits end before" in line for line in (await planned(s, STUDY)).missing)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"space": []}, "at least 1"),
        ({"space": [{"name": "AMAX", "low": 5, "high": 5}]}, "low has to be below high"),
        ({"space": [{"name": "AMAX", "low": 0, "high": 5, "log": True}]}, "equal ratios begin above 0"),
        ({"space": [RUN, RUN]}, "space has ihold_irun.irun twice"),
        ({"distances": [0]}, "a move goes somewhere"),
        ({"objectives": ["time_s", "time_s"]}, "objectives has time_s twice"),
        ({"objectives": ["time_s", "peak_fullsteps"], "sampler": "cmaes"}, "CMA-ES knows one objective"),
        ({"bounds": [{"figure": "time_s"}]}, "neither least nor most"),
        ({"pairs": 9}, "greater than or equal to 10"),
    ],
)
async def test_a_document_that_cannot_be_is_refused(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    async with studied(tmp_path) as s:
        with pytest.raises(ValidationError, match=words):
            s.document({**STUDY, **change})


async def test_parameters_of_a_module_are_searched_by_their_names(tmp_path: Path) -> None:
    space = [
        {"name": "maximum_acceleration", "low": 50_000, "high": 1_000_000, "log": True},
        {"name": "chopper_off_time", "low": 2, "high": 6},
    ]
    async with module_bench("pd42-1241", load={"inertia_kgm2": 2e-4, "friction_nm": 0.02}) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = dict((await read_held(s.device)).words)
        plan = await planned(s, study(*space))
        assert plan.missing == []
        record = await s.finish(s.begin(s.document(study(*space), budget={"trials": 5})), 600)
        assert (record.state, record.improved, record.left) == ("done", True, []), (record.message, record.verdict)
        assert dict((await read_held(s.device)).words) == before
        refused = {
            "target_position": "is no setting",
            "microstep_resolution": "says what a microstep is",
            "left_limit_switch_disable": "belongs to 'switches'",
            "coordinate_1": "of no axis",
        }
        for name, words in refused.items():
            missing = (await planned(s, study({"name": name, "low": 0, "high": 1}))).missing
            assert any(words in line for line in missing), missing
        more = study({"name": "maximum_current", "low": 0.1, "high": 1.0})
        assert any("more current" in line for line in (await planned(s, more)).missing)


async def test_an_axis_without_an_encoder_is_told_so(tmp_path: Path) -> None:
    async with without_encoder(tmp_path) as (s, _):
        plan = await planned(s, study({"name": "ramp.speed", "low": 100, "high": 200}))
        assert any("encoder" in line for line in plan.missing)


async def test_what_may_be_searched_is_told_with_what_it_takes(tmp_path: Path) -> None:
    async with studied(tmp_path, WEAK, **PLANT) as s:
        limits = AxisLimits(velocity_max_pps=100_000.0)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(replace(s.device.axes[0].settings, limits=limits),)))
        found = await axis_now(s.device, 0, [])
        assert found is not None
        told = {each.name: each for each in searchable(s.device, 0, found)}
        assert (told["CHOPCONF.toff"].low, told["CHOPCONF.toff"].high, told["CHOPCONF.toff"].unit) == (1, 15, "")
        assert (told["IHOLD_IRUN.IRUN"].high, told["IHOLD_IRUN.IRUN"].now) == (20, 20), (
            "more current is to be asked for"
        )
        assert told["ramp.speed"].high == 100_000
        assert told["AMAX"].unit == "pps^2"
        assert told["AMAX"].now == pytest.approx(200_000, rel=1e-3)
        assert told["COOLCONF.sgt"].low == -64
        assert told["GCONF.en_pwm_mode"].high == 1, "it is tuned by hand too"
        assert not {"XTARGET", "RAMPMODE", "SW_MODE.stop_l_enable", "CHOPCONF.mres", "ENC_CONST.INTEGER"} & told.keys()
        for name in told:
            each = told[name]
            plan = await planned(s, study({"name": name, "low": each.low, "high": each.high}))
            if each.group != "ramp":  # whose soft limit the plan tells
                assert plan.missing == [], name
