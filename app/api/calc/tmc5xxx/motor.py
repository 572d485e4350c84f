"""Coil currents and chopper settings of the TMC5xxx: from the contract to the calculators and back."""

from __future__ import annotations

import math

from ....calc.families import CHIPS
from ....calc.tmc5xxx.chopper import Winding
from ....calc.tmc5xxx.chopper_hints import hints
from ....calc.tmc5xxx.chopper_notes import ChopperChoices
from ....calc.tmc5xxx.coil import CurrentStage, Setting, error, nearest_hold, warnings
from ....calc.units import tmc5xxx_times as times
from ....errors import UsageError
from ...devices.views import calculating
from ..sixpoint_schemas import (
    Chopper,
    ChopperFigure,
    ChopperResult,
    ChopperSetting,
    CoilCurrent,
    CoilCurrentResult,
    CurrentSetting,
    FieldSetting,
    HoldDelay,
)

NEAREST = 8
"""How many ways to set a current are answered."""


def coil_current(body: CoilCurrent) -> CoilCurrentResult:
    if (body.run_a is None) == (body.irun is None):
        raise UsageError("either a wanted run_a or an irun, and one of them")
    if body.hold_a is not None and body.ihold is not None:
        raise UsageError("either a wanted hold_a or an ihold, not both")
    with calculating():
        stage = CurrentStage(
            body.model, body.sense_resistor_ohm, body.reference_resistor_ohm, body.ain_v, body.current_range
        )
        wanted = None if body.run_a is None else _peak(body, body.run_a)
        stage = stage if wanted is None else stage.for_peak(wanted)
        given = _given_select(body, stage)
        ranked = [] if wanted is None else stage.ranked(wanted, given)
        run = ranked[0] if ranked else stage.setting(body.irun or 0, _default(stage) if given is None else given)
        hold = _hold(body, stage, run)
        delay = _delay(body, run, hold)
    held_peak = None if body.hold_a is None else _peak(body, body.hold_a)
    full = stage.full_scale_a(run.select)
    return CoilCurrentResult(
        full_scale_rms_a=full / math.sqrt(2),
        full_scale_peak_a=full,
        current_range=stage.current_range,
        least_a=full / 32 / (1 if body.measure == "peak" else math.sqrt(2)),
        run=_answer(stage, run, wanted),
        hold=None if hold is None else _answer(stage, hold, held_peak),
        nearest=[_answer(stage, setting, wanted) for setting in ranked[:NEAREST]],
        sense_voltage_v=None if body.sense_resistor_ohm is None else run.peak_a * body.sense_resistor_ohm,
        sense_power_w=stage.sense_power_w(run.peak_a),
        delay=delay,
        settings=_settings(body, stage, run, hold, delay),
        formula=_formula(stage),
        source="DS-TMC5130 11 and 30.2" if stage.internal else stage.chip.source,
        warnings=[*warnings(stage, run, hold), *_of_delay(body, delay)],
    )


def _peak(body: CoilCurrent, amperes: float) -> float:
    return amperes if body.measure == "peak" else amperes * math.sqrt(2)


def _default(stage: CurrentStage) -> int:
    """Where nobody says and nothing is wanted: vsense 0, or all of the scaler."""
    return stage.selects[-1] if stage.chip.scaled else 0


def _given_select(body: CoilCurrent, stage: CurrentStage) -> int | None:
    """The vsense or scaler that was asked for. Raises UsageError for the one that the chip has not."""
    if stage.chip.scaled and body.vsense is not None:
        raise UsageError(f"a {body.model} has no vsense; it has a global_scaler")
    if not stage.chip.scaled and body.global_scaler is not None:
        raise UsageError(f"a {body.model} has no global_scaler; it has vsense")
    select = body.global_scaler if stage.chip.scaled else body.vsense
    if select == 0 and stage.chip.scaled:
        select = stage.selects[-1]
    if select is not None:
        stage.full_scale_a(select)
    return select


def _hold(body: CoilCurrent, stage: CurrentStage, run: Setting) -> Setting | None:
    if body.ihold is not None:
        return stage.setting(body.ihold, run.select)
    if body.hold_a is None:
        return None
    return nearest_hold(stage.settings(run.select), _peak(body, body.hold_a))


