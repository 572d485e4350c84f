"""Microstep calibration of an emulated axis whose motor is uneven: what it finds, and what it leaves."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.calc.microsteps.mslut import POWER_ON, decode
from app.devices.core.capabilities import MslutTable
from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.profiles.apply import Transaction
from app.profiles.capture import capture
from app.studies.kinds import KINDS
from app.studies.ramp_settings import document_of
from app.studies.record import AngleFigures, StudyRecord
from app.studies.report import html_of
from app.studies.store import StudyStore
from app.studies.table_settings import with_registers
from tests.devices.tmc5xxx.harness import bench
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, Studied, studied

FULL = replace(START, irun=31, ihold=31)
QUICK: dict[str, Any] = {"kind": "microstep_calibration", "velocity_rps": 0.25}
"""Four times as fast as usual: the motor has no load."""
EVEN = {"rotor_teeth": 50, "detent_torque_nm": 0.0, "viscous_nms": 1e-4}
UNEVEN = {**EVEN, "phase_unbalance": 0.03, "fourth_harmonic_deg": 3.0}
PLANT: dict[str, Any] = {"full_scale_a": 2.1, "encoder": {"errors": {"eccentricity_deg": 0.3, "line_error": 0.03}}}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


async def calibrated(s: Studied, within_s: float = 300, **study: Any) -> StudyRecord:
    return await s.finish(s.begin(s.document({**QUICK, **study})), within_s)


def amplitude(found: AngleFigures | None, order: int) -> float:
    assert found is not None
    return next(each.amplitude_deg for each in found.harmonics if each.order == order)


async def table_of(s: Studied) -> object:
    return (await s.device.need(MslutTable).read_mslut(0)).registers


async def test_it_finds_the_error_corrects_what_a_table_holds_and_leaves_the_axis_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, motor=UNEVEN, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await calibrated(s)
        found = record.microsteps
        assert record.state == "done", record.message
        assert record.improved, record.verdict
        assert found is not None
        assert amplitude(found.before, 4) == pytest.approx(3.0, abs=0.2)
        assert amplitude(found.before, 2) == pytest.approx(math.degrees(0.015), abs=0.1)
        assert found.before.shaft[0].amplitude_deg == pytest.approx(0.3, abs=0.01)
        assert amplitude(found.after, 4) < amplitude(found.before, 4) / 5
        assert amplitude(found.after, 2) == pytest.approx(amplitude(found.before, 2), abs=0.1)
        assert found.after is not None
        assert found.predicted_rms_deg == pytest.approx(found.after.rms_deg, abs=0.1)
        assert found.beyond_rms_deg == pytest.approx(math.degrees(0.015) / math.sqrt(2), abs=0.1)
        assert [pair.order for pair in found.pairs[:2]] == ["AB", "BA"]
        assert await s.settings(*NAMES) == before
        assert await table_of(s) == POWER_ON
        assert (await s.b.state()).position == 0
        assert "Error over the electrical angle" in html_of(record)
        # Taken, it is the table that was proved.
        best = record.trial(record.best)
        assert best is not None
        await s.passing(taken(s, record))
        whole = with_registers(await capture(s.device), record.baseline)
        assert whole.tables.mslut is not None
        assert tuple(whole.tables.mslut[0].words) == POWER_ON.words
        assert not any(part.name.startswith("MSLUT") for part in whole.registers)
        assert list(decode((await s.device.need(MslutTable).read_mslut(0)).registers).values) == found.wave


async def taken(s: Studied, record: StudyRecord) -> None:
    best = record.trial(record.best)
    assert best is not None
    await Transaction(s.device, document_of(s.device, best.registers, "best")).run()


async def test_where_a_table_can_do_nothing_it_stays_and_nothing_is_tried(tmp_path: Path) -> None:
    motor = {**EVEN, "phase_unbalance": 0.05, "quadrature_error_deg": 2.0}
    async with studied(tmp_path, FULL, motor=motor, **PLANT) as s:
        record = await calibrated(s)
        assert record.improved is False
        assert record.trials == []
        assert "stays as it is" in record.verdict
        told = {finding.name: finding for finding in record.findings}
        assert told["beyond the table"].value == pytest.approx(told["angle error"].value, abs=0.1)
        assert told["encoder's own harmonics"].sure == "cannot be told"
        assert await table_of(s) == POWER_ON


async def test_a_better_table_stays_where_that_was_asked_for_also_of_a_shaft_turned_around(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, motor=UNEVEN, encoder={"reversed": True}, full_scale_a=2.1) as s:
        await s.device.registers.write("GCONF", None, None, {"shaft": 1})
        record = await calibrated(s, keep=True)
        found = record.microsteps
        assert record.improved, record.verdict
        assert found is not None
        table = (await s.device.need(MslutTable).read_mslut(0)).registers
        assert list(decode(table).values) == found.wave


async def test_a_stop_in_the_middle_of_the_proof_puts_the_old_table_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, motor=UNEVEN, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(QUICK))
        while run.record.phase != "proof" or await table_of(s) == POWER_ON:
            await s.clock.advance(0.2)
            assert run.running
        await s.device.stop_axes([0], "ramp")
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await table_of(s) == POWER_ON
        assert await s.settings(*NAMES) == before


async def test_a_motor_that_does_not_turn_is_told(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, motor=EVEN) as s:
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        record = await calibrated(s)
        assert record.state == "failed"
        assert "does not turn" in record.message
        assert await table_of(s) == POWER_ON


async def test_a_speed_at_which_the_load_resonates_is_refused(tmp_path: Path) -> None:
    """Fifty times the rotor's inertia: its resonance is at 44 Hz, and four errors a full step come at 50."""
    async with studied(tmp_path, FULL, motor=UNEVEN, load={"inertia_kgm2": 50 * 58e-7}, full_scale_a=2.1) as s:
        record = await calibrated(s)
        assert record.state == "failed"
        assert "turn more slowly" in record.message


