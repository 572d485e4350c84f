"""Registers that trials set: written only where the axis is not set so."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence

from ..devices.core.device import Device
from ..profiles.apply import Transaction
from .ramp_settings import document_of
from .record import Held

Apply = Callable[[Sequence[Held], str], Awaitable[None]]
"""Sets registers, and is told what for."""


def apply_to(device: Device) -> Apply:
    """Sets registers of a device that nobody else uses: a twin."""

    async def apply(registers: Sequence[Held], what: str) -> None:
        await Transaction(device, document_of(device, registers, what)).run()

    return apply


class SetOnce:
    """Sets registers unless they were the latest that were set."""

    def __init__(self, apply: Apply) -> None:
        self._write = apply
        self._set: Sequence[Held] | None = None
        """What the axis is set to, once that was written."""

    async def __call__(self, registers: Sequence[Held], what: str) -> None:
        """Set the axis so, if it is not. Raises BenchError."""
        if registers != self._set:
            self._set = None
            await self._write(registers, what)
            self._set = registers
