"""Torque over speed on plants drawn from a seed that it does not know, judged by a brake.

The judge does what a test bench does: it turns the same plant at the same speed and raises a load torque slowly until
the rotor falls out of step. What it takes then is what the motor has beyond the friction of its axis.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from app.devices.core.capabilities import PositionFromEncoder
from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.studies.record import StudyRecord
from tests.bench.collected import collected
from tests.bench.table import Row
from tests.plants.heavy import drawn
from tests.studies.harness import START, STEP_S, Studied, studied

FULL = replace(START, irun=31, ihold=31)
"""At the rated current, also at rest."""
STUDY: dict[str, Any] = {"kind": "torque_curve", "travel_turns": 400.0, "inertia_share": 0.02}
BUDGET: dict[str, Any] = {"time_s": 3600.0}
LONGEST_S = 4000.0
NAMES = ("VMAX", "AMAX", "DMAX", "V1")
TURN = 51_200
GENTLE, OF_POINT = 0.06, 0.2
"""The judge's load is brought up to speed by this share of the holding torque, and of what is expected there."""
LOADED, RAISED = 0.88, 0.0006
"""The brake begins at this share of what is expected, and is raised by this share every `EVERY_S`."""
EVERY_S, PARTS = 0.03, 100
"""It comes to where it begins in so many parts: at once it would be a blow, and the rotor swing out of step."""
SLIPPED = 1024
SWINGS, CALM_S, CALM_WITHIN_S = 20, 0.3, 40.0
"""A rotor that swings by more than this [microsteps] within so long, as it does after it has come up to its speed,
falls out of step early: it is waited for."""
TRIES = 3
RESTS, REST_LOOKS_S = 10, (0.1, 0.037, 0.071, 0.053, 0.089)
"""It rests where it turned by no more [microsteps] from each look to the next, which come at no beat of its swing."""
WITHIN, HOLDS, SPEEDS = 0.05, 0.93, 8
BY_SWITCH: dict[str, Any] = {"time_s": 14_400.0}
BLIND = 4000
"""The first seed of those without an encoder: some below were looked at while the study was made."""


async def advanced(s: Studied, work: Any) -> Any:
    task = asyncio.ensure_future(work)
    while not task.done():
        await s.clock.advance(STEP_S)
    return await task


async def _off(s: Studied) -> int:
    state = await s.device.monitor.axis_state(0)
    return (state.encoder_position or 0) - state.position


async def _rest(s: Studied) -> None:
    """Wait until the shaft rests, and take the position from the encoder."""
    still, last = 0, -SLIPPED
    while still < len(REST_LOOKS_S):
        await s.clock.sleep(REST_LOOKS_S[still])
        at = (await s.device.monitor.axis_state(0)).encoder_position or 0
        still, last = (still + 1 if abs(at - last) <= RESTS else 0), at
    await s.device.need(PositionFromEncoder).position_from_encoder(0)


async def _calm(s: Studied) -> None:
    """Wait until the rotor swings no more beside its field, at constant speed."""
    until_s = s.clock.now() + CALM_WITHIN_S
    swing = SLIPPED
    while swing > SWINGS and s.clock.now() < until_s:
        seen, end_s = [await _off(s)], s.clock.now() + CALM_S
        while s.clock.now() < end_s:
            await s.clock.sleep(0.007)
            seen.append(await _off(s))
        swing = max(seen) - min(seen)


async def _up(s: Studied, rps: float) -> bool:
    """Come up to a speed; False where the rotor slips: one that its friction held beside its field does not follow."""
    await s.device.motion.rotate(0, rps * TURN)
    while abs((await s.device.monitor.axis_state(0)).velocity_pps - rps * TURN) > 10:
        if abs(await _off(s)) > SLIPPED:
            return False
        await s.clock.sleep(0.1)
    return True


