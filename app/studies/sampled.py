"""Channels of a device sampled on the way of a move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from ..clock import Clock
from ..devices.core.device import Device
from ..errors import BenchError
from ..procedures.procedure import Failed
from ..telemetry.sampling import FloatArray, Sampling


class RunningSamples:
    """What has been sampled so far; `take` it now and then."""

    def __init__(self, device: Device, channels: Sequence[str], rate_hz: float, clock: Clock) -> None:
        self._device = device
        self._failure: BenchError | None = None
        self._times: list[FloatArray] = []
        self._rows: list[FloatArray] = []
        self._sampling = Sampling(device, channels, rate_hz, clock, self._failed)

    def take(self) -> None:
        """Fetch what has come since. Raises what kept samples from coming."""
        port = self._device.session.sampling_port
        if port is not None:
            port.run_due_samples()
        block = self._sampling.take()
        if len(block.time_s):
            self._times.append(block.time_s)
            self._rows.append(block.samples)
        if self._failure is not None:
            raise self._failure

    def all(self) -> tuple[FloatArray, FloatArray]:
        """Times [s] and samples [rows, channels] so far. Raises Failed where not one came."""
        if not self._times:
            raise Failed("not one sample came")
        return np.concatenate(self._times), np.concatenate(self._rows)

    def end(self) -> None:
        """Sample no more."""
        self._sampling.end()

    def _failed(self, error: BenchError) -> None:
        self._failure = error


@contextmanager
def sampling(device: Device, channels: Sequence[str], rate_hz: float, clock: Clock) -> Iterator[RunningSamples]:
    """Sample `channels` as long as this lasts."""
    made = RunningSamples(device, channels, rate_hz, clock)
    try:
        yield made
    finally:
        made.end()
