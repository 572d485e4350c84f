"""Modules on a line, each at its address."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...clock import Clock
from ...emulators.core.pace import Pace
from ...emulators.line.framing import TMCL
from ...emulators.line.server import LineServer
from ...emulators.tmcl.family import FAMILY
from ...emulators.tmcl.module import EmulatedModule
from ..line import Far, LineOptions, line_of

if TYPE_CHECKING:
    from fastapi import FastAPI


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The line with its modules."""
    modules = {address: _module(address, clock, options) for address in options.addresses}
    pace = Pace(clock.now, share=1.0)
    for module in modules.values():
        module.pace = pace

    def make_control(server: LineServer) -> FastAPI:
        from .control import Controlled, make_control_app

        return make_control_app(Controlled(server, modules))

    return Far(line_of(list(modules.values()), clock, options, TMCL), make_control)


def _module(address: int, clock: Clock, options: LineOptions) -> EmulatedModule:
    # Modules that made the same noise would be one module twice.
    named = {"address": address, "time_scale": options.time_scale, "seed": options.seed + address}
    kept = options.data_dir
    eeprom = None if kept is None else kept / "emulators" / f"{options.model}-{address}.json"
    return FAMILY.make(options.model, clock, FAMILY.options.model_validate(named), eeprom)
