"""The server's health, collected once for all who ask, as JSON; `metrics` tells the same to Prometheus."""

from __future__ import annotations

from ... import __version__
from ...connections import descriptor_limit
from ...devices.core.device import Device
from ...links.emulator import EmulatorPort
from ...links.queue import Priority
from ..server_state import ServerState
from .schemas import (
    Compiling,
    DeviceHealth,
    EmulatorHealth,
    HealthDetails,
    LoopHealth,
    ProcessHealth,
    QueueHealth,
    ReadersHealth,
    SocketsHealth,
    StorageHealth,
    WireHealth,
)
from .vitals import descriptors_used, resident_bytes


async def health_of(bench: ServerState) -> HealthDetails:
    """How the server is now."""
    vitals, settings = bench.vitals, bench.settings
    disk = await vitals.disk()
    lag, door = vitals.lag, vitals.door
    devices = [_device(bench, device) for device in bench.manager.devices]
    return HealthDetails(
        version=__version__,
        uptime_s=vitals.uptime_s,
        storage=StorageHealth(
            data_dir=str(settings.data_dir),
            free_bytes=disk.free_bytes,
            total_bytes=disk.total_bytes,
            reserve_bytes=round(settings.disk_reserve_mb * 1e6),
            writable=disk.writable,
            notes=_notes(bench),
        ),
        process=ProcessHealth(
            descriptors=descriptors_used(), descriptors_max=descriptor_limit(), resident_bytes=resident_bytes()
        ),
        event_loop=LoopHealth(
            lag_ms=_ms(lag.now_s),
            lag_p99_ms=_ms(lag.p99_s),
            lag_ms_by_second=[_ms(lag_s) for lag_s in lag.by_second()],
        ),
        sockets=SocketsHealth(
            websockets=vitals.sockets.open,
            rows_dropped=sum(device.telemetry.rows_dropped for device in devices),
            connections=None if door is None else len(door),
            connections_max=None if door is None else door.limits.total,
            connections_ended=None if door is None else door.refused,
        ),
        devices=devices,
        compiling=_compiling(bench),
    )


def _compiling(bench: ServerState) -> Compiling | None:
    kernels = bench.kernels
    if kernels.looked and kernels.done == kernels.total:
        return None
    return Compiling(done=kernels.done, total=kernels.total, doing=list(kernels.doing))


def _notes(bench: ServerState) -> list[str]:
    not_saved = (bench.saver.why_not, bench.position_saver.why_not, bench.audit.why_not)
    database = bench.database.problem
    told = [*not_saved, "" if database is None else f"{database}; {database.way_out}"]
    return [*dict.fromkeys(note for note in told if note), *bench.database.notes, *bench.vitals.notes]


def _device(bench: ServerState, device: Device) -> DeviceHealth:
    queue, port = device.session.queue, device.session.port
    counts = queue.counts
    readers, rows_dropped = bench.hub.of_device(device.id)
    problem = device.problem or queue.error
    return DeviceHealth(
        id=device.id,
        name=device.name,
        model=device.model,
        state=device.state,
        problem=None if problem is None else str(problem),
        link=WireHealth(
            name=port.name,
            kind=str(device.link.get("kind", "")),
            bytes_sent=counts.bytes_sent,
            bytes_received=counts.bytes_received,
            frames=sum(counts.frames),
            timeouts=counts.timeouts,
            failures=counts.failures,
            samples_dropped=counts.samples_dropped,
        ),
        queue=QueueHealth(
            stops=queue.waiting(Priority.STOP),
            commands=queue.waiting(Priority.COMMAND),
            samples=queue.waiting(Priority.SAMPLE),
            longest_wait_ms=queue.waits.longest_s * 1e3,
        ),
        telemetry=ReadersHealth(readers=readers, rows_dropped=rows_dropped),
        emulator=EmulatorHealth(time_scale=port.time_scale, samples_missed=port.samples_missed)
        if isinstance(port, EmulatorPort)
        else None,
    )


def _ms(seconds: float | None) -> float | None:
    return None if seconds is None else seconds * 1e3