async def braked(s: Studied, rps: float, expected_nm: float) -> float:
    """The load torque at which the rotor slips at a speed [N m]."""

    def load(torque_nm: float) -> None:
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, load_torque_nm=torque_nm)]))

    for _ in range(TRIES):
        await _rest(s)
        if await _up(s, rps):
            break
        await s.device.motion.stop_axes([0], "immediate")
    else:
        raise AssertionError(f"the judge is too hasty: it slips on its way to {rps:g} turns/s")
    await _calm(s)
    torque = 0.0
    for part in range(1, PARTS + 1):
        torque = LOADED * expected_nm * part / PARTS
        load(torque)
        await s.clock.sleep(EVERY_S)
    while abs(await _off(s)) < SLIPPED:
        torque += RAISED * expected_nm
        load(torque)
        await s.clock.sleep(EVERY_S)
    load(0.0)
    await s.device.motion.stop_axes([0], "immediate")
    await _rest(s)
    return torque


@dataclass(frozen=True)
class Judged:
    """A study on a plant: its record, what the brake says at each of its speeds, and whether the axis is as before."""

    record: StudyRecord
    truth_nm: tuple[float, ...]
    as_before: bool

    @property
    def off(self) -> list[float]:
        """By how much each torque is off, as a share."""
        assert self.record.torque is not None
        points = self.record.torque.points
        return [(each.torque_nm or 0.0) / truth - 1 for each, truth in zip(points, self.truth_nm, strict=True)]

    @property
    def held(self) -> list[bool]:
        """Whether each interval holds it."""
        assert self.record.torque is not None
        intervals = [point.interval_nm for point in self.record.torque.points]
        return [i is not None and i.low <= t <= i.high for i, t in zip(intervals, self.truth_nm, strict=True)]


async def _judged(seed: int, folder: Path) -> Judged:
    options, inertia = drawn(seed)
    async with studied(folder, FULL, **options) as s:
        before = await s.settings(*NAMES)
        study = {**STUDY, "inertia_kgm2": inertia}
        record = await s.finish(s.begin(s.document(study, budget=BUDGET, seed=seed)), LONGEST_S)
        as_before = await s.settings(*NAMES) == before
        return Judged(record, await _truth(s, options, inertia, record), as_before)


async def _by_switch(seed: int, folder: Path) -> Judged:
    """Without an encoder, by a switch near where it begins; the brake turns the same plant with one."""
    options, inertia = drawn(seed)
    blind = {**options, "stage": {**options["stage"], "left_at_fullsteps": -random.Random(seed).uniform(5, 60)}}
    async with studied(folder / "study", replace(FULL, counts_per_rev=0), **blind) as s:
        before = await s.settings(*NAMES)
        study = {**STUDY, "seen_by": "left switch", "inertia_kgm2": inertia}
        record = await s.finish(s.begin(s.document(study, budget=BY_SWITCH, seed=seed)), 2 * BY_SWITCH["time_s"])
        as_before = await s.settings(*NAMES) == before
    async with studied(folder / "brake", FULL, **options) as s:
        return Judged(record, await _truth(s, options, inertia, record), as_before)


async def _truth(s: Studied, options: dict[str, Any], inertia: float, record: StudyRecord) -> tuple[float, ...]:
    """What the brake says at each speed of a study [N m]."""
    found = record.torque
    if found is None or not found.points:
        return ()
    gentle = GENTLE * options["motor"]["holding_torque_nm"] / inertia / (2 * np.pi) * TURN
    unit = s.device.clock_hz**2 / (512 * 256 * 2**24)
    await s.device.registers.write("AMAX", 0, round(gentle / unit))
    return tuple([float(await advanced(s, braked(s, each.speed_rps, each.torque_nm or 0.0))) for each in found.points])


