"""The server's health as Prometheus' metrics."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily, Metric
from prometheus_client.registry import Collector

from .schemas import DeviceHealth, HealthDetails

CONTENT_TYPE = CONTENT_TYPE_LATEST


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
