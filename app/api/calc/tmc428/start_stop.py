"""v_min as a start-stop speed over REST: its shapes, and the calculator behind them, app/calc/tmc428/start_stop.py."""

from __future__ import annotations

from pydantic import Field

from ....calc.motor_torque import StepperMotor
from ....calc.tmc428 import start_stop as calculator
from ...devices.views import calculating
from ...schemas import Answer, Body, Number
from ..ramps import exact_parameters
from ..sramp_schemas import RampMotor


class StartStop(Body):
    """A motor, and the ramp whose v_min is judged."""

    motor: RampMotor = Field(description="resistance, inductance and supply do not enter")
    parameters: dict[str, Number | str] = Field(description="of the ramp, as POST /calc/ramp takes them")
    distance: Number = Field(description="of the move whose times are told [microsteps]")


class StartStopResult(Answer):
    limit_pps: float = Field(description="the motor may just be stopped dead from here, or started to it")
    limit_chip: int = Field(description="the highest v_min at or below that")
    suggested_chip: int = Field(description="half of it, 1 at least")
    v_min_pps: float
    share: float | None = Field(description="of the limit; null where that is 0")
    keeps_steps: bool
    duration_s: float | None = Field(description="of the move; null where it never ends or does not position")
    duration_least_s: float | None = Field(description="with v_min 1")
    duration_suggested_s: float | None
    warnings: list[str]


def start_stop(body: StartStop) -> StartStopResult:
    with calculating():
        motor = StepperMotor(**body.motor.model_dump())
        found = calculator.start_stop(motor, *exact_parameters(body.parameters, body.distance))
    return StartStopResult.model_validate(found)