async def _aborted(seed: int, folder: Path) -> bool:
    """Whether the axis is as before, or what is left is told, after a stop at a random moment."""
    rng = random.Random(seed)
    options, _ = drawn(seed)
    async with studied(folder, FULL, **options) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(STUDY, budget=BUDGET))
        await s.clock.advance(rng.uniform(0.05, 60))
        await s.device.stop_axes([0], rng.choice(("ramp", "immediate")))
        record = await s.finish(run, 60)
        return await s.settings(*NAMES) == before or bool(record.left)


def measure(quick: bool) -> Sequence[Row]:
    """Four rows; quick: a few plants of each."""
    plants, aborts = (2, 3) if quick else (100, 20)
    judged = collected("torque", _judged, range(plants), share=0.5).values()
    blind = collected("torque by a switch", _by_switch, range(BLIND, BLIND + plants), share=0.4).values()
    stops = collected("torque aborts", _aborted, range(2000, 2000 + aborts), share=0.1).values()
    told = [one for one in judged if len(one.truth_nm) >= SPEEDS]
    off = [value for one in told for value in one.off]
    held = [value for one in told for value in one.held]
    near = sum(abs(value) <= WITHIN for value in off)
    said = [
        f"{len(one.truth_nm)} speeds: {one.record.verdict or one.record.message}" for one in judged if one not in told
    ]
    said += [f"not as before: {one.record.message}" for one in judged if not one.as_before]
    said += [
        f"worst {100 * max(one.off, key=abs):.1f} %: {one.record.verdict}"
        for one in told
        if max(map(abs, one.off)) > WITHIN
    ]
    return [
        Row(
            what=f"torque over speed on {len(judged)} blind plants, {len(told)} with {SPEEDS} speeds or more, "
            "by a brake",
            measured=f"{near} within {100 * WITHIN:g} %; median {100 * np.median(np.abs(off)):.1f} %, "
            f"worst {100 * np.abs(off).max():.1f} %",
            peer=f"{len(off)} speeds",
            ratio=near / len(off),
            required=f">= {HOLDS:g}, every axis as before",
            ok=near / len(off) >= HOLDS and all(one.as_before for one in judged) and len(told) >= HOLDS * len(judged),
            notes=tuple(said),
        ),
        Row(
            what="their 95 % intervals",
            measured=f"{sum(held)} hold what the brake says",
            peer=f"{len(held)}",
            ratio=sum(held) / len(held),
            required=f">= {HOLDS:g}",
            ok=sum(held) / len(held) >= HOLDS,
        ),
        _row_by_switch(blind),
        Row(
            what=f"studies of torque stopped at {len(stops)} random moments",
            measured=f"{sum(stops)} as before, or told what is left",
            peer=f"{len(stops)}",
            ratio=sum(stops) / len(stops),
            required="all",
            ok=all(stops),
        ),
    ]


def _row_by_switch(judged: Collection[Judged]) -> Row:
    """By a switch a torque lies between two ramps some percent apart: it is held to the interval that it claims."""
    told = [one for one in judged if len(one.truth_nm) >= SPEEDS]
    off = [value for one in told for value in one.off]
    held = [value for one in told for value in one.held]
    near = sum(abs(value) <= WITHIN for value in off)
    odd = [one for one in judged if one not in told or not one.as_before]
    return Row(
        what=f"the same without an encoder, by a switch, on {len(judged)} blind plants, {len(told)} with "
        f"{SPEEDS} speeds or more: 95 % intervals",
        measured=f"{sum(held)} hold what the brake says; {near} within {100 * WITHIN:g} %, "
        f"median {100 * np.median(np.abs(off)):.1f} %, worst {100 * np.abs(off).max():.1f} %",
        peer=f"{len(held)}",
        ratio=sum(held) / len(held),
        required=f">= {HOLDS:g}, every axis as before",
        ok=sum(held) >= HOLDS * len(held) and len(told) >= HOLDS * len(judged) and all(x.as_before for x in judged),
        notes=tuple(one.record.verdict or one.record.message for one in odd),
    )
