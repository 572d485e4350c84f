"""What the routes tell of a device's wire, out of its queue and its port."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, cast

from ...devices.core.device import Device
from ...links.port import FramePort
from ...links.queue import Priority
from .frame_text import frame_text
from .schemas import FrameEntry, FrameLog, LinkCounts, LinkIncident, LinkInfo


def frame_log(device: Device, after: int, limit: int) -> FrameLog:
    """The newest `limit` entries from number `after` on, oldest first."""
    log = device.session.queue.log
    page = log.page(max(after, log.next - limit), limit)
    frames = [
        FrameEntry(
            seq=entry.seq,
            time_unix_s=entry.time_unix_s,
            priority=cast("Literal['stop', 'command', 'sample']", entry.priority.name.lower()),
            tx=entry.tx.hex(),
            rx=entry.rx.hex() if entry.rx else None,
            took_ms=entry.took_s * 1e3,
            text=frame_text(device.model, entry.tx, entry.rx),
            error=entry.error or None,
        )
        for entry in page.frames
    ]
    return FrameLog(frames=frames, next=page.next, lost=max(page.next - len(frames) - after, 0))


def link_info(device: Device, devices: Sequence[Device]) -> LinkInfo:
    """The wire under `device`; `devices` are all there are, of whom some may share it."""
    queue, line = device.session.queue, device.session.port.traits.batches
    # An emulator in this process has no wire that could be slow or noisy.
    budget, incidents = (None, None) if line is None else (line.wire, line.incidents)
    sent = queue.counts.frames
    return LinkInfo(
        name=device.session.port.name,
        kind=str(device.link.get("kind", "")),
        baud=None if budget is None or budget.calls_per_s_possible is None else budget.baud,
        calls_per_s_possible=None if budget is None else budget.calls_per_s_possible,
        calls_per_s=queue.calls_per_s if budget is None else budget.calls_per_s,
        share=None if budget is None else budget.share,
        counts=LinkCounts(
            stops=sent[Priority.STOP],
            commands=sent[Priority.COMMAND],
            samples=sent[Priority.SAMPLE],
            waited=queue.counts.waited,
            overtaken=queue.counts.overtaken,
            samples_dropped=queue.counts.samples_dropped,
            timeouts=queue.counts.timeouts,
            failures=queue.counts.failures,
            incidents={} if incidents is None else {str(kind): count for kind, count in incidents.counts.items()},
        ),
        incidents=[
            LinkIncident(time_unix_s=incident.time_unix_s, kind=incident.kind, text=incident.text)
            for incident in reversed(incidents.list() if incidents is not None else [])
        ],
        shared_with=[
            other.id for other in devices if other is not device and _same_line(other.session.port, device.session.port)
        ],
        status_alone=device.raw.status_alone,
    )


def _same_line(one: FramePort, other: FramePort) -> bool:
    ours, theirs = one.traits.batches, other.traits.batches
    return ours is not None and theirs is not None and ours.arbiter is theirs.arbiter
