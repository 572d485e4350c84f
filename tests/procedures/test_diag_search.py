"""Homing without a switch: a controller is stopped by DIAG of the plain driver that it moves by steps."""

from __future__ import annotations

import pytest

from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.procedures.search import ReferenceSearchState, Switch
from tests.procedures.test_start_together import Bench, bench

END = {"left": -20.0, "right": 20.0}
"""Where the load ends hard [full steps]."""
SEEN_WITHIN = 4 * 256
"""A stall is seen within so many microsteps: the field has left the rotor behind by two full steps, and a measurement
takes one."""
PPS = 20_000.0
DRIVER = {
    "tmc2209": {"GCONF": 0x80, "SGTHRS": 40, "TCOOLTHRS": 820},
    "tmc2240": {"GCONF": 0x3180, "COOLCONF": 4 << 16, "TCOOLTHRS": 820},
}
"""Stall sensing as DIAG shows it near `PPS`: by StallGuard4 in StealthChop, by StallGuard2 in SpreadCycle, with pins
that are push-pull."""
HIGH = {"pol_stop_left": 1, "pol_stop_right": 1}


async def a_driver(b: Bench, model: str, hard: Switch, pin: str, controller: str = "a") -> Device:
    """A driver that turns a load with a hard end, wired to the first axis of a controller."""
    link = {"kind": "emulator", f"{hard}_end_fullsteps": END[hard], "clock_hz": 16e6}
    driver = await b.manager.add(DeviceConfig("driver", model, link))
    common = {"CHOPCONF": 0x10000053, "IHOLD_IRUN": 0x1F1F}
    for name, word in (DRIVER[model] | common).items():
        await driver.registers.write(name, None if name == "GCONF" else 0, word)
    b.wire("steps", (controller, "STEP1"), ("driver", "STEP1"))
    b.wire("stall", ("driver", "DIAG"), (controller, pin))
    assert [net.open for net in b.wiring.nets] == [None, None]
    return driver


async def searched(b: Bench, switch: Switch, way: int = 60_000) -> ReferenceSearchState:
    b.procedures.start_search(b.device("a"), 0, switch, PPS, way)
    return await ended(b)


async def ended(b: Bench) -> ReferenceSearchState:
    for _ in range(600):
        await b.clock.advance(0.02)
        state = b.procedures.search_state(b.device("a"), 0)
        if state.state != "running":
            return state
    raise AssertionError(state)


@pytest.mark.parametrize(("model", "side"), [("tmc2209", "left"), ("tmc2240", "right")])
async def test_a_hard_end_is_found_by_diag_at_a_stop_input(model: str, side: Switch) -> None:
    async with bench("tmc4361") as b:
        await a_driver(b, model, side, "STOPL" if side == "left" else "STOPR")
        await b.device("a").registers.write("REFERENCE_CONF", 0, fields=dict(HIGH))
        state = await searched(b, side)
        assert state.state == "done", state
        assert state.edges[0] == pytest.approx(END[side] * 256, abs=SEEN_WITHIN)
        assert abs(state.edges[1] - state.edges[0]) < SEEN_WITHIN, "the contact is gone where the motor stands"
        assert (await b.device("a").monitor.axis_state(0)).position == 0


async def test_a_hard_end_is_found_by_diag_at_ref1_of_a_chip_that_stops_for_as_long_as_it_is_there() -> None:
    async with bench("tmc429") as b:
        await b.device("a").registers.write("if_configuration_429", None, fields={"en_sd": 1, "en_refr": 1})
        await a_driver(b, "tmc2209", "left", "REF1")
        state = await searched(b, "left")
        assert state.state == "done", state
        assert state.edges == pytest.approx([END["left"] * 256] * 2, abs=SEEN_WITHIN)
        assert (await b.device("a").monitor.axis_state(0)).position == 0


@pytest.mark.parametrize("model", ["tmc4361", "tmc429"])
async def test_a_contact_that_is_gone_before_anybody_looks_is_an_edge(model: str) -> None:
    async with bench(model) as b:
        if model == "tmc4361":
            await b.device("a").registers.write("REFERENCE_CONF", 0, fields=dict(HIGH))
        b.procedures.start_search(b.device("a"), 0, "left", PPS / 2, 60_000)
        while abs((await b.device("a").monitor.axis_state(0)).position) < 3000:
            await b.clock.advance(0.002)
        b.touch("a", left=True)
        at = (await b.device("a").monitor.axis_state(0)).position
        await b.clock.advance(0.003)
        b.touch("a", left=False)
        state = await ended(b)
        assert state.state == "done", state
        assert state.edges[0] == pytest.approx(at, abs=2)
        assert state.edges[1] == pytest.approx(at, abs=400), "coming back out"


async def test_without_the_wire_the_end_is_not_found() -> None:
    async with bench("tmc4361") as b:
        await a_driver(b, "tmc2209", "left", "STOPL")
        b.wire("stall")
        await b.device("a").registers.write("REFERENCE_CONF", 0, fields=dict(HIGH))
        state = await searched(b, "left", way=8000)
        assert state.state == "failed"
        assert "no edge of the left switch" in state.message
