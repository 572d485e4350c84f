"""Profiles that say something of every kind: tables, fields, signed numbers, parameters."""

from __future__ import annotations

from app.profiles.document import AxisPart, MslutPart, ParameterPart, ProfileDocument, RegisterPart, Tables
from app.registers.tmcl.modules import MODULES


def profile_of(model: str, name: str = "tuned", note: str = "") -> ProfileDocument:
    """A small profile of `model`: TMC428, TMC5160, TMC4361 or PD42-1241."""
    return ProfileDocument(
        name=name,
        note=note,
        model=model,
        clock_hz=16e6,
        device="Bench 1",
        captured_unix_s=1.8e9,
        axes=[AxisPart(name="x", full_steps_per_rev=200)],
        registers=REGISTERS.get(model, []),
        parameters=PARAMETERS if model in MODULES else [],
        tables=TABLES.get(model, Tables()),
    )


REGISTERS = {
    "tmc428": [
        RegisterPart(name="stepper_motor_global_parameter_register", fields={"LSMD": 2, "clk2_div": 7}),
        RegisterPart(name="v_max", axis=1, value=1500),
        RegisterPart(name="a_max", axis=1, value=500),
        RegisterPart(name="lp_ref_conf_rm", axis=1, fields={"rm": "RAMP_MODE", "SOFT_STOP": 1}),
        RegisterPart(name="pulse_div_ramp_div_usrs", axis=1, fields={"pulse_div": 3, "ramp_div": 7, "usrs": 5}),
    ],
    "tmc5160": [
        RegisterPart(name="CHOPCONF", axis=0, fields={"toff": 3, "hstrt": 4, "hend": 2, "tbl": 2, "mres": 2}),
        RegisterPart(name="IHOLD_IRUN", axis=0, fields={"IHOLD": 5, "IRUN": 20, "IHOLDDELAY": 7}),
        RegisterPart(name="AMAX", axis=0, value=500),
        RegisterPart(name="VMAX", axis=0, value=200_000),
    ],
    "tmc4361": [
        RegisterPart(name="VMAX", axis=0, value=256 * 60_000),
        RegisterPart(name="AMAX", axis=0, value=800_000),
        RegisterPart(name="VIRT_STOP_LEFT", axis=0, value=-5000),
    ],
}
PARAMETERS = [
    ParameterPart(name="maximum_current", value=100),
    ParameterPart(name="maximum_positioning_speed", value=40_000),
    ParameterPart(name="stallguard2_threshold", value=-12),
]
TABLES = {
    "tmc428": Tables(microstep=list(range(64)), driver_chain=[0x0101] * 31 + [0x2020]),
    "tmc5160": Tables(
        mslut=[MslutPart(axis=0, words=[0xAAAA_B554] * 8, select=0xFFFF_8056, start=0x00F7_0000)],
    ),
}
