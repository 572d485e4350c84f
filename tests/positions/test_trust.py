"""What makes a position no more trusted, on the real drivers and emulators of every family, and what does not."""

from __future__ import annotations

import pytest

from app.errors import WrongState
from app.registers.tmcl.modules import MODULES
from tests.positions.harness import FAMILIES, Hardware, bench, patch, server, set_up_axes

COUNTERS = {"tmc428": "x_actual", "tmc4210": "X_ACTUAL", **dict.fromkeys(MODULES, "actual_position")}
"""Names of the position counter, where it is not XACTUAL."""


@pytest.mark.parametrize("model", FAMILIES)
async def test_an_axis_that_turns_is_followed_without_anybody_asking(model: str) -> None:
    async with bench(model) as b:
        start = await b.stand(b.half - 3000)
        await b.service.watch(b.device, 0)
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(20)
        await b.device.stop(0)
        await b.clock.advance(2)
        state = await b.state()
        assert state.trusted
        assert state.actual is not None
        assert state.actual - start > 90_000
        count = (await b.device.monitor.axis_state(0)).position
        assert state.actual == count + b.whole  # the counter wrapped once


@pytest.mark.sheet("AN-001", "2.1")
@pytest.mark.parametrize("model", FAMILIES)
async def test_the_service_looks_as_often_as_the_greatest_speed_needs(model: str) -> None:
    async with bench(model) as b:
        await b.service.watch(b.device, 0)
        state = await b.state()
        assert state.service_period_s is not None
        assert state.allowed_s is not None
        assert state.allowed_s * b.device.motion.speed_limit_pps(0) < b.half
        assert state.service_period_s <= state.allowed_s / 4
        seen = []
        for _ in range(40):
            await b.clock.advance(0.5)
            seen.append(b.seen().last_look_s)
        ages = [0.5 * index + 0.5 - looked for index, looked in enumerate(seen) if looked is not None]
        assert max(ages) <= min(state.service_period_s, 10.0) + 0.1


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_look_that_came_too_late_is_told(model: str) -> None:
    """The server was held up, and the motor may have gone round."""
    async with bench(model) as b:
        await b.service.watch(b.device, 0)
        await b.clock.advance(1)
        allowed_s = b.seen().allowed_s
        assert allowed_s is not None
        b.clock.set(b.clock.now() + 1.1 * allowed_s)
        state = await b.state()
        assert (state.trusted, state.state) == (False, "lost")
        assert "looked at too late" in state.reason
        with pytest.raises(WrongState, match="looked at too late"):
            await b.service.go_to(b.device, 0, 5)
        await b.service.set_actual(b.device, 0, 1 << 50)
        state = await b.state()
        assert (state.trusted, state.actual, state.counter) == (True, 1 << 50, 0)
        await b.service.go_to(b.device, 0, (1 << 50) + 700)
        assert (await b.arrived(20)).actual == (1 << 50) + 700
        assert (await b.device.monitor.axis_state(0)).position == 700


