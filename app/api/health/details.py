"""The server's health, collected once for all who ask: as JSON, and as Prometheus' metrics."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily, Metric
from prometheus_client.registry import Collector

from ... import __version__
from ...connections import descriptor_limit
from ...devices.core.device import Device
from ...links.emulator import EmulatorPort
from ...links.queue import Priority
from ..bench import Bench
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


async def health_of(bench: Bench) -> HealthDetails:
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


def _compiling(bench: Bench) -> Compiling | None:
    kernels = bench.kernels
    if kernels.done == kernels.total:
        return None
    return Compiling(done=kernels.done, total=kernels.total, doing=list(kernels.doing))


def _notes(bench: Bench) -> list[str]:
    not_saved = (bench.saver.why_not, bench.position_saver.why_not, bench.audit.why_not)
    database = bench.database.problem
    told = [*not_saved, "" if database is None else f"{database}; {database.way_out}"]
    return [*dict.fromkeys(note for note in told if note), *bench.database.notes, *bench.vitals.notes]


def _device(bench: Bench, device: Device) -> DeviceHealth:
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


# --- Prometheus ---------------------------------------------------------------------------------


def metrics_text(health: HealthDetails) -> bytes:
    """The same figures in Prometheus' text format. What is not known is left out."""
    registry = CollectorRegistry()
    registry.register(_Figures(health))
    return generate_latest(registry)


class _Figures(Collector):
    def __init__(self, health: HealthDetails) -> None:
        self._health = health

    def collect(self) -> Iterator[Metric]:
        health = self._health
        yield InfoMetricFamily("stepscope", "Which stepscope this is.", {"version": health.version})
        storage, process, loop, sockets = health.storage, health.process, health.event_loop, health.sockets
        gauges: tuple[tuple[str, str, float | None], ...] = (
            ("uptime_seconds", "Since the server's start.", health.uptime_s),
            ("storage_free_bytes", "Free on the disk of the data directory.", storage.free_bytes),
            ("storage_total_bytes", "Size of that disk.", storage.total_bytes),
            ("storage_writable", "Whether the data directory may be written.", storage.writable),
            ("storage_notes", "What is not saved, or was set aside.", len(storage.notes)),
            ("open_descriptors", "Open files and sockets.", process.descriptors),
            ("descriptors_max", "How many there may be.", process.descriptors_max),
            ("resident_memory_bytes", "Memory that is in RAM.", process.resident_bytes),
            ("event_loop_lag_seconds", "How late the event loop was just now.", _s(loop.lag_ms)),
            ("event_loop_lag_p99_seconds", "The same, 99th percentile of a minute.", _s(loop.lag_p99_ms)),
            ("websockets", "Open WebSockets.", sockets.websockets),
            ("connections", "Open connections.", sockets.connections),
            ("connections_max", "How many there may be.", sockets.connections_max),
            ("devices", "Devices.", len(health.devices)),
            ("emulators", "Devices that are emulated here.", sum(d.emulator is not None for d in health.devices)),
        )
        for name, help_text, value in gauges:
            if value is not None:
                yield GaugeMetricFamily(f"stepscope_{name}", help_text, float(value))
        if sockets.connections_ended is not None:
            yield CounterMetricFamily(
                "stepscope_connections_ended", "Ended for others, or for taking too long.", sockets.connections_ended
            )
        yield from _of_devices(health.devices)


def _of_devices(devices: list[DeviceHealth]) -> Iterator[Metric]:
    up = GaugeMetricFamily("stepscope_device_connected", "Whether the device is connected.", labels=["device", "model"])
    waiting = GaugeMetricFamily("stepscope_queue_waiting", "Turns that wait.", labels=["device", "priority"])
    wait = GaugeMetricFamily("stepscope_queue_longest_wait_seconds", "Longest of a minute.", labels=["device"])
    readers = GaugeMetricFamily("stepscope_telemetry_readers", "Who reads its samples.", labels=["device"])
    counters = {
        name: CounterMetricFamily(f"stepscope_{name}", help_text, labels=["device"])
        for name, help_text in (
            ("link_bytes_sent", "Bytes to the device."),
            ("link_bytes_received", "Bytes from the device."),
            ("link_frames", "Frames to the device."),
            ("link_timeouts", "Exchanges without an answer in time."),
            ("link_failures", "Failed exchanges, timeouts included."),
            ("link_samples_dropped", "Samples that were not taken, for the link was too busy."),
            ("telemetry_rows_dropped", "Rows that slow readers lost."),
        )
    }
    missed = CounterMetricFamily("stepscope_emulator_samples_missed", "Samples that were given up.", labels=["device"])
    for device in devices:
        link, queue, label = device.link, device.queue, [device.id]
        up.add_metric([device.id, device.model], float(device.state == "connected"))
        for priority, count in (("stop", queue.stops), ("command", queue.commands), ("sample", queue.samples)):
            waiting.add_metric([device.id, priority], count)
        wait.add_metric(label, queue.longest_wait_ms / 1e3)
        readers.add_metric(label, device.telemetry.readers)
        figures = (
            link.bytes_sent,
            link.bytes_received,
            link.frames,
            link.timeouts,
            link.failures,
            link.samples_dropped,
            device.telemetry.rows_dropped,
        )
        for counter, figure in zip(counters.values(), figures, strict=True):
            counter.add_metric(label, figure)
        if device.emulator is not None:
            missed.add_metric(label, device.emulator.samples_missed)
    yield from (up, waiting, wait, readers, *counters.values(), missed)


def _s(milliseconds: float | None) -> float | None:
    return None if milliseconds is None else milliseconds / 1e3