def _delay(body: CoilCurrent, run: Setting, hold: Setting | None) -> HoldDelay:
    steps = 0 if hold is None else max(run.scale - hold.scale, 0)
    raw = body.ihold_delay
    if raw is None:
        raw = 0 if body.lowering_s is None else times.hold_delay(body.lowering_s, steps, body.clock_hz)
    elif body.lowering_s is not None:
        raise UsageError("either an ihold_delay or a wanted lowering_s, not both")
    chip = CHIPS[body.model]
    first_free = chip.first_free
    power_down = body.tpowerdown
    if not chip.one_axis and (power_down is not None or body.waiting_s is not None):
        raise UsageError(f"a {body.model} has no TPOWERDOWN; the chips with one axis have")
    if power_down is not None and body.waiting_s is not None:
        raise UsageError("either a tpowerdown or a wanted waiting_s, not both")
    if body.waiting_s is not None:
        power_down = times.power_down(body.waiting_s, body.clock_hz, first_free)
    return HoldDelay(
        ihold_delay=raw,
        step_s=times.hold_delay_s(raw, 1, body.clock_hz),
        steps=steps,
        lowering_s=times.hold_delay_s(raw, steps, body.clock_hz),
        tpowerdown=power_down,
        waiting_s=None if power_down is None else times.power_down_s(power_down, body.clock_hz, first_free),
        standstill_s=times.STANDSTILL_CLOCKS / body.clock_hz if chip.one_axis else 0.0,
    )


def _answer(stage: CurrentStage, setting: Setting, wanted_peak_a: float | None) -> CurrentSetting:
    return CurrentSetting(
        scale=setting.scale,
        vsense=None if stage.chip.scaled else setting.select,
        global_scaler=setting.select % 256 if stage.chip.scaled else None,
        rms_a=setting.rms_a,
        peak_a=setting.peak_a,
        error=error(setting, wanted_peak_a) if wanted_peak_a else None,
    )


def _settings(
    body: CoilCurrent, stage: CurrentStage, run: Setting, hold: Setting | None, delay: HoldDelay
) -> list[FieldSetting]:
    found = [FieldSetting(name="IHOLD_IRUN", field="IRUN", value=run.scale)]
    if hold is not None:
        found.append(FieldSetting(name="IHOLD_IRUN", field="IHOLD", value=hold.scale))
        found.append(FieldSetting(name="IHOLD_IRUN", field="IHOLDDELAY", value=delay.ihold_delay))
    if delay.tpowerdown is not None:
        found.append(FieldSetting(name="TPOWERDOWN", field=None, value=delay.tpowerdown))
    if stage.chip.scaled:
        found.append(FieldSetting(name="GLOBAL_SCALER", field=None, value=run.select % 256))
        if stage.current_range is not None:
            found.append(FieldSetting(name="DRV_CONF", field="CURRENT_RANGE", value=stage.current_range))
        return found
    found.append(FieldSetting(name="CHOPCONF", field="vsense", value=run.select))
    if stage.kind.reference:
        found.append(FieldSetting(name="GCONF", field="internal_Rsense", value=int(stage.internal)))
        found.append(FieldSetting(name="GCONF", field="I_scale_analog", value=int(stage.ain_v is not None)))
    return found


def _formula(stage: CurrentStage) -> str:
    if stage.internal:
        return "peak = 3000 * 5 V / (R_ref + 1 kOhm) * (CS + 1) / 32, and 0.55 of that with vsense = 1"
    if stage.ranged:
        return "peak = GLOBAL_SCALER / 256 * (CS + 1) / 32 * K(CURRENT_RANGE) / R_ref; RMS = peak / sqrt(2)"
    if stage.chip.scaled:
        return "peak = GLOBAL_SCALER / 256 * (CS + 1) / 32 * 0.325 V / R_sense; RMS = peak / sqrt(2)"
    low, high = stage.chip.full_scale_v
    ain = " * V_AIN / 2.5 V" if stage.ain_v is not None else ""
    return (
        f"peak = (CS + 1) / 32 * V_FS{ain} / (R_sense + 20 mOhm), V_FS = {low:g} V (vsense 0) or {high:g} V (1); "
        "RMS = peak / sqrt(2)"
    )


def _of_delay(body: CoilCurrent, delay: HoldDelay) -> list[str]:
    if CHIPS[body.model].sheet.stealth == "tuned" and delay.tpowerdown is not None and delay.tpowerdown < 2:
        return ["TPOWERDOWN below 2 leaves StealthChop no time to tune itself (DS-TMC5160 6.2)"]
    return []


def chopper(body: Chopper) -> ChopperResult:
    with calculating():
        winding = Winding(
            resistance_ohm=body.resistance_ohm,
            inductance_h=body.inductance_h,
            current_a=body.current_a,
            supply_v=body.supply_v,
            clock_hz=body.clock_hz,
            irun=body.irun,
            holding_torque_nm=body.holding_torque_nm,
            rated_current_a=body.rated_current_a,
            full_steps_per_rev=body.full_steps_per_rev,
        )
        wishes = ChopperChoices(
            chopper_hz=body.chopper_hz,
            tbl=body.tbl,
            toff=body.toff,
            hysteresis=body.hysteresis,
            pwm_freq=body.pwm_freq,
            automatic=body.automatic,
            microsteps=body.microsteps_per_full_step,
        )
        found = hints(body.model, winding, wishes)
    return ChopperResult(
        settings=[ChopperSetting.model_validate(setting) for setting in found.settings],
        figures=[ChopperFigure.model_validate(figure) for figure in found.figures],
        warnings=found.warnings,
    )
