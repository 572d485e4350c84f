"""What was identified of an axis, as a record tells it: a twin can be made of it.

Figures with units in their names, each with its 95 % interval, null where it cannot be told.
"""

from __future__ import annotations

from pydantic import Field

from ..fitted import Estimate, Ringing
from ..parts import Part


class Identified(Part):
    """Motor and machine. Torques are told with the run current; shares are of the holding torque at that current.

    Null is what cannot be told: `findings` of the record say why.
    """

    microsteps_per_turn: int
    run_scale: int = Field(description="current scale at which all of it holds: CS, of 31")
    hold_torque_nm: float | None = Field(
        default=None, description="holding torque with the run current, as it was told [N m]"
    )
    supply_v: float | None = Field(default=None, description="motor supply, as it was told [V]")
    torque_nm: Estimate | None = Field(
        default=None, description="the same by what was told and by the back-EMF, each with the weight of its interval"
    )
    resonance_hz: Estimate | None = Field(default=None, description="of small swings around the field, without detent")
    damping_ratio: Estimate | None = Field(default=None, description="viscous friction over the critical one")
    friction_share: Estimate | None = Field(default=None, description="Coulomb friction, motor and load")
    detent_share: Estimate | None = Field(default=None, description="amplitude of the detent torque")
    inertia_per_torque_s2: Estimate | None = Field(
        default=None, description="inertia of rotor and load over holding torque [kg m2 / (N m)]"
    )
    inertia_kgm2: Estimate | None = Field(default=None, description="of rotor and load; needs torque_nm")
    viscous_nms: Estimate | None = None
    friction_nm: Estimate | None = None
    detent_torque_nm: Estimate | None = None
    resistance_ohm: Estimate | None = Field(default=None, description="of one coil; needs supply and current as told")
    inductance_h: Estimate | None = Field(
        default=None, description="of one coil, as it is at speed with the run current"
    )
    back_emf_v_s_rad: Estimate | None = Field(default=None, description="peak of one coil, of the shaft's speed")
    backlash_microsteps: Estimate | None = Field(default=None, description="before the encoder")
    encoder_lines: int | None = Field(default=None, description="of a turn, four counts each")
    encoder_counts_per_turn: Estimate | None = Field(default=None, description="as they were measured")
    eccentricity_deg: Estimate | None = Field(default=None, description="of encoder or coupling [deg of the shaft]")
    ringing: Ringing | None = None
