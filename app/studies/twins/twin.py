"""An emulated twin of an axis, and one setting tried on it.

A twin is made of what a study may know: the axis's registers as a profile, its settings, its clock, and the motor as
the study's document tells it. Never of the options of an emulated device: those are its ground truth. Each setting has
a twin of its own, so what came of it depends on nothing that was tried before, or elsewhere.
"""

from __future__ import annotations

import asyncio
import math
from typing import Any

from pydantic.fields import FieldInfo

from ...clock import Clock, VirtualClock
from ...devices.core.config import DeviceConfig
from ...devices.families import family_of
from ...devices.manager import DeviceManager
from ...emulators.build import build_emulator, options_of
from ...errors import BenchError, WrongState
from ...links.emulator import EmulatorPort
from ...links.port import FramePort
from ...links.registry import Link
from ...procedures.procedure import Failed
from ...profiles.apply import Transaction
from ...profiles.document import parse
from ..document import StudyDocument, TwinMotor
from ..driver_faults import DriverFault
from ..kinds import KINDS
from ..record import Figures, Trial
from ..search import Asked
from .executor import TwinJob

BEAT_S = 0.05
LONGEST_S = 3_000.0
"""One setting takes no longer [s of the twin's own clock]."""
SQRT_2 = math.sqrt(2)


def run_job(job: TwinJob) -> dict[str, Any]:
    """The trial that came of it, as JSON: a failed one says why. Blocks."""
    try:
        trial = asyncio.run(_live(job))
    except (BenchError, Failed, DriverFault, ValueError) as error:
        setting = dict(job.values)
        trial = Trial(
            number=job.number, setting=setting, registers=[], state="failed", figures=Figures(), why=str(error)
        )
    return trial.model_dump(mode="json")


async def _live(job: TwinJob) -> Trial:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": _port}, clock)
    document, motor = StudyDocument.model_validate(job.document), TwinMotor.model_validate(job.motor)
    on_twin = KINDS[document.study.kind].on_twin
    if on_twin is None:
        raise WrongState(f"a study of the kind {document.study.kind} tries nothing on a twin", "")
    try:
        link = {"kind": "emulator", **emulator_options(job, motor)}
        device = await manager.add(DeviceConfig("twin", job.model, link, job.clock_hz, job.axes))
        if device.problem is not None:
            raise device.problem
        await Transaction(device, parse(job.profile)).run()
        trying = asyncio.create_task(
            on_twin.try_one(device, job.axis, clock, document, Asked(job.number, dict(job.values)))
        )
        while not trying.done():
            if clock.now() > LONGEST_S:
                trying.cancel()
                raise WrongState(f"the twin was not ready after {LONGEST_S:g} s of its own", "try a shorter move")
            await clock.advance(BEAT_S)
        return await trying
    finally:
        closing = asyncio.create_task(manager.close())
        while not closing.done():  # letting go of a device may wait for its motor, on the clock
            await clock.advance(BEAT_S)
        await closing


def emulator_options(job: TwinJob, motor: TwinMotor) -> dict[str, Any]:
    """What the twin's emulator is made with, of what its model can be told."""
    known = options_of(job.model).model_fields
    full_a = family_of(job.model).full_scale_a(job.model, job.axes[job.axis].limits)
    options: dict[str, Any] = {
        "motor": {
            "holding_torque_nm": motor.holding_torque_nm,
            "rated_current_a": motor.rated_current_a,
            "resistance_ohm": motor.resistance_ohm,
            "inductance_h": motor.inductance_h,
            "rotor_inertia_kgm2": motor.rotor_inertia_kgm2,
            "rotor_teeth": job.axes[job.axis].full_steps_per_rev // 4,
            "friction_nm": motor.friction_nm,
            "viscous_nms": motor.viscous_nms,
            "detent_torque_nm": motor.detent_torque_nm,
        },
        "load": {"inertia_kgm2": motor.load_inertia_kgm2, "friction_nm": motor.load_friction_nm},
        "supply_v": motor.supply_v,
        "clock_hz": job.clock_hz,
        "encoder": _encoder(known.get("encoder"), motor),
        "full_scale_a": None if full_a is None else full_a * SQRT_2,
    }
    return {name: value for name, value in options.items() if name in known and value is not None}


def _encoder(known: FieldInfo | None, motor: TwinMotor) -> dict[str, Any]:
    """The encoder on its shaft; play only where the emulator's encoder can have it."""
    encoder: dict[str, Any] = {"lines": motor.counts_per_turn // 4}
    if motor.backlash_deg and known is not None and "errors" in getattr(known.annotation, "model_fields", ()):
        encoder["errors"] = {"backlash_deg": motor.backlash_deg}
    return encoder


def _port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {name: value for name, value in link.items() if name != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))