async def test_on_a_tmc4361_whose_currents_turn_the_motor(tmp_path: Path) -> None:
    motor = {"detent_torque_nm": 0.0, "viscous_nms": 1e-4, "fourth_harmonic_deg": 3.0}
    start = replace(START_4361, stops=False, closed=None)
    async with bench_4361(start, motor=motor) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        record = await calibrated(s)
        found = record.microsteps
        assert record.improved, record.verdict or record.message
        assert found is not None
        assert amplitude(found.after, 4) < amplitude(found.before, 4) / 5
        assert await table_of(s) == POWER_ON


async def test_the_plan_tells_what_it_does_and_what_is_missing(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL) as s:
        document = s.document({"kind": "microstep_calibration", "turns": 2})
        plan = await KINDS["microstep_calibration"].plan(s.device, 0, document)
        assert plan.missing == []
        assert plan.moves_max == 28
        assert plan.position_to is not None
        assert 2 * 51_200 < plan.position_to < 2.2 * 51_200
        assert plan.registers[-1] == "the microstep table of axis 0 (MSLUT)"
        assert plan.time_s == pytest.approx(30 * 41, rel=0.1)
        assert plan.warnings[-1] == "its time of 900 s ends before the proof: it needs more"


async def test_a_table_that_turns_both_motors_is_told_and_calibrated(tmp_path: Path) -> None:
    async with bench("tmc5072", FULL, motor=UNEVEN, **PLANT) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        plan = await KINDS["microstep_calibration"].plan(s.device, 0, s.document(QUICK))
        assert plan.missing == []
        assert plan.warnings[0].startswith("both motors of this chip")
        assert plan.registers[-1] == "the microstep table of both axes (MSLUT)"
        record = await calibrated(s)
        assert record.improved, record.verdict or record.message
        assert await table_of(s) == POWER_ON
