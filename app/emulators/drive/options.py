"""What a drive is made of: motor, load, stage, encoders. SI units, full steps where it says so."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from ...deferred import DeferredModel
from ...form_hints import REST_ONLY, form
from .batch import motor_of_batch
from .kernel import TICK_CLOCKS

MOST_STEPS_A_TICK = 16

LineError = Annotated[float, Field(strict=True, ge=0, le=0.1)]
"""Up to a tenth of a line: from a sixth on, counts would run back."""
FullSteps = Annotated[float, Field(strict=True, ge=-1e7, le=1e7, allow_inf_nan=False)]


SupplyResistance = Annotated[
    float,
    Field(
        strict=True,
        ge=0,
        le=20,
        allow_inf_nan=False,
        description="of supply, cable and connectors: what the coils draw lowers the voltage at the driver by so much "
        "[ohm]; 0: the supply is stiff",
        json_schema_extra=REST_ONLY,
    ),
]


class _Closed(DeferredModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class LoadValueOptions(_Closed):
    """What StallGuard2 makes of a motor, in counts of its value; StallGuard4 of the same.

    That it hangs on motor and speed, and that the tolerances of poles are gone in a mean of four, is of DS-TMC5160 14
    and its COOLCONF.sfilt; that one motor tells 14 to 74 at a constant speed is of FLUIDNC-470. Figures and the growth
    of the noise with speed are INFERRED.
    """

    full_scale: Annotated[float, Field(strict=True, ge=50, le=2000)] = Field(
        default=500.0, description="without load, at high speed and SGT 0", json_schema_extra=REST_ONLY
    )
    half_speed_fullsteps_per_s: Annotated[float, Field(strict=True, ge=1, le=1e5)] = Field(
        default=100.0, description="speed at which the unloaded value is half of that", json_schema_extra=REST_ONLY
    )
    noise: Annotated[float, Field(strict=True, ge=0, le=200)] = Field(
        default=10.0, description="of each value, +-", json_schema_extra=REST_ONLY
    )
    noise_with_speed: Annotated[float, Field(strict=True, ge=0, le=1000)] = Field(
        default=0.0,
        description="what each 1000 full steps a second add to the noise, +-",
        json_schema_extra=REST_ONLY,
    )
    pole_tolerance: Annotated[float, Field(strict=True, ge=0, le=500)] = Field(
        default=0.0,
        description="how far the poles, unlike each other, move the values of four full steps, +-: a mean of four has "
        "nothing of it",
        json_schema_extra=REST_ONLY,
    )


class MotorOptions(_Closed):
    """A two-phase hybrid stepper. The default is like a 17HS15-1504S: 40 mm long, 1.5 A, 0.45 N m.

    Kt, torque constant of one phase [N m/A peak] and back-EMF constant [V s/rad peak], is TH / (sqrt(2) I_r).
    In what a real one is uneven (ZABER-MICROSTEPS, DS-TMC428 12.3, EP-0977350) is 0 at first; how much is usual is
    INFERRED: up to 5 %, 3 and 4 degrees.
    """

    rotor_teeth: Annotated[int, Field(strict=True, ge=1, le=200)] = Field(
        default=50, description="50: 1.8 deg a full step", json_schema_extra=REST_ONLY
    )
    resistance_ohm: Annotated[float, Field(strict=True, ge=0.05, le=200)] = Field(
        default=2.3, description="of one coil", json_schema_extra=REST_ONLY
    )
    inductance_h: Annotated[float, Field(strict=True, ge=1e-4, le=0.5)] = Field(
        default=4.4e-3, description="of one coil", json_schema_extra=REST_ONLY
    )
    holding_torque_nm: Annotated[float, Field(strict=True, ge=1e-4, le=50)] = Field(
        default=0.45, title="Holding torque", description="both coils at rated current [N m]"
    )
    rated_current_a: Annotated[float, Field(strict=True, ge=0.05, le=20)] = Field(
        default=1.5, title="Rated current", description="in both coils, at the holding torque [A]"
    )
    rotor_inertia_kgm2: Annotated[float, Field(strict=True, ge=1e-8, le=1e-2)] = Field(
        default=58e-7, json_schema_extra=REST_ONLY
    )
    detent_torque_nm: Annotated[float, Field(strict=True, ge=-5, le=5)] = Field(
        default=0.02,
        description="amplitude Td of -Td sin(4e); either sign, 0 for an ideal motor. 4.4 % of the holding torque",
        json_schema_extra=REST_ONLY,
    )
    viscous_nms: Annotated[float, Field(strict=True, ge=0, le=1)] = Field(
        default=1e-3, description="viscous friction B [N m s]", json_schema_extra=REST_ONLY
    )
    friction_nm: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.005, description="Coulomb friction Tc, turning", json_schema_extra=REST_ONLY
    )
    stiction_ratio: Annotated[float, Field(strict=True, ge=1, le=3)] = Field(
        default=1.2, description="friction at rest as a multiple of that when turning", json_schema_extra=REST_ONLY
    )

    phase_unbalance: Annotated[float, Field(strict=True, ge=-0.2, le=0.2)] = Field(
        default=0.0,
        description="torque of phase A less that of B, as a share of their mean: windings, poles, sense resistors",
        json_schema_extra=REST_ONLY,
    )
    quadrature_error_deg: Annotated[float, Field(strict=True, ge=-10, le=10)] = Field(
        default=0.0,
        description="how much further than a right angle the flux of both phases is apart [deg electrical]",
        json_schema_extra=REST_ONLY,
    )
    fourth_harmonic_deg: Annotated[float, Field(strict=True, ge=-10, le=10)] = Field(
        default=0.0,
        description="amplitude of the error that comes once a full step, of a third harmonic in the flux, for which "
        "the current does not matter [deg electrical]",
        json_schema_extra=REST_ONLY,
    )

    open_phase: Literal["none", "a", "b"] = Field(
        default="none",
        description="the coil that no current comes through: a broken wire, a solder joint; DRV_STATUS tells it",
        json_schema_extra=REST_ONLY,
    )

    load_value: LoadValueOptions = Field(default=LoadValueOptions(), json_schema_extra=REST_ONLY)

    batch_seed: Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)] | None = Field(
        default=None,
        description="one motor of a batch: its figures are drawn around those named here, within tolerances, and told "
        "in the emulator's state; the same seed is the same motor; null: exactly as named",
        json_schema_extra=REST_ONLY,
    )

    @property
    def torque_constant(self) -> float:
        """Kt [N m/A] = [V s/rad], peak values."""
        return self.holding_torque_nm / (math.sqrt(2) * self.rated_current_a)


class CouplingOptions(_Closed):
    """What gives between rotor and load, as a belt or a screw does: a spring with damping, and play.

    At the motor's shaft: a belt of stiffness c [N/m] on a pulley of radius r has c r^2, a screw of lead p whose axial
    stiffness is c has c (p / 2 pi)^2: 1e5 N/m at 5 mm are 2.5 N m/rad, 1e7 N/m at 8 mm a turn 16. That a belt gives
    about in proportion to its pull, by its length, is of GT2-STIFFNESS; what is usual of damping and play is not known
    here.
    """

    stiffness_nm_rad: Annotated[float, Field(strict=True, ge=0.01, le=1e5, allow_inf_nan=False)] = Field(
        description="torque for each radian between rotor and load [N m/rad]"
    )
    damping_nms: Annotated[float, Field(strict=True, ge=0, le=100, allow_inf_nan=False)] = Field(
        default=0.0, description="torque for each rad/s between them [N m s]"
    )
    backlash_fullsteps: Annotated[float, Field(strict=True, ge=0, le=100, allow_inf_nan=False)] = Field(
        default=0.0, description="so far rotor and load turn against each other before the spring takes hold"
    )


class LoadOptions(_Closed):
    """What hangs on the shaft from the start; `Plant` changes torque and friction while it runs."""

    torque_nm: Annotated[float, Field(strict=True, ge=-50, le=50)] = Field(
        default=0.0,
        title="Load torque",
        description="constant, like a weight: positive ones pull the shaft to negative positions [N m]",
    )
    friction_nm: Annotated[float, Field(strict=True, ge=0, le=50)] = Field(
        default=0.0, title="Load friction", description="Coulomb friction of the load [N m]"
    )
    inertia_kgm2: Annotated[float, Field(strict=True, ge=0, le=1)] = Field(
        default=0.0, title="Load inertia", description="added to the rotor's [kg m²]"
    )
    coupling: CouplingOptions | None = Field(
        default=None,
        description="what gives between rotor and load: torque, friction, inertia and the stage's switches are beyond "
        "it, encoders on the motor's shaft; null: nothing gives",
        json_schema_extra=REST_ONLY,
    )

    @model_validator(mode="after")
    def _something_to_swing(self) -> LoadOptions:
        if self.coupling is not None and self.inertia_kgm2 < 1e-9:
            raise ValueError(f"a load behind a coupling needs an inertia_kgm2 of 1e-9 or more, not {self.inertia_kgm2}")
        return self


class StageSwitches(_Closed):
    """A stage with three switches, placed in full steps of the rotor; where told, it ends hard.

    The default is 300 mm of travel at 200 full steps and 8 mm a turn, started in the middle.
    """

    left_at_fullsteps: FullSteps = Field(
        default=-3750.0, title="Left", description="left switch is active here and to the left [full steps]"
    )
    right_at_fullsteps: FullSteps = Field(
        default=3750.0,
        title="Right",
        description="right switch is active here and to the right [full steps]",
        json_schema_extra=form(above="left_at_fullsteps"),
    )
    home_from_fullsteps: FullSteps = Field(
        default=-3500.0,
        title="Home from",
        description="left end of the home switch [full steps]",
        json_schema_extra=form(where={"capabilities": ["home_switch"]}),
    )
    home_to_fullsteps: FullSteps = Field(
        default=-3400.0,
        title="Home to",
        description="right end of the home switch [full steps]",
        json_schema_extra=form(where={"capabilities": ["home_switch"]}, at_least="home_from_fullsteps"),
    )

    left_end_fullsteps: FullSteps | None = Field(
        default=None,
        description="the carriage can go no further to the left than here [full steps]; null: no hard end",
        json_schema_extra=REST_ONLY,
    )
    right_end_fullsteps: FullSteps | None = Field(
        default=None,
        description="the carriage can go no further to the right than here [full steps]; null: no hard end",
        json_schema_extra=REST_ONLY,
    )

    backlash_fullsteps: Annotated[float, Field(strict=True, ge=0, le=100, allow_inf_nan=False)] = Field(
        default=0.0,
        description="a switch is released so far behind where it is pressed: play of its lever, its mount [full steps]",
        json_schema_extra=REST_ONLY,
    )

    @model_validator(mode="after")
    def _in_order(self) -> StageSwitches:
        ends = (self.left_end_fullsteps, self.right_end_fullsteps)
        if ends[0] is not None and ends[1] is not None and ends[0] >= ends[1]:
            raise ValueError("left_end_fullsteps does not lie left of right_end_fullsteps")
        if self.home_from_fullsteps > self.home_to_fullsteps:
            raise ValueError("home_from_fullsteps lies right of home_to_fullsteps")
        if self.left_at_fullsteps >= self.right_at_fullsteps:
            raise ValueError("left_at_fullsteps does not lie left of right_at_fullsteps")
        return self


class EncoderErrors(_Closed):
    """How far an encoder's graduation is off: amplitudes and phases.

    Eccentricity makes what comes once a turn, a bent or oval disk what comes twice; unequal A and B what comes once a
    line, between its counts (sub-divisional error). A coupling with play makes a difference between both ways.
    """

    eccentricity_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.0,
        title="Eccentricity",
        description="once a turn [deg of the shaft]",
        json_schema_extra=form(unit="°"),
    )
    eccentricity_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=0.0, json_schema_extra=REST_ONLY
    )
    second_harmonic_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.0, description="twice a turn [deg of the shaft]", json_schema_extra=REST_ONLY
    )
    second_harmonic_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=0.0, json_schema_extra=REST_ONLY
    )
    line_error: LineError = Field(default=0.0, description="once a line [lines]", json_schema_extra=REST_ONLY)
    line_error_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=0.0, json_schema_extra=REST_ONLY
    )
    backlash_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.0,
        description="play between the shaft and its encoder: the shaft turns so far back before the encoder follows "
        "[deg of the shaft]",
        json_schema_extra=REST_ONLY,
    )


class EncoderOptions(_Closed):
    """The magnet on the shaft, and an encoder with A and B lines (and N once a turn) at its other end.

    The internal one sees theta + e1 sin(theta + p1) + e2 sin(2 theta + p2), the external one the same with figures of
    its own, and an error once a line besides; cut into whole counts.
    """

    internal_counts: Annotated[int, Field(strict=True, ge=4, le=1 << 20)] = Field(
        default=1024, description="positions a turn", json_schema_extra=REST_ONLY
    )
    internal_zero_fullsteps: FullSteps = Field(
        default=37.3, description="rotor place at which the magnet reads 0", json_schema_extra=REST_ONLY
    )
    eccentricity_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.25,
        title="Eccentricity",
        description="internal: amplitude e1 of the once-a-turn error [deg of the shaft]",
        json_schema_extra=form(unit="°"),
    )
    eccentricity_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=40.0, json_schema_extra=REST_ONLY
    )
    second_harmonic_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = Field(
        default=0.1,
        description="internal: amplitude e2 of the twice-a-turn error [deg of the shaft]",
        json_schema_extra=REST_ONLY,
    )
    second_harmonic_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=110.0, json_schema_extra=REST_ONLY
    )
    external_lines: Annotated[int, Field(strict=True, ge=1, le=1 << 20)] = Field(
        default=1000, title="External lines", description="of the external encoder: four counts a line"
    )
    external_reversed: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="A and B are swapped", json_schema_extra=REST_ONLY
    )
    external_errors: EncoderErrors = Field(default=EncoderErrors(), json_schema_extra=REST_ONLY)


class DriveOptions(_Closed):
    """Everything that a drive is made with. `motor` is the one that was drawn where a batch was asked for."""

    motor: MotorOptions = MotorOptions()
    load: LoadOptions = LoadOptions()
    stage: StageSwitches = StageSwitches()
    encoders: EncoderOptions = EncoderOptions()
    clock_hz: Annotated[float, Field(strict=True, ge=4e6, le=32e6, allow_inf_nan=False)] = Field(
        default=16e6, description="fCLK, which all register units hang on [Hz]"
    )
    supply_v: Annotated[float, Field(strict=True, ge=0, le=60)] = Field(default=24.0, description="motor supply")
    supply_resistance_ohm: SupplyResistance = 0.0
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30)] = Field(
        default=4.2,
        description="peak coil current at current scale 31 and GLOBALSCALER 0, i.e. TMCL AP 6 = 255: "
        "the PD42-1241's 3 A RMS, 4.2 A peak (FM-PD42-1241 1.2)",
    )
    regulator_s: Annotated[float, Field(strict=True, ge=2e-5, le=1e-3)] = Field(
        default=1e-4, description="time constant of the chopper, taken as a first-order lag (50 to 200 us)"
    )
    ripple: Annotated[bool, Field(strict=True)] = Field(
        default=False,
        description="SpreadCycle bends the coils' currents by its blank time, slow decay and hysteresis; without it "
        "they are what the table says",
    )
    start_fullsteps: FullSteps = Field(default=0.0, description="where the rotor stands at first")
    seed: Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)] = Field(default=5160, description="of the noise")
    rigid: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="no physics: the shaft is where the field is, and nothing loads it"
    )
    n_line: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="the external encoder's N line is wired: ENCMODE acts on it"
    )

    @field_validator("motor")
    @classmethod
    def _of_its_batch(cls, motor: MotorOptions) -> MotorOptions:
        return motor if motor.batch_seed is None else motor_of_batch(motor, motor.batch_seed)

    @property
    def inertia_kgm2(self) -> float:
        """Rotor and load."""
        return self.motor.rotor_inertia_kgm2 + self.load.inertia_kgm2

    @property
    def rotor_side_kgm2(self) -> float:
        """What turns as one piece with the rotor: the load does, but behind a coupling."""
        return self.inertia_kgm2 if self.load.coupling is None else self.motor.rotor_inertia_kgm2

    @property
    def steps_a_tick(self) -> int:
        """Physics steps in a tick of 256 clocks."""
        return self.steps_in(TICK_CLOCKS)

    def steps_in(self, clocks: int) -> int:
        """Physics steps in a tick of so many clocks.

        Each is at most a fifth of the regulator's time constant, and a twentieth of a radian of the fastest
        oscillation that the full current can bring about, or the coupling to the load; the damping of that takes less
        than half of a speed in a step.
        """
        motor = self.motor
        stiffness = motor.rotor_teeth * (motor.torque_constant * self.full_scale_a + 4 * abs(motor.detent_torque_nm))
        longest_s = min(self.regulator_s / 5, math.sqrt(self.rotor_side_kgm2 / stiffness) / 20)
        coupling = self.load.coupling
        if coupling is not None:
            yielding = 1 / motor.rotor_inertia_kgm2 + 1 / self.load.inertia_kgm2
            longest_s = min(
                longest_s,
                1 / math.sqrt(coupling.stiffness_nm_rad * yielding) / 20,
                0.5 / max(coupling.damping_nms * yielding, 1.0),
            )
        return math.ceil(clocks / self.clock_hz / longest_s)

    @model_validator(mode="after")
    def _can_be_computed(self) -> DriveOptions:
        if self.steps_a_tick > MOST_STEPS_A_TICK:
            raise ValueError(
                f"this motor would need {self.steps_a_tick} physics steps every 16 us, at most {MOST_STEPS_A_TICK} "
                "are made: less current or torque, more inertia, or a coupling that gives more"
            )
        return self
