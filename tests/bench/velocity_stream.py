"""A velocity profile at 1,000 points a second to an emulated chip in a process of its own, over TCP."""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import Sequence

import numpy as np

from app.clock import WallClock
from app.devices.core.config import DeviceConfig
from app.devices.manager import DeviceManager
from app.devices.tmc428.start_up import AxisStart, start_up
from app.links.registry import tcp_factory
from app.procedures.procedures import Procedures
from tests.bench.table import Row
from tests.peers.emulator_process import emulator

RATE_HZ = 1000.0
LATE_LIMIT_MS = 2.0


def measure(quick: bool) -> Sequence[Row]:
    return [asyncio.run(_play(2.0 if quick else 20.0))]


async def _play(seconds: float) -> Row:
    with emulator("--tcp", "127.0.0.1:0", model="tmc428") as process:
        assert process.tcp is not None
        host, port = process.tcp
        clock = WallClock()
        manager = DeviceManager({"tcp": tcp_factory}, clock)
        try:
            device = await manager.add(DeviceConfig("far", "tmc428", {"kind": "tcp", "host": host, "port": port}))
            if device.problem is not None:
                raise device.problem
            await start_up(device, [AxisStart(v_max=1500, a_max=200, pulse_div=4, ramp_div=6)] * 3)
            procedures = Procedures(clock)
            time_s = np.linspace(0, seconds, 65)
            velocity = 8000 * np.sin(2 * np.pi * time_s / seconds)
            velocity[-1] = 0
            await procedures.start_profile(device, 0, time_s.tolist(), velocity.tolist(), RATE_HZ)
            play = procedures.profile_play(device, 0)
            assert play is not None
            await play.wait()
            state = play.state
            late = [math.inf if each is None else each for each in play.lateness_ms()]  # left out: late for ever
        finally:
            await manager.close()
    assert state.summary is not None
    late_ms = float(np.percentile(late, 99, method="higher"))
    known = len(late) - late.count(math.inf)
    whole = state.state == "done" and known == state.sent and state.sent + state.skipped == state.summary.points
    return Row(
        what=f"velocity profile, {RATE_HZ:,.0f} points/s over TCP, lateness of each, 99 %",
        measured=f"{late_ms:.2f} ms",
        peer=f"limit {LATE_LIMIT_MS:g} ms",
        ratio=late_ms / LATE_LIMIT_MS,
        required="< 1, a point that is left out counts as late for ever",
        ok=whole and late_ms < LATE_LIMIT_MS,
        notes=(
            (
                f"{state.sent} sent, {state.skipped} left out, half within {state.late_median_ms or 0:.2f} ms, "
                f"latest {state.late_max_ms or 0:.1f} ms; {state.message}; load {os.getloadavg()[0]:.1f}"
            ),
        ),
    )
