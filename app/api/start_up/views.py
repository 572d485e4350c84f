"""Start-ups between the shapes of the contract and the records behind it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from ...devices.core.device import Device
from ...devices.core.start_up import Figures
from ...profiles.start_up import Motor, StartUp, StartUpRequest
from ...registers.model import to_raw
from ..schemas import RegisterBatchResult, RegisterWritten
from .schemas import AxisStartUp, DeviceStartUp, StartChoice, StartFigures, StartUpReport, StartWrite


def wish_of(body: DeviceStartUp) -> StartUpRequest:
    """What the body of a device's start-up asks for."""
    motor = Motor() if body.motor is None else Motor(**body.motor.model_dump())
    return StartUpRequest(body.axes or (), _figures(body), motor)


def axis_wish_of(axis: int, body: AxisStartUp) -> StartUpRequest:
    """What the body of an axis's start-up asks for."""
    scales = {"run_scale": body.irun, "hold_scale": body.ihold}
    said = {name: scale for name, scale in scales.items() if scale is not None}
    return StartUpRequest([axis], _figures(body.model_copy(update=said)))


def _figures(body: StartFigures) -> Figures:
    return Figures(**{name: getattr(body, name) for name in StartFigures.model_fields})


def report(device: Device, done: StartUp) -> StartUpReport:
    """What was, or would be written."""
    now = {(change.name, change.axis): change.now for change in done.written or ()}
    writes = []
    for entry in done.diff.differences:
        if not entry.written:
            continue
        key = (entry.name, entry.axis)
        row = device.family.table.find(entry.name, entry.axis)
        readable = row is None or row[0].access.readable
        read_back = now.get(key) if readable else None
        verified = True if done.written is not None and readable else None
        writes.append(StartWrite(**entry.model_dump(), now=read_back, verified=verified))
    return StartUpReport(
        state="dry run" if done.written is None else "applied" if done.written or done.settings else "unchanged",
        axes=done.axes,
        writes=writes,
        same=done.diff.same,
        chosen=[StartChoice(**asdict(each)) for each in done.chosen],
        prepared=list(done.prepared),
        warnings=done.warnings,
        took_s=done.took_s,
    )


def batch(device: Device, done: StartUp) -> RegisterBatchResult:
    """The writes as those of a batch."""
    return RegisterBatchResult(done=list(_written(device, done)), failed=None, not_tried=0)


def _written(device: Device, done: StartUp) -> Sequence[RegisterWritten]:
    found = []
    for change in done.written or ():
        row = device.family.table.find(change.name, change.axis)
        assert row is not None  # it was just written
        register = row[0]
        word = to_raw(change.wanted, register.width)
        held = word if change.now is None else to_raw(change.now, register.width)
        readable = register.access.readable
        found.append(
            RegisterWritten(
                name=register.name,
                address=register.address,
                space=register.space.value,
                axis=register.axis,
                raw=held & register.mask,
                value=register.decode(held),
                fields=register.unpack(held & register.mask) if register.fields else {},
                unit=register.unit,
                written=word,
                verified=True if readable else None,
                note=register.write_note if readable else "it cannot be read back",
            )
        )
    return found