@pytest.mark.parametrize("model", [*FAMILIES, "tmc5062"])
async def test_a_reset_of_the_chip_is_told(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        b.patch(power_cycle=True)
        await b.clock.advance(11)
        state = b.seen()
        assert (state.trusted, state.actual, state.counter) == (False, 400, 0)
        assert "the chip was reset" in state.reason
        assert '{"confirm": true}' in state.way_out
        await b.service.confirm(b.device, 0)
        await b.clock.advance(30)
        state = b.seen()
        assert (state.trusted, state.state, state.actual) == (True, "idle", 400)


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_reset_behind_a_lost_link_is_told(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        b.patch(faults={"unplugged": True})
        await b.clock.advance(3)
        assert b.device.state == "failed"
        b.patch(power_cycle=True, faults={"unplugged": False})
        await b.clock.advance(5)
        state = b.seen()
        assert (state.trusted, state.actual) == (False, 400)
        assert "the chip was reset" in state.reason


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_disconnect_is_no_harm_where_it_is_short(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        await b.manager.disconnect(b.device.id)
        state = await b.state()
        assert (state.trusted, state.reason) == (False, "the device is not connected")
        with pytest.raises(WrongState, match="not connected"):
            await b.service.go_to(b.device, 0, 500)
        await b.manager.connect(b.device.id)
        await b.clock.advance(1)
        state = await b.state()
        assert (state.trusted, state.actual) == (True, 400)


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_disconnect_that_was_too_long_is_told(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        allowed_s = b.seen().allowed_s
        assert allowed_s is not None
        await b.manager.disconnect(b.device.id)
        await b.clock.advance(1.1 * allowed_s)
        await b.manager.connect(b.device.id)
        await b.clock.advance(1)
        state = await b.state()
        assert not state.trusted
        assert "looked at too late" in state.reason


@pytest.mark.parametrize("model", FAMILIES)
@pytest.mark.parametrize("how", ["by its name", "by a procedure"])
async def test_who_writes_the_counter_is_told_of(model: str, how: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        if how == "by its name":
            await b.device.stop(0)
            await b.clock.advance(1)
            await b.device.registers.write(COUNTERS.get(model, "XACTUAL"), 0, 7)
        else:
            await b.stand(7)
        await b.clock.advance(1)
        state = await b.state()
        assert (state.trusted, state.actual, state.counter) == (False, 400, 7)
        assert "the position counter was written" in state.reason
        await b.service.set_actual(b.device, 0, -3)
        state = await b.state()
        assert (state.trusted, state.actual, state.counter) == (True, -3, 7)


async def test_a_microstep_resolution_of_a_module_counts_as_written() -> None:
    async with bench("pd42-1241") as b:
        await b.service.watch(b.device, 0)
        await b.device.registers.write("microstep_resolution", 0, 4)
        assert "microstep_resolution" in (await b.state()).reason


async def test_a_reference_search_of_a_module_sets_its_counter() -> None:
    async with bench("pd42-1241") as b:
        await b.service.watch(b.device, 0)
        await b.device.raw.exchange(bytes.fromhex("01 0d 00 00 00 00 00 00 0e"))  # RFS START
        assert "RFS START" in (await b.state()).reason
        await b.device.stop(0)


async def test_circular_movement_cannot_be_followed() -> None:
    async with bench("tmc4361") as b:
        await b.device.registers.write("REFERENCE_CONF", 0, fields={"circular_movement_en": 1})
        with pytest.raises(WrongState, match="wraps elsewhere"):
            await b.service.watch(b.device, 0)
        assert (await b.state()).counter_bits is None


async def test_circular_movement_that_comes_later_is_told() -> None:
    async with bench("tmc4361") as b:
        await b.service.watch(b.device, 0)
        await b.device.registers.write("REFERENCE_CONF", 0, fields={"circular_movement_en": 1})
        assert "its range was changed" in (await b.state()).reason


@pytest.mark.parametrize(("kind", "trusted"), [("tcp", False), ("emulator", True)])
async def test_a_computer_that_slept_says_so_where_the_motor_did_not(kind: str, trusted: bool) -> None:
    async with server(Hardware(), "tmc428", kind=kind) as b:
        await b.service.watch(b.device, 0)
        await b.clock.advance(5)
        assert b.seen().trusted
        b.hardware.slept_s = 20
        await b.clock.advance(5)
        assert b.seen().trusted == trusted
        assert trusted or "this computer slept" in b.seen().reason


async def test_a_refused_target_leaves_the_motor_to_whom_it_turns_for() -> None:
    async with bench("tmc4361") as b:
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(2)
        await b.device.registers.write("START_CONF", 0, fields={"start_en[0]": 1})
        with pytest.raises(WrongState, match="waits for a start signal"):
            await b.service.go_to(b.device, 0, 1 << 40)
        await b.clock.advance(2)
        assert (await b.device.monitor.axis_state(0)).moving
        assert "waits for a start signal" in b.seen().message


async def test_a_position_is_set_at_rest_only() -> None:
    async with bench("tmc428") as b:
        await b.service.watch(b.device, 0)
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(1)
        with pytest.raises(WrongState, match="axis 0 moves"):
            await b.service.set_actual(b.device, 0, 5)


@pytest.mark.parametrize("scale", [5.0, 20.0])
async def test_an_emulator_s_faster_time_is_kept_up_with(scale: float) -> None:
    async with bench("tmc5160") as b:
        await b.service.watch(b.device, 0)
        await b.device.motion.rotate(0, 7_900_000)
        b.patch(time_scale=scale)
        b.service.hurry(b.device)
        await b.clock.advance(1000 / scale)
        state = b.seen()
        assert state.trusted
        assert state.actual == pytest.approx(7_900_000 * 1000, rel=0.1)


# --- restarts -----------------------------------------------------------------------------------


async def restarted(model: str, *, away_s: float, power_cycle: bool = False, moves: int = 0) -> tuple[object, ...]:
    """What a second server makes of an axis at 400 + 2^40 that the first one kept: trusted, actual, reason."""
    hardware = Hardware()
    async with server(hardware, model) as first:
        await first.service.go_to(first.device, 0, 400)
        await first.arrived(20)
        await first.service.set_actual(first.device, 0, 400 + (1 << 40))
        await first.service.set_gear(first.device, 0, (51_200, 3, 7))
        await first.service.set_zero(first.device, 0, 11)
        await first.clock.advance(60)
        (saved,) = first.service.saved()
    if power_cycle:
        patch(hardware.wires[model], {"power_cycle": True})
    if moves:
        async with server(hardware, model, set_up=False) as other:  # it keeps its positions elsewhere
            await set_up_axes(other.device)
            await other.device.motion.move(0, 400 + moves)
            await other.clock.advance(2)
    await hardware.clock.advance(away_s)
    async with server(hardware, model, set_up=False) as second:
        second.service.restore([saved])
        second.service.sync(second.manager.devices)
        assert second.seen().reason == "not looked at since the server started"
        await second.clock.advance(1)
        state = second.seen()
        assert state.rotary is not None
        assert (state.rotary.turn.gear, state.rotary.turn.zero) == ((51_200, 3, 7), 11)
        (again,) = second.service.saved()
        assert again.position == state.actual
        return state.trusted, state.actual, state.reason


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_position_survives_a_restart_of_the_server(model: str) -> None:
    assert await restarted(model, away_s=5) == (True, 400 + (1 << 40), "")


@pytest.mark.parametrize("model", FAMILIES)
async def test_what_moved_meanwhile_is_seen(model: str) -> None:
    assert await restarted(model, away_s=5, moves=-900) == (True, 400 - 900 + (1 << 40), "")


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_restart_that_took_too_long_is_told(model: str) -> None:
    trusted, actual, reason = await restarted(model, away_s=300)
    assert (trusted, actual) == (False, 400 + (1 << 40))
    assert "looked at too late" in str(reason)


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_chip_that_was_reset_while_the_server_was_away_is_told(model: str) -> None:
    trusted, actual, reason = await restarted(model, away_s=5, power_cycle=True)
    assert (trusted, actual) == (False, 400 + (1 << 40))
    assert "the chip was reset" in str(reason)


@pytest.mark.parametrize("model", FAMILIES)
async def test_an_emulator_in_the_server_is_reset_with_it(model: str) -> None:
    async with server(Hardware(), model) as first:
        await first.service.go_to(first.device, 0, 400)
        await first.arrived(20)
        (saved,) = first.service.saved()
    async with server(Hardware(first.clock), model) as second:  # set up again at once, as the demo does
        second.service.restore([saved])
        second.service.sync(second.manager.devices)
        await second.clock.advance(1)
        state = second.seen()
        assert (state.trusted, state.actual) == (False, 400)
        assert "the chip was reset" in state.reason


async def test_a_loss_outlives_a_restart() -> None:
    hardware = Hardware()
    async with server(hardware, "tmc428") as first:
        await first.service.watch(first.device, 0)
        await first.stand(7)
        await first.clock.advance(1)
        (saved,) = first.service.saved()
    async with server(hardware, "tmc428", set_up=False) as second:
        second.service.restore([saved])
        second.service.sync(second.manager.devices)
        await second.clock.advance(1)
        assert "was written" in second.seen().reason


async def test_another_link_another_model_and_another_time_of_day_are_told() -> None:
    from dataclasses import replace

    hardware = Hardware()
    async with server(hardware, "tmc428") as first:
        await first.service.watch(first.device, 0)
        (saved,) = first.service.saved()
    for change, reason in (
        (replace(saved, link="{}"), "link was changed"),
        (replace(saved, model="tmc4210"), "saved of a tmc4210"),
        (replace(saved, seen_unix_s=saved.seen_unix_s + 1000), "clock was set back"),
    ):
        async with server(hardware, "tmc428", set_up=False) as second:
            second.service.restore([change])
            second.service.sync(second.manager.devices)
            await second.clock.advance(1)
            assert reason in second.seen().reason
            await second.service.confirm(second.device, 0)
            assert (await second.state()).trusted


async def test_a_device_that_gets_another_link_keeps_its_position_as_a_guess() -> None:
    from app.devices.manager import DeviceChange

    async with bench("tmc428") as b:
        await b.service.go_to(b.device, 0, 400)
        await b.arrived(20)
        await b.manager.edit(b.device.id, DeviceChange(link={"kind": "emulator", "chip": "another"}))
        await b.clock.advance(1)
        state = await b.state()
        assert (state.watching, state.trusted, state.actual) == (True, False, 400)
        assert "link was changed" in state.reason
        await b.manager.remove(b.device.id)
        assert b.service.saved() == []
