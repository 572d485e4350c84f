"""Reference search of a TMC5xxx by its stop switches and XLATCH."""

from __future__ import annotations

from ...clock import Clock
from ...devices.core.device import Device
from ...devices.tmc5xxx.decoded_registers import DecodedRegisters
from ...devices.tmc5xxx.position import PositionCalls
from ...errors import WrongState
from ..search import Switch
from ..stop_search import Latching, StopSearch


class SwitchSearch(StopSearch):
    """As `StopSearch`, of one axis of the chip. Raises WrongState for "reference", a switch that these chips lack."""

    latching = Latching(
        latch="XLATCH",
        switches="SW_MODE",
        sides={
            "left": ("stop_l_enable", "latch_l_active", "latch_l_inactive"),
            "right": ("stop_r_enable", "latch_r_active", "latch_r_inactive"),
        },
        # A stop by StallGuard would keep RAMP_STAT from being read, and with it the switches.
        off=("en_softstop", "sg_stop"),
    )

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        switch: Switch = "left",
        velocity_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        if switch == "reference":
            raise WrongState(
                f"a {device.family.title} has no reference switch of its own", "search for the left or the right switch"
            )
        position, decoded = device.part(PositionCalls), device.part(DecodedRegisters)
        assert position is not None  # no other device is searched by this
        assert decoded is not None
        if switch == "right" and not decoded.has_right_switch():
            raise WrongState(
                "encoder 2 has the pins of the right switches", "search for the left one, or write GCONF.enc2_enable 0"
            )
        super().__init__(device, position, axis, clock, switch, velocity_pps, max_travel)
