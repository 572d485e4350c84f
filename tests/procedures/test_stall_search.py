"""Sensorless homing of modules and TMC5xxx on stages that end hard."""

from __future__ import annotations

import random

import pytest

from app.errors import OutOfRange, WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState
from app.procedures.stall_search import GRINDS_S, StallWanted
from tests.devices.tmc5xxx.harness import Bench as ChipBench
from tests.devices.tmc5xxx.harness import bench as chip_bench
from tests.devices.tmcl.harness import Bench as ModuleBench
from tests.devices.tmcl.harness import bench as module_bench

END = -60.3
STAGE: dict[str, object] = {
    "left_at_fullsteps": -3000,
    "right_at_fullsteps": 3000,
    "left_end_fullsteps": END,
    "right_end_fullsteps": 2000,
}
SETTINGS = ("ap174", "ap173", "ap181", "ap172", "ap6")


async def over(b: ModuleBench | ChipBench, procedures: Procedures, within_s: float = 60.0) -> ReferenceSearchState:
    for _ in range(int(within_s / 0.02)):
        await b.clock.advance(0.02)
        state = procedures.search_state(b.device, 0)
        if state.state != "running":
            return state
    raise AssertionError(f"the search does not end: {procedures.search_state(b.device, 0)}")


@pytest.mark.sheet("FM-PD42-1241", "7.2")
@pytest.mark.parametrize(("side", "end"), [("left", END), ("right", 71.4)])
async def test_a_module_finds_the_end_and_its_settings_are_as_before(side: str, end: float) -> None:
    ends = {"left_end_fullsteps": min(end, -900), "right_end_fullsteps": max(end, 900)}
    if side == "left":
        ends["left_end_fullsteps"] = end
    else:
        ends["right_end_fullsteps"] = end
    async with module_bench(stage={**STAGE, **ends}) as b:
        registers, procedures = b.device.registers, Procedures(b.clock)
        before = [(await registers.read(name, 0)).value for name in SETTINGS]
        procedures.start_stall_search(b.device, 0, StallWanted(side=side, current_percent=40))  # type: ignore[arg-type]
        state = await over(b, procedures)
        assert state.state == "done", state.message
        assert len(state.edges) == 3
        assert [(await registers.read(name, 0)).value for name in SETTINGS] == before
        assert (await b.device.monitor.axis_state(0)).position == 0
        assert b.module.state().stage.position_fullsteps == pytest.approx(end, abs=1)
        assert state.last_position == pytest.approx(end * 256, abs=256)


@pytest.mark.parametrize("model", ["tmc5130", "tmc5160", "tmc5072", "tmc5240"])
async def test_a_chip_finds_the_end_and_its_settings_are_as_before(model: str) -> None:
    async with chip_bench(model, stage=STAGE, motor={"rotor_teeth": 50}) as b:
        registers, procedures = b.device.registers, Procedures(b.clock)
        names = ("SW_MODE", "COOLCONF", "IHOLD_IRUN")

        async def held() -> list[int]:
            kept = {reading.name: reading.value for reading in registers.kept(0)}
            return [kept[name] if name in kept else (await registers.read(name, 0)).value for name in names]

        before = await held()
        procedures.start_stall_search(b.device, 0, StallWanted())
        state = await over(b, procedures)
        assert state.state == "done", state.message
        assert await held() == before
        assert (await b.state(0)).position == 0
        assert b.wire.state().axes[0].truth.rotor_fullsteps == pytest.approx(END, abs=1)


async def test_stealthchop_is_off_while_a_module_searches_and_on_again_afterwards() -> None:
    async with module_bench(stage=STAGE) as b:
        registers, procedures = b.device.registers, Procedures(b.clock)
        for threshold in ("ap182", "ap186"):  # at every speed that it comes to
            await registers.write(threshold, 0, 1_000_000)
        await registers.write("ap187", 0, 14)
        await registers.write("ap188", 0, 120)
        await b.clock.advance(0.5)
        assert (await registers.read("pwm_mode", 0)).value == 1
        procedures.start_stall_search(b.device, 0, StallWanted(hits=2))
        await b.clock.advance(1.0)
        assert procedures.search_state(b.device, 0).state == "running"
        assert (await registers.read("pwm_mode", 0)).value == 0
        state = await over(b, procedures)
        assert state.state == "done", state.message
        assert state.message.endswith("StealthChop (pwm_gradient) was off meanwhile")
        assert b.module.state().stage.position_fullsteps == pytest.approx(END, abs=1)
        assert [(await registers.read(name, 0)).value for name in ("ap187", "ap188")] == [14, 120]
        procedures.start_stall_search(b.device, 0, StallWanted())
        await b.clock.advance(0.5)
        await procedures.abort_search(b.device, 0)
        assert (await registers.read("ap187", 0)).value == 14, "also where it is stopped"


