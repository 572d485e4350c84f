"""What the routes tell of a device's wire, out of its queue and its port."""

from __future__ import annotations

from collections.abc import Sequence

from app.api.schemas_links import FrameLog, LinkInfo
from app.devices.device import Device


def frame_log(device: Device, after: int, limit: int) -> FrameLog:
    """The newest `limit` entries behind `after`, oldest first."""
    raise NotImplementedError


def link_info(device: Device, devices: Sequence[Device]) -> LinkInfo:
    """The wire under `device`; `devices` are all there are, of whom some may share it."""
    raise NotImplementedError
