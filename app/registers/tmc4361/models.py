"""The chip of this family, as the catalog lists it."""

from __future__ import annotations

from ..entry import Model
from . import table

FAMILY = "tmc4361"

MODELS = (
    Model(
        "tmc4361",
        FAMILY,
        "TMC4361",
        "one axis, S-ramps, encoder and closed loop",
        "a chip with S-ramps and an encoder",
        table.AXES,
        table.TMC4361,
        clock_hz_default=table.CLOCK_HZ_DEFAULT,
        clock_hz_min=table.CLOCK_HZ_MIN,
        clock_hz_max=table.CLOCK_HZ_MAX,
        capabilities=frozenset(
            {
                "registers",
                "motion",
                "ramp.s",
                "microsteps.mslut",
                "current",
                "current.ramp",
                "encoder",
                "closed_loop",
                "serial_encoder",
                "driver_sync",
                "home_switch",
                "start_pin",
                "stallguard.behind",
                "input_filters",
                "events",
                "flags",
                "position_compare",
                "position_latch",
            }
        ),
        wires=frozenset({"emulator", "tcp", "spidev", "landungsbruecke"}),
        current_scale="full_scale",
        datagram_bits=40,
        fetch_address=0x7F,  # VERSION_NO
        board="TMC4361A",
    ),
)
