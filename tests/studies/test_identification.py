"""Motor and machine of an emulated axis: what is told of them against what is true, and what is left."""

from __future__ import annotations

import math
import re
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.calc.motors.friction_backlash import Turn
from app.calc.motors.ring_down import Fitted
from app.calc.motors.slow_turns import SlowTurn
from app.number_text import plain
from app.studies.document import Identification
from app.studies.fitted import Estimate
from app.studies.identification.fits import fitted
from app.studies.identification.found import Identified
from app.studies.identification.measured import findings, torque_of
from app.studies.kinds import KINDS
from app.studies.report import html_of
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, studied

FULL = replace(START, irun=31, ihold=16)
STUDY: dict[str, Any] = {"kind": "identification", "velocity_rps": 0.2, "hops": 10, "hold_torque_nm": 0.45}
TORQUE, INERTIA, DAMPING, BACKLASH = 0.45, 2e-5, 0.06, 6.0
W = math.sqrt(50 * TORQUE / INERTIA)
PLANT: dict[str, Any] = {
    "motor": {
        "rotor_teeth": 50,
        "holding_torque_nm": TORQUE,
        "rated_current_a": 1.5,
        "rotor_inertia_kgm2": INERTIA,
        "detent_torque_nm": 0.02,
        "friction_nm": 0.02,
        "viscous_nms": 2 * DAMPING * INERTIA * W,
    },
    "full_scale_a": 1.5 * math.sqrt(2),
    "encoder": {"errors": {"backlash_deg": BACKLASH * 360 / 51_200}},
}
COIL: dict[str, Any] = {"supply_v": 24.0, "run_current_a": 1.5}
BACK_EMF = TORQUE / (math.sqrt(2) * 1.5)
NAMES = ("GCONF", "PWMCONF", "TPWMTHRS", "VMAX", "VSTART", "VSTOP", "AMAX", "DMAX", "V1", "IHOLD_IRUN")


def near(told: Estimate | None, true: float, within: float) -> bool:
    assert told is not None
    assert told.interval.low < told.value < told.interval.high
    return abs(told.value - true) <= within


async def test_it_tells_motor_and_machine_and_leaves_the_axis_as_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fits_in: list[threading.Thread] = []

    def noted(*what: Any) -> Any:
        fits_in.append(threading.current_thread())
        return fitted(*what)

    monkeypatch.setattr("app.studies.identification.study.fitted", noted)
    async with studied(tmp_path, FULL, **PLANT) as s:
        before = await s.settings(*NAMES)
        plan = await KINDS["identification"].plan(s.device, 0, s.document({**STUDY, **COIL}))
        assert plan.missing == []
        assert any("StealthChop tunes itself" in step for step in plan.steps)
        record = await s.finish(s.begin(s.document({**STUDY, **COIL})))
        assert record.state == "done", record.message
        told = record.identified
        assert told is not None
        assert near(told.resonance_hz, W / (2 * math.pi), 0.02 * W / (2 * math.pi))
        assert near(told.damping_ratio, DAMPING, 0.15 * DAMPING)
        assert near(told.inertia_kgm2, INERTIA, 0.05 * INERTIA)
        assert near(told.friction_share, 0.02 / TORQUE, 0.005)
        assert near(told.detent_share, 0.02 / TORQUE, 0.01)
        assert near(told.backlash_microsteps, BACKLASH, 1.0)
        assert told.encoder_lines == 10_000
        assert told.supply_v == COIL["supply_v"]
        assert near(told.resistance_ohm, 2.3, 0.03 * 2.3)
        assert near(told.inductance_h, 4.4e-3, 0.06 * 4.4e-3)
        assert near(told.back_emf_v_s_rad, BACK_EMF, 0.06 * BACK_EMF)
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        assert record.runs <= plan.moves_max
        assert record.way_fullsteps == pytest.approx(plan.way_fullsteps, rel=0.2)
        report = html_of(record)
        assert "A ring after a hop" in report
        assert re.search(r"4\.\d+ mH", report)
        assert told.inertia_kgm2 is not None
        assert f"{plain(1e7 * told.inertia_kgm2.value, 4)} g cm2" in report
        assert len(fits_in) == 1
        assert fits_in[0] is not threading.current_thread(), "the loop has stops to see to"


async def test_the_back_emf_tells_the_holding_torque_of_a_motor_whose_sheet_nobody_has(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        record = await s.finish(s.begin(s.document({**STUDY, **COIL, "hold_torque_nm": None})))
        told = record.identified
        assert told is not None
        assert near(told.torque_nm, TORQUE, 0.06 * TORQUE)
        assert near(told.inertia_kgm2, INERTIA, 0.08 * INERTIA)
        assert told.inertia_kgm2 is not None
        assert told.inertia_kgm2.interval.low < INERTIA < told.inertia_kgm2.interval.high


WANTED = Identification(hold_torque_nm=0.45, run_current_a=1.5)


def test_a_holding_torque_as_told_and_the_same_by_the_back_emf_are_surer_together() -> None:
    torque, why = torque_of(WANTED, Fitted(BACK_EMF * 0.9, BACK_EMF * 0.2))
    assert torque is not None
    assert why == ""
    assert 0.405 < torque.value < 0.45
    assert torque.half < 0.045
    alone, _ = torque_of(WANTED, None)
    assert alone is not None
    assert alone.half == pytest.approx(0.1 * alone.value)
    exact = WANTED.model_copy(update={"torque_tolerance": 0.0})
    assert torque_of(exact, Fitted(BACK_EMF, 0.1)) == (Fitted(0.45, 0.0), "")


def test_a_holding_torque_that_cannot_be_this_motors_is_named_and_nothing_is_claimed_beyond_both() -> None:
    measured = Fitted(3 * BACK_EMF, 0.2 * BACK_EMF)
    torque, why = torque_of(WANTED, measured)
    assert torque is not None
    assert "0.45 N m was told, and the back-EMF says 1.35 N m" in why
    assert torque.value - torque.half == pytest.approx(0.405)
    assert torque.value + torque.half == pytest.approx(1.35 + 0.09)


def test_what_cannot_be_told_is_named() -> None:
    told = Identified(microsteps_per_turn=51_200, run_scale=31)
    said = {one.name: one for one in findings(told, ["resonance, damping, inertia: nothing swings"])}
    assert {one.sure for one in said.values()} == {"cannot be told"}
    assert said["resonance, damping, inertia"].text == "nothing swings"
    assert "holding torque" in said["inertia"].text


@pytest.mark.parametrize(("backlash", "told"), [(0.05, True), (0.0, True), (-0.05, False)])
def test_less_backlash_than_none_is_not_claimed(backlash: float, told: bool) -> None:
    def apart(share: float) -> Fitted:
        return Fitted(2 * math.asin(0.1 / share) + backlash, 1e-3)

    turns = [Turn(apart(1.0), 1.0, 10.0), Turn(apart(1.0), 1.0, 20.0), Turn(apart(0.5), 0.5, 10.0)]
    nothing = Fitted(0.0, 0.0)
    found = fitted(SlowTurn(nothing, nothing, nothing, 0.0), turns, [])
    assert (found.torn is not None) is told
    assert any("closer together than friction alone" in one for one in found.why) is not told


async def test_a_chip_that_it_cannot_set_is_told_before_anything_moves(tmp_path: Path) -> None:
    async with bench_4361(START_4361) as b:
        async with studied(tmp_path) as s:
            document = s.document(STUDY)
        plan = await KINDS["identification"].plan(b.device, 0, document)
        assert any("no study identifies" in one for one in plan.missing)
