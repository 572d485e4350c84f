"""The twin that a study tries first where its document leaves that open: made of what was identified of the axis.

What could not be told is not claimed: without an inertia there is none, nor without the amperes that its torque takes.
"""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError

from ...devices.core.axis_limits import full_scale_figures
from ...devices.core.device import Device
from ...devices.families import family_of
from ...html_report import moment
from ..document import AS_IDENTIFIED, FastestMove, Identification, LeastCurrent, StudyDocument, Twin, TwinMotor
from ..record import StudyRecord

WORDS = {
    "holding_torque_nm": "torque",
    "rotor_inertia_kgm2": "inertia",
    "load_friction_nm": "friction",
    "viscous_nms": "damping",
    "detent_torque_nm": "detent torque",
    "backlash_deg": "backlash",
    "resistance_ohm": "resistance",
    "inductance_h": "inductance",
    "supply_v": "supply",
    "counts_per_turn": "encoder",
}
"""What figures of a motor are called; those that go with another one are not named."""


def with_its_twin(
    document: StudyDocument, device: Device, axis: int, records: Sequence[StudyRecord]
) -> tuple[StudyDocument, str]:
    """The same study with the twin that it tries, whose motor is what it will be; and why it has none, where that was
    left open. `records`: all studies, the latest first."""
    study = document.study
    if not isinstance(study, FastestMove | LeastCurrent):
        return document, ""
    twin, why = study.twin, ""
    if twin == AS_IDENTIFIED:
        why = study.no_twin if isinstance(study, FastestMove) else ""
        twin, why = (None, why) if why else _by_itself(device, axis, records)
    elif isinstance(twin, Twin) and twin.as_identified:
        twin = _with_a_plate(twin, device, axis, records)
    return document.model_copy(update={"study": study.model_copy(update={"twin": twin})}), why


def _by_itself(device: Device, axis: int, records: Sequence[StudyRecord]) -> tuple[Twin | None, str]:
    """A twin that nothing else is told of; or why there is none."""
    record, why = _latest(device, axis, records)
    if record is None:
        return None, why
    figures = figures_of(record)
    if "holding_torque_nm" not in figures:
        return None, (
            f"study {record.id} was not told the run current (run_current_a), by which the torque goes: "
            "tell it that, or name the motor of the twin"
        )
    if why := why_no_amperes(device, axis):
        return None, why
    try:
        motor = TwinMotor.model_validate(figures)
    except ValidationError as error:
        return None, _beyond(record, error)
    return Twin(motor=motor, source=_source(record, figures, "the rest as usual of a motor")), ""


def why_no_amperes(device: Device, axis: int) -> str:
    """Why a twin of the axis would have a torque of its own; empty where its full scale is known."""
    if family_of(device.model).full_scale_a(device.model, device.axes[axis].settings.limits) is not None:
        return ""
    return (
        "how many amperes a full scale is, is not known of this axis, so a twin would have another torque: "
        f"set {full_scale_figures(device.model)} in its limits"
    )


def _with_a_plate(twin: Twin, device: Device, axis: int, records: Sequence[StudyRecord]) -> Twin:
    """A twin whose motor is told, with what was identified in the place of that, as far as it was."""
    record, why = _latest(device, axis, records)
    motor, source = twin.motor, f"motor as told: {why}"
    if record is not None:
        figures = figures_of(record)
        try:
            motor = TwinMotor.model_validate({**twin.motor.model_dump(), **figures})
            source = _source(record, figures, "the rest as told")
        except ValidationError as error:
            source = f"motor as told: {_beyond(record, error)}"
    return twin.model_copy(update={"motor": motor, "as_identified": False, "source": source})


def _latest(device: Device, axis: int, records: Sequence[StudyRecord]) -> tuple[StudyRecord | None, str]:
    """The latest study of motor and machine of this axis that is done, if it told an inertia; else why not."""
    for record in records:
        about = record.document
        of_it = (about.device, about.axis, record.model) == (device.id, axis, device.model)
        if not of_it or record.state != "done" or record.identified is None:
            continue
        if record.identified.inertia_kgm2 is None:
            return None, (
                f"study {record.id} of motor and machine could not tell the inertia: tell it the holding torque "
                "(hold_torque_nm), and begin it again"
            )
        return record, ""
    return None, (
        "the axis was not identified: a study of motor and machine (identification) that is told holding torque and "
        "run current makes a twin of it"
    )


def figures_of(record: StudyRecord) -> dict[str, int | float]:
    """What a motor of a twin has of a study of motor and machine that told an inertia, by the names of `TwinMotor`.

    Inertia and Coulomb friction are those of rotor and load together: the twin's rotor has all of the former, its load
    all of the latter. The torque is that with the run current, so it is left out where nobody told that.
    """
    found, wanted = record.identified, record.document.wanted(Identification)
    assert found is not None
    assert found.inertia_kgm2 is not None
    figures: dict[str, int | float] = {"rotor_inertia_kgm2": found.inertia_kgm2.value, "load_inertia_kgm2": 0.0}
    if found.torque_nm is not None and wanted.run_current_a is not None:
        figures |= {"holding_torque_nm": found.torque_nm.value, "rated_current_a": wanted.run_current_a}
    if found.friction_nm is not None:
        figures |= {"load_friction_nm": max(0.0, found.friction_nm.value), "friction_nm": 0.0}
    if found.viscous_nms is not None:
        figures["viscous_nms"] = max(0.0, found.viscous_nms.value)
    if found.detent_torque_nm is not None:
        figures["detent_torque_nm"] = found.detent_torque_nm.value
    if found.backlash_microsteps is not None:
        turns = found.backlash_microsteps.value / found.microsteps_per_turn
        figures["backlash_deg"] = max(0.0, 360 * turns)
    if found.resistance_ohm is not None:
        figures["resistance_ohm"] = found.resistance_ohm.value
    if found.inductance_h is not None:
        figures["inductance_h"] = found.inductance_h.value
    if found.supply_v is not None:
        figures["supply_v"] = found.supply_v
    if found.encoder_lines is not None:
        figures["counts_per_turn"] = 4 * found.encoder_lines
    return figures


def _source(record: StudyRecord, figures: dict[str, int | float], rest: str) -> str:
    named = ", ".join(word for name, word in WORDS.items() if name in figures)
    return f"{named} by study {record.id} of motor and machine, {moment(record.started_unix_s)}; {rest}"


def _beyond(record: StudyRecord, error: ValidationError) -> str:
    (first, *_) = error.errors()
    name = ".".join(map(str, first["loc"]))
    return f"what study {record.id} of motor and machine found is beyond what a twin can have: {name}: {first['msg']}"
