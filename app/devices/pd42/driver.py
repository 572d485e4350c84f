"""The PD42-1241: motor, driver and encoder in one, spoken to in TMCL."""

from __future__ import annotations

from app.devices.pd42.samples import Samples


class Pd42(Samples):
    """Positions are the module's microsteps (AP 140 of them a full step); its one axis is number 0.

    Of an axis's settings in the connection, gear ratio and travel count, as do the full steps of a
    turn where the module itself has none (AP 202); `driver_microsteps` does not: AP 140 says that.
    """
