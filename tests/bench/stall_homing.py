"""Sensorless homing on a hundred emulated stages of random friction and inertia, each with its end somewhere else.

A module searches with what it finds by itself, at a turn a second. The end is where the emulator has it; the motor has
to stand within a full step of it afterwards. Grinding is device time in which steps were lost and the field was ahead.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import Sequence

from app.procedures.procedures import Procedures
from app.procedures.stall_search import StallWanted
from tests.bench.table import Row
from tests.devices.tmcl.harness import bench

STAGES = 100
WITHIN = 0.98
GRINDS_S = 1.0
STEP_S = 0.02


async def _home(seed: int) -> tuple[float | None, float, str]:
    """How far from the end it stands [full steps], how long it ground [s], and what it says."""
    rng = random.Random(seed)
    end = -rng.uniform(10, 200)
    load = {"friction_nm": rng.uniform(0, 0.12), "inertia_kgm2": 10 ** rng.uniform(-6, -4.4)}
    stage = {
        "left_at_fullsteps": -5000,
        "right_at_fullsteps": 5000,
        "left_end_fullsteps": end,
        "right_end_fullsteps": 4000,
    }
    ground_s = 0.0
    async with bench(stage=stage, load=load, seed=seed) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted())
        for _ in range(6000):
            await b.clock.advance(STEP_S)
            state = procedures.search_state(b.device, 0)
            truth = b.module.state().truth
            ground_s += STEP_S * (truth.lost_fullsteps != 0 and abs(truth.field_fullsteps - truth.rotor_fullsteps) > 2)
            if state.state != "running":
                break
        off = b.module.state().stage.position_fullsteps - end
    return (off if state.state == "done" else None), ground_s, state.message


async def _all(count: int) -> list[tuple[float | None, float, str]]:
    return [await _home(seed) for seed in range(count)]


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: ten stages."""
    count = STAGES // 10 if quick else STAGES
    found = asyncio.run(_all(count))
    offs = [abs(off) for off, _, _ in found if off is not None]
    good = sum(off <= 1.0 for off in offs)
    wrong = sum(off > 1.0 for off in offs)
    said = [message for off, _, message in found if off is None]
    ground_s = max(ground for _, ground, _ in found)
    return [
        Row(
            what=f"sensorless homing on {count} stages of random friction and inertia",
            measured=f"{good} within a full step",
            peer=f"{count}",
            ratio=good / count,
            required=f">= {WITHIN:g}, the others say why, none grinds > {GRINDS_S:g} s",
            ok=good / count >= WITHIN and not wrong and all(said) and ground_s <= GRINDS_S,
            notes=(
                f"farthest {max(offs, default=0.0):.2f} full steps; {wrong} wrong; longest grinding {ground_s:.2f} s",
                *said[:3],
            ),
        )
    ]