@pytest.mark.parametrize("model", ["tmc5130", "tmc5160"])
async def test_stealthchop_is_off_while_a_chip_searches_and_on_again_afterwards(model: str) -> None:
    async with chip_bench(model, stage=STAGE, motor={"rotor_teeth": 50}) as b:
        registers, procedures = b.device.registers, Procedures(b.clock)
        await registers.write("GCONF", None, fields={"en_pwm_mode": 1})
        procedures.start_stall_search(b.device, 0, StallWanted(hits=2))
        await b.clock.advance(0.5)
        assert (await registers.read("GCONF", None)).fields["en_pwm_mode"] == 0
        state = await over(b, procedures)
        assert state.state == "done", state.message
        assert state.message.endswith("StealthChop (GCONF.en_pwm_mode) was off meanwhile")
        assert (await registers.read("GCONF", None)).fields["en_pwm_mode"] == 1


async def test_a_share_of_random_stages() -> None:
    for seed in range(4):
        rng = random.Random(seed)
        end = -rng.uniform(20, 100)
        load = {"friction_nm": rng.uniform(0, 0.08), "inertia_kgm2": 10 ** rng.uniform(-6, -4.6)}
        async with module_bench(stage={**STAGE, "left_end_fullsteps": end}, load=load, seed=seed) as b:
            procedures = Procedures(b.clock)
            procedures.start_stall_search(b.device, 0, StallWanted(hits=2))
            state = await over(b, procedures)
            assert state.state == "done", state.message
            assert b.module.state().stage.position_fullsteps == pytest.approx(end, abs=1)


async def test_a_threshold_with_which_nothing_is_a_stall_grinds_only_shortly() -> None:
    async with module_bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted(threshold=40))
        ground_s = 0.0
        for _ in range(3000):
            await b.clock.advance(0.02)
            truth = b.module.state().truth
            ground_s += 0.02 * (
                abs(truth.lost_fullsteps) > 0 and procedures.search_state(b.device, 0).state == "running"
            )
            if procedures.search_state(b.device, 0).state != "running":
                break
        state = procedures.search_state(b.device, 0)
        assert (state.state, "threshold below 40" in state.message) == ("failed", True), state.message
        assert ground_s < GRINDS_S + 0.3
        assert (await b.device.registers.read("ap174", 0)).value == 0


async def test_a_threshold_that_stops_anywhere_is_found_before_the_search() -> None:
    async with module_bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted(threshold=-50))
        state = await over(b, procedures)
        assert (state.state, state.edges) == ("failed", [])
        assert "higher threshold" in state.message


async def test_a_stage_without_an_end_is_given_up() -> None:
    async with module_bench(stage={**STAGE, "left_end_fullsteps": None}) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted(max_travel=100_000))
        state = await over(b, procedures)
        assert (state.state, "nothing stopped the motor" in state.message) == ("failed", True), state.message
        await b.clock.advance(1.0)
        assert not (await b.device.monitor.axis_state(0)).moving
        assert (await b.device.registers.read("ap181", 0)).value == 0


async def test_a_way_that_is_too_short_to_get_up_to_speed_is_told() -> None:
    async with module_bench(stage={**STAGE, "right_end_fullsteps": 71.4}) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted())
        state = await over(b, procedures)
        assert (state.state, state.edges) == ("failed", []), state.message


async def test_a_stop_ends_it_and_gives_the_settings_back() -> None:
    async with module_bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        procedures.start_stall_search(b.device, 0, StallWanted(threshold=3, current_percent=30))
        await b.clock.advance(0.5)
        await procedures.abort_search(b.device, 0)
        assert procedures.search_state(b.device, 0).state == "aborted"
        assert [(await b.device.registers.read(name, 0)).value for name in ("ap174", "ap6")] == [0, 128]


async def test_what_cannot_be_is_refused() -> None:
    async with module_bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        for wanted in (StallWanted(threshold=64), StallWanted(hits=0), StallWanted(current_percent=101.0)):
            with pytest.raises(OutOfRange):
                procedures.start_stall_search(b.device, 0, wanted)
        procedures.start_stall_search(b.device, 0, StallWanted())
        with pytest.raises(WrongState, match="runs on axis 0"):
            procedures.start_stall_search(b.device, 0, StallWanted())
        await procedures.abort_search(b.device, 0)
