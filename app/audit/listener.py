"""What the audit log hears of by itself: register writes of every device, and what becomes of the lease."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial

from ..devices.core.actor import STEPSCOPE, Actor, actor
from ..devices.core.changes import RegisterChanged
from ..devices.core.config import AxisSettings
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, LimitReached
from ..lease.lease import LeaseEvent
from ..store.audit import AuditLog


class AuditListener:
    """Hears of register writes on every device there is, and of axes that were stopped at their limits."""

    def __init__(self, audit: AuditLog) -> None:
        self._audit = audit
        self._heard: dict[Device, Callable[[], None]] = {}

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now."""
        for device in self._heard.keys() - set(devices):
            self._heard.pop(device)()
        for device in devices:
            if device not in self._heard:
                self._heard[device] = device.listen(partial(self._hear, device))

    def _hear(self, device: Device, event: DeviceEvent) -> None:
        if isinstance(event, LimitReached):
            where = f"stopped at {event.position}"
            self._audit.note(
                "stop at limit",
                event.name,
                device=device.id,
                axis=event.axis,
                new=event.limit,
                detail=where,
                by=STEPSCOPE,
            )
        elif isinstance(event, RegisterChanged):
            self._audit.note(
                "write",
                event.register,
                device=device.id,
                axis=event.axis,
                old=event.old,
                new=event.new,
                outcome=event.outcome,
                detail=", ".join(filter(None, (event.part_of, event.field_text))),
                by=event.by,
            )


def note_settings(audit: AuditLog, device: Device, old: Sequence[AxisSettings], new: Sequence[AxisSettings]) -> None:
    """An entry for each setting of an axis that a profile has changed, named as an edit of the connection names it."""
    for index, (before, after) in enumerate(zip(old, new, strict=True)):
        for name, value in asdict(after).items():
            was = getattr(before, name)
            if isinstance(value, int | float | str | None) and was != value:
                audit.note("edit device", f"axes.{index}.{name}", device=device.id, axis=index, old=was, new=value)


def lease_words(audit: AuditLog, event: LeaseEvent) -> None:
    """An entry for what happened to the lease."""
    # What has vanished is noticed by whoever looks next: not their doing.
    by = STEPSCOPE if event.action == "vanished" else Actor(event.name, actor.get().kind, None, event.address)
    audit.note(f"lease {event.action}", event.name, detail=event.detail, by=by)
