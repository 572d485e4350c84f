"""Modules on a line, each at its address."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..clock import Clock
from ..emulators.build import family_of
from ..emulators.core.pace import Pace
from ..emulators.line.framing import TMCL
from ..emulators.line.server import LineServer
from .line import Far, LineOptions, line_of

if TYPE_CHECKING:
    from fastapi import FastAPI


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The line with its modules."""
    family, pace, kept = family_of(options.model), Pace(clock.now, share=1.0), options.data_dir
    modules = {}
    for address in options.addresses:
        # Modules that made the same noise would be one module twice.
        named: dict[str, object] = {
            "address": address,
            "time_scale": options.time_scale,
            "seed": options.seed + address,
        }
        if options.can is not None and "can_receive_id" in family.options.model_fields:
            # As delivered they would all listen to 1, and all answer as 2.
            named |= {"can_receive_id": 2 * address - 1, "can_send_id": 2 * address}
        eeprom = None if kept is None else kept / "emulators" / f"{options.model}-{address}.json"
        modules[address] = family.make(options.model, clock, family.options.model_validate(named), eeprom)
        modules[address].pace = pace

    def make_control(server: LineServer) -> FastAPI:
        from .line_control import Several, make_control_app

        return make_control_app(Several(server, family, modules))

    return Far(line_of(list(modules.values()), clock, options, TMCL), make_control)
