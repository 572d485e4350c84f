"""Applies patches to an emulated chip and its plant, and describes both as its emulator state."""

from __future__ import annotations

from typing import Literal

from ..core.base import Times
from ..drive.documents import ChipFaultsState, StageState, check_stage
from ..drive.options import StageSwitches
from . import layout as c
from .dcstep import dcstep_acts
from .driver import STATUS_FLAGS
from .feedback.layout import SHAFT_FULLSTEPS
from .options import Tmc4361Patch
from .registers import Chip
from .state import (
    DcStepState,
    DriverBehindState,
    LevelState,
    PinsState,
    RampState,
    SpiOutputState,
    StepOutputState,
    SwitchesState,
    Tmc4361State,
)

_PLACES = {
    "left_at_fullsteps": c.LEFT_AT,
    "right_at_fullsteps": c.RIGHT_AT,
    "home_from_fullsteps": c.HOME_LOW,
    "home_to_fullsteps": c.HOME_HIGH,
}
_KINDS: dict[int, Literal["rest", "ramp", "to standstill", "stop", "freeze", "step input"]] = {
    c.IDLING: "rest",
    c.MOVING: "ramp",
    c.TO_ZERO: "to standstill",
    c.STOPPING: "stop",
    c.FREEZING: "freeze",
    c.EXTERNAL: "step input",
}


def place(chip: Chip, stage: StageSwitches) -> None:
    """Set up the stage's switches."""
    for name, cell in _PLACES.items():
        chip.f[cell] = getattr(stage, name)


def check(chip: Chip, wanted: Tmc4361Patch) -> None:
    """Raises OutOfRange where switches would change places."""
    check_stage({name: float(chip.f[cell]) for name, cell in _PLACES.items()}, wanted.stage)


def change(chip: Chip, wanted: Tmc4361Patch, clock_hz: float) -> None:
    """Everything that is not the feedback unit's; the stage has been checked."""
    for name, cell in _PLACES.items():
        where = getattr(wanted.stage, name)
        if where is not None:
            chip.f[cell] = where
    for pin, forced in (
        (c.PIN_STOPL, wanted.switches.left),
        (c.PIN_STOPR, wanted.switches.right),
        (c.PIN_HOME, wanted.switches.home),
        (c.PIN_FREEZE, wanted.pins.freeze),
        (c.PIN_START, wanted.pins.start),
    ):
        if forced == "auto":
            chip.forced.pop(pin, None)
        elif forced is not None:
            chip.forced[pin] = forced
    if wanted.step_dir is not None:
        chip.s[c.EXT_LEFT] += wanted.step_dir.pulses
        chip.f[c.EXT_RATE] = wanted.step_dir.rate_hz * c.TICK_CLOCKS / clock_hz
    if wanted.listen is not None:
        chip.feedback.listen(int(chip.s[c.CLOCK]), wanted.listen.clocks, clock_hz / wanted.listen.rate_hz)
    # the shaft may have been turned by hand, and the switches look at it at once
    chip.feedback.fb[SHAFT_FULLSTEPS] = chip.feedback.plant_state.rotor_fullsteps
    chip.hold_pins()


def _driver(chip: Chip) -> DriverBehindState | None:
    driver, kind = chip.feedback.driver, chip.feedback.options.driver
    if driver is None or kind == "wired":
        return None
    status, flags = driver.drive.read("DRV_STATUS"), driver.flags
    return DriverBehindState(
        kind=kind,
        follows="currents" if driver.takes_currents else "steps",
        bridges=driver.drive.plant_state.bridges,
        current_scale=status >> 16 & 31,
        load=status & 0x3FF,
        flags=[name for at, name in enumerate(STATUS_FLAGS) if flags >> at & 1],
    )


def describe(chip: Chip, faults: ChipFaultsState, times: Times, clock_hz: float) -> Tmc4361State:
    """The chip and its bench as the API tells them."""
    r, s, f = chip.r, chip.s, chip.f
    behind = chip.feedback.describe()

    def level(pin: int) -> LevelState:
        return LevelState(active=bool(int(s[c.INPUTS]) & pin), forced=chip.forced.get(pin))

    return Tmc4361State(
        model="tmc4361",
        **times,
        clock_hz=clock_hz,
        motor=behind.motor,
        load_torque_nm=behind.load_torque_nm,
        blocked=behind.blocked,
        friction=behind.friction_nm,
        inertia=behind.inertia_kgm2,
        supply_v=behind.supply_v,
        stage=StageState(
            **{name: float(f[cell]) for name, cell in _PLACES.items()},
            position_fullsteps=behind.truth.rotor_fullsteps,
        ),
        switches=SwitchesState(left=level(c.PIN_STOPL), right=level(c.PIN_STOPR), home=level(c.PIN_HOME)),
        pins=PinsState(
            start=level(c.PIN_START),
            freeze=level(c.PIN_FREEZE),
            start_out=bool(s[c.START_OUT] > s[c.TICK]),
            intr=chip.intr,
            target_reached=chip.target_reached,
            step=chip.step_level,
            direction=chip.direction_level,
            standby=chip.standby_level,
            clock_out_hz=chip.clock_out_hz(clock_hz),
        ),
        encoder=behind.encoder,
        encoder_output=behind.encoder_output,
        pwm=behind.pwm,
        ramp=RampState(
            kind=_KINDS[int(s[c.KIND])],
            velocity_pps=float(f[c.V]),
            acceleration_pps2=float(f[c.A]),
            position=int(s[c.X]) + float(f[c.P]) - int(s[c.STEPPED]),
            starts=int(s[c.STARTED]),
            frozen=bool(s[c.FROZEN]),
            standby=bool(s[c.STANDBY]),
            clocks_gated=bool(s[c.GATED]),
        ),
        dcstep=DcStepState(
            enabled=bool(dcstep_acts(r, f)),
            step_ready=int(s[c.DC_WAIT]) == 0,
            waited_s=int(s[c.DC_WAIT]) * c.TICK_CLOCKS / clock_hz,
        ),
        step_output=StepOutputState(
            steps_sent=int(s[c.STEPS]),
            steps_merged=int(s[c.TOO_FAST]),
            steps_held=int(s[c.HELD]),
            direction_changes=int(s[c.TURNS]),
            pulse_clocks=(int(r[c.STP_LENGTH]) & 0xFFFF) + 1,
            microsteps_256=int(s[c.FIELD]),
        ),
        spi_output=SpiOutputState(form=sent.form, datagrams=list(sent.datagrams)) if (sent := chip.spi_sent) else None,
        driver_words=chip.driver_words,
        driver=_driver(chip),
        faults=faults,
        truth=behind.truth,
    )
