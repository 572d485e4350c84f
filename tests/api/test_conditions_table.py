"""Every family and everything that can happen to it: within 0.5 s `GET /devices` says so. Prints each figure.

The event is what the emulator did, or the moment at which its motor came to rest by its own ground truth; nobody asks
for the axis. Time is the test's, so the figures are those of a server that nothing keeps from its work.
"""

from __future__ import annotations

import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.conditions.ground_truth import ground_truth_of
from app.emulators.build import family_of
from app.links.emulator import EmulatorPort
from tests.api.test_conditions_found import ALL, SIX_POINT, TOLD_S, WITH_ENCODER, Rig, rig

STEP_S = 0.01
WITHIN_S = 10.0
PHASES_S = (0.0, 0.13)
"""How far into the pause between two looks it happens."""
SWINGS_FULLSTEPS = 0.5
"""What a rotor that has come to rest still swings."""


def around(one: Rig, **change: Any) -> None:
    """Change the emulated plant, and tell nobody: as it is with a real one."""
    port = one.device.session.port
    assert isinstance(port, EmulatorPort)
    port.wire.patch(family_of(port.wire.model).patch.model_validate(one.emulator_patch(change)), port.take_turn())  # type: ignore[attr-defined]


async def rotating(one: Rig) -> None:
    await one.post(
        "axes/0/rotate", {"velocity": 20_000, "unit": "pps"} if ramps(one) else {"velocity": 200, "unit": "chip"}
    )
    await one.clock.advance(1.0)
    assert await one.kind() == "moving"


def ramps(one: Rig) -> bool:
    """Whether its speed can be set in pps as it is."""
    return one.device.model not in ("tmc428", "tmc4210")


async def still(one: Rig) -> None:
    await one.clock.advance(3.0)


async def stalling(one: Rig) -> None:
    """Turning, with what the chip has to stop at a stall."""
    write = one.device.registers.write
    if one.device.model in SIX_POINT:
        await write("SW_MODE", 0, fields={"sg_stop": 1, "stop_l_enable": 0, "stop_r_enable": 0})
        if one.device.model in ("tmc5130", "tmc5160"):
            await write("TCOOLTHRS", 0, 2_000)
        else:
            await write("VCOOLTHRS", 0, 10_000)
            await write("VHIGH", 0, (1 << 23) - 1)
    elif one.device.model == "tmc4361":
        await write("VSTALL_LIMIT", 0, 1000)
        await write("REFERENCE_CONF", 0, fields={"stop_on_stall": 1})
    else:
        await write("maximum_acceleration", 0, 200_000)
        await write("stop_on_stall", 0, 20_000)
    await one.post("axes/0/rotate", {"velocity": 40_000, "unit": "pps"})
    await one.clock.advance(1.0)
    assert await one.kind() == "moving"


async def limited(one: Rig) -> None:
    """Turning towards the end of its range."""
    position = (await one.client.get(f"{one.url}/axes/0")).json()["position"]
    far = 40_000 if ramps(one) else 4_000
    limits = {"limits": {"position_max": position + far}}
    answer = await one.client.patch(one.url, json={"axes": [limits, *[{}] * (len(one.device.axes) - 1)]})
    assert answer.status_code == 200, answer.text
    await one.post(
        "axes/0/rotate", {"velocity": 20_000, "unit": "pps"} if ramps(one) else {"velocity": 200, "unit": "chip"}
    )


async def about_to_lose_steps(one: Rig) -> None:
    around(one, blocked=True)
    await still(one)


@dataclass(frozen=True)
class Incident:
    """Something that can happen: by which kind it is told, on which models, and how it is brought about.

    comes_to_rest : it is so when the motor has come to rest
    """

    kind: str
    models: tuple[str, ...]
    before: Callable[[Rig], Awaitable[None]]
    happen: Callable[[Rig], object]
    comes_to_rest: bool = False


INCIDENTS = {
    "blocked shaft": Incident("following_error", WITH_ENCODER, rotating, lambda one: around(one, blocked=True)),
    "lost steps": Incident(
        "lost_steps",
        WITH_ENCODER,
        about_to_lose_steps,
        lambda one: one.post("axes/0/move", {"target": 900, "relative": True}),
        comes_to_rest=True,
    ),
    "stall": Incident(
        "stalled",
        ("tmc4361", *SIX_POINT, "pd42-1241"),
        stalling,
        lambda one: around(one, blocked=True),
        comes_to_rest=True,
    ),
    "switch": Incident("held", ALL, rotating, lambda one: around(one, switches={"right": True}), comes_to_rest=True),
    "limit": Incident("held", ALL, limited, lambda one: None, comes_to_rest=True),
    "dead link": Incident("not_connected", ALL, still, lambda one: around(one, faults={"unplugged": True})),
    "power cycle": Incident("cannot_move", ALL, still, lambda one: around(one, power_cycle=True)),
}


def where(one: Rig) -> float:
    """Where the chip's ramp has sent the rotor [full steps], by the emulator."""
    truth = ground_truth_of(one.device, 0)
    assert truth is not None
    microsteps = one.device.axis(0).microsteps_per_full_step or 256
    return ((truth.shaft_position or 0.0) + (truth.lost_steps or 0.0)) / microsteps


async def figure_s(one: Rig, incident: Incident, kind: str) -> float:
    """How long after it was so it is told [s]."""
    began_s = one.clock.now()
    happened = incident.happen(one)
    if isinstance(happened, Awaitable):
        await happened
    at, moved_s = where(one), began_s
    while one.clock.now() < began_s + WITHIN_S:
        if await one.kind() == kind:
            return one.clock.now() - (moved_s if incident.comes_to_rest else began_s)
        await one.clock.advance(STEP_S)
        if abs(where(one) - at) > SWINGS_FULLSTEPS:
            at, moved_s = where(one), one.clock.now()
    raise AssertionError(f"not told within {WITHIN_S} s: it is {(await one.told())['condition']}")


@pytest.mark.parametrize(
    ("model", "what"), [(model, what) for what, incident in INCIDENTS.items() for model in incident.models]
)
async def test_what_happens_is_told_within_half_a_second(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str, what: str
) -> None:
    incident = INCIDENTS[what]
    kind = "unknown" if (model, what) == ("pd42-1241", "power cycle") else incident.kind
    found = []
    for phase_s in PHASES_S:
        one = await rig(app, client, clock, model)
        await incident.before(one)
        await clock.advance(phase_s)
        found.append(await figure_s(one, incident, kind))
        await client.delete(one.url)
    sys.stdout.write(f"\n{what:14} {model:10} {kind:16} {max(found):.2f} s\n")
    assert max(found) <= TOLD_S, found
