"""Faults of the driver: no study begins with one, and one that is seen meanwhile ends it and is no loss of steps."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import optuna
import pytest
from optuna.trial import TrialState

from app.emulators.drive.documents import MotorChange
from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.studies.kinds import KINDS
from app.studies.record import StudyRecord
from tests.studies.harness import Studied, studied

NEAR = {"left_at_fullsteps": -21.3}
COIL: dict[str, Any] = {
    "resistance_ohm": 2.3,
    "inductance_h": 4.4e-3,
    "run_current_a": 1.06,
    "supply_v": 36.0,
}
NEEDS: dict[str, dict[str, Any]] = {
    "chopper": COIL,
    "least_current": {"distance": 25_600},
    "fastest_move": {"distance": 12_800},
    "scored_move": {"distance": 12_800},
    "custom_search": {
        "space": [{"name": "ramp.acceleration", "low": 1e5, "high": 1e6}],
        "distances": [12_800],
        "objectives": ["time_s"],
    },
    "stallguard": {"stop_confirmed": True, "within_fullsteps": 400.0},
    "stealthchop": {**COIL, "holding_torque_nm": 0.45, "rated_current_a": 1.5},
}
"""What the document of a kind cannot be without."""
HOT = "the driver is too hot and has switched off"


def change(s: Studied, **motor: Any) -> None:
    s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, motor=MotorChange(**motor))]))


@pytest.mark.parametrize("kind", KINDS)
async def test_no_study_begins_while_the_driver_reports_a_fault(tmp_path: Path, kind: str) -> None:
    async with studied(tmp_path) as s:
        document = s.document({"kind": kind, **NEEDS.get(kind, {})})
        change(s, temperature_c=160.0)
        told = (await KINDS[document.study.kind].plan(s.device, 0, document)).missing
        assert told.count(f"{HOT}: see the condition of the axis") == 1, told
        record = await s.finish(s.begin(document), 60)
        assert (record.state, record.runs) == ("failed", 0)
        assert HOT in record.message


async def heated(s: Studied, study: dict[str, Any], *, runs: int, **motor: Any) -> StudyRecord:
    """A study in whose midst the driver gets a fault."""
    run = s.begin(s.document(study, budget={"trials": 12}))
    while run.running and (run.record.runs < runs or not (await s.b.state()).moving):
        await s.clock.advance(0.05)
    assert run.running, run.record.message
    change(s, **motor)
    return await s.finish(run, 60)


@pytest.mark.parametrize("by", ["encoder", "left switch"])
@pytest.mark.parametrize(
    ("motor", "said"),
    [
        ({"temperature_c": 160.0}, HOT),
        ({"short_to_ground": "a"}, "phase A is shorted to ground, and the driver is off"),
    ],
)
async def test_heat_in_a_search_is_named_and_no_trial_takes_it_for_lost_steps(
    tmp_path: Path, by: Literal["encoder", "left switch"], motor: dict[str, Any], said: str
) -> None:
    async with studied(tmp_path, stage=NEAR) as s:
        before = await s.settings("VMAX", "AMAX", "DMAX", "V1")
        study = {"kind": "fastest_move", "distance": 12_800, "repeats": 1, "seen_by": by}
        record = await heated(s, study, runs=6, **motor)
        assert record.state == "failed"
        assert record.message.startswith(f"ended by a fault of the driver: {said}")
        assert record.left == []
        assert await s.settings("VMAX", "AMAX", "DMAX", "V1") == before
        assert record.trials, "it was in its search"
        assert {trial.state for trial in record.trials} <= {"feasible", "pruned"}
        assert record.improved is None
        known = optuna.load_study(
            study_name="study", storage=f"sqlite:///{s.store.folder(record.id) / 'optuna.db'}"
        ).get_trials(states=(TrialState.COMPLETE,))
        assert len(known) == sum(trial.state == "feasible" for trial in record.trials)


@pytest.mark.parametrize(
    "study",
    [
        {"kind": "first_look"},
        {"kind": "scored_move", "distance": 102_400},
        {"kind": "identification"},
        {"kind": "least_current", "distance": 25_600, "coolstep": False},
        {"kind": "microstep_calibration"},
        {"kind": "resonance_map", "travel_turns": 4.0},
        {"kind": "stallguard", "within_fullsteps": 400.0, "stop_confirmed": True, "speeds_rps": [1.0]},
        {"kind": "torque_curve", "travel_turns": 200.0, "inertia_kgm2": 1e-3},
        {"kind": "stealthchop", "velocity_max_rps": 2.0, **NEEDS["stealthchop"]},
        {"kind": "chopper", "speeds_rps": [0.5, 1.0], **COIL},
    ],
    ids=lambda study: study["kind"],
)
async def test_a_fault_ends_a_study_of_any_kind_with_its_name(tmp_path: Path, study: dict[str, Any]) -> None:
    async with studied(tmp_path) as s:
        record = await heated(s, study, runs=0, temperature_c=160.0)
        assert record.state == "failed"
        assert record.message.startswith(f"ended by a fault of the driver: {HOT}")
        assert record.left == []
        await s.b.at_rest()
