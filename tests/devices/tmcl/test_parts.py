"""Parts of the driver of TMCL modules alone, without a device, and the shape of them all."""

from __future__ import annotations

import inspect

import pytest

from app.clock import VirtualClock
from app.devices.core.background_tasks import BackgroundTasks
from app.devices.core.changes import RegisterChanged
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.session import Session
from app.devices.core.tmcl_link import TmclLink
from app.devices.tmcl.borrowed import BorrowedAcceleration
from app.devices.tmcl.counter import TickTimer, counter_writes
from app.devices.tmcl.family import FAMILY
from app.devices.tmcl.ongoing import OngoingMotion
from app.devices.tmcl.records import Records
from app.devices.tmcl.state import ModuleState
from app.errors import LinkDown, WriteRefused
from app.links.tmcl import Request
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import Tap, module_port

METHODS_MAX, ANCESTORS_MAX = 30, 2


def session_of(model: str = "pd42-1241") -> Session:
    """A session with an emulated module, and nothing of a driver."""
    clock = VirtualClock()
    link = {"kind": "emulator"}
    session = Session("module", DeviceConfig("Module", model, link), module_port(model, link, clock), clock)
    session.set_state("connected")
    return session


def own_of(borrowed: BorrowedAcceleration) -> int | None:
    """As a type checker that remembers earlier comparisons must not narrow it."""
    return borrowed.own


def tap_of(session: Session) -> Tap:
    tap = session.port.wire  # type: ignore[attr-defined]
    assert isinstance(tap, Tap)
    return tap


def test_a_state_counts_in_the_unit_mode_that_was_seen() -> None:
    state = ModuleState(session_of())
    assert state.speed_unit_pps == 1.0, "pps as long as nobody has seen it"
    state.saw(state.roles.unit_mode, 0)
    assert state.speed_unit_pps == pytest.approx(16e6 / 2**24)
    state.forget((state.roles.unit_mode.address,))
    assert state.unit_mode is None


def test_a_state_tells_the_axis_its_microsteps() -> None:
    session = session_of()
    state = ModuleState(session)
    state.saw(state.roles.microsteps, 4)
    assert session.axes[0].microsteps_per_full_step == 16
    assert state.mechanics(0).microsteps_per_full_step == 16


def test_a_state_forgets_with_a_failed_link_and_only_then() -> None:
    state = ModuleState(session_of())
    state.saw(state.roles.max_speed, 700)
    state.lacking.add(state.roles.ticks)
    state.on_state("connecting", None)
    assert state.last(state.roles.max_speed) == 700
    state.on_state("failed", LinkDown("wire", "unplugged"))
    assert state.last(state.roles.max_speed) is None
    assert state.lacking.rows == []


async def test_a_link_tells_the_state_what_it_was_answered() -> None:
    session = session_of()
    state = ModuleState(session)
    heard: list[tuple[str, int]] = []
    state.saw_hooks.append(lambda register, value: heard.append((register.name, value)))
    async with TmclLink(session, state, BackgroundTasks()).calls() as calls:
        value = await calls.get(state.roles.max_speed)
    assert heard == [(state.roles.max_speed.name, value)]
    assert state.last(state.roles.max_speed) == value


def test_records_tell_a_clipped_value_from_one_that_was_not_taken() -> None:
    session = session_of()
    state = ModuleState(session)
    records, row = Records(session, state), state.roles.max_current
    assert records.judge(row, 200, 200)[0] is True
    assert records.judge(row, 200, 100) == (False, "the module took it as 100: clipped")
    with pytest.raises(WriteRefused):
        records.judge(row, 100, 200)


def test_records_tell_of_a_change_with_both_values() -> None:
    session = session_of()
    state = ModuleState(session)
    told: list[DeviceEvent] = []
    session.listen(told.append)
    Records(session, state).tell_change(state.roles.target_position, -5, -7)
    (change,) = told
    assert isinstance(change, RegisterChanged)
    assert (change.old, change.new) == (-5, -7)


async def test_a_borrowed_acceleration_comes_back_at_rest() -> None:
    session = session_of()
    state, tasks = ModuleState(session), BackgroundTasks()
    link = TmclLink(session, state, tasks)
    borrowed = BorrowedAcceleration(session, state, link, Records(session, state), tasks)
    row = state.roles.max_acceleration
    async with link.calls() as calls:
        before = await calls.get(row)
        assert await borrowed.raise_it(calls) is None
        assert await calls.get(row) > before
    assert own_of(borrowed) == before
    await tasks.end()
    await borrowed.give_back_at_rest()
    assert own_of(borrowed) == before, "nobody has seen the motor rest"
    async with link.calls() as calls:
        assert await calls.get(state.roles.actual_speed) == 0
    await borrowed.give_back_at_rest()
    assert own_of(borrowed) is None
    async with link.calls() as calls:
        assert await calls.get(row) == before


def test_a_motion_that_somebody_else_began_is_polled() -> None:
    session = session_of()
    state = ModuleState(session)
    ongoing = OngoingMotion(session, state)
    begun: list[bool] = []
    ongoing.began_hooks.append(lambda: begun.append(ongoing.moves))
    ongoing.on_seen(state.roles.actual_speed, 0)
    assert begun == []
    ongoing.on_seen(state.roles.actual_speed, -20)
    assert begun == [True]
    ongoing.on_seen(state.roles.actual_speed, -30)
    assert begun == [True]


def test_flags_that_a_read_clears_are_kept_until_the_next_command() -> None:
    session = session_of()
    state = ModuleState(session)
    ongoing = OngoingMotion(session, state)
    session.listen(ongoing.on_event)
    ongoing.on_seen(state.roles.extended_error_flags, 1)
    ongoing.on_seen(state.roles.extended_error_flags, 0)
    assert ongoing.latched == 1
    session.commanded(0, "move")
    assert ongoing.latched == 0


def test_a_lost_link_ends_a_motion_as_lost() -> None:
    session = session_of()
    ongoing = OngoingMotion(session, ModuleState(session))
    ongoing.drives("velocity", 0.0, None)
    ongoing.on_state("failed", LinkDown("wire", "unplugged"))
    assert ongoing.driven is None
    assert [end.reason for end in ongoing.watch.ends] == ["lost_link"]


async def test_a_timer_that_starts_again_tells_of_a_reset() -> None:
    session = session_of()
    state = ModuleState(session)
    link, ticks = TmclLink(session, state, BackgroundTasks()), TickTimer(session, state)
    assert isinstance(session.clock, VirtualClock)
    seen = []
    for value in (None, None, 0):
        await session.clock.advance(5.0)
        if value is not None:
            tap_of(session).module.exchange(Request(1, Opcode.SGP, 132, 0, value).encode())
        async with link.calls() as calls:
            seen.append(await ticks.reset_since(calls))
    assert seen == [None, False, True]
    assert ticks.resets == 1


@pytest.mark.parametrize(
    ("what", "writes"),
    [
        ("set_position", True),
        ("actual_position", True),
        ("SAP 1, 0, 5", True),
        ("RFS START, 0", True),
        ("MST 0", False),
    ],
)
def test_commands_after_which_the_counter_shows_another_number(what: str, writes: bool) -> None:
    assert counter_writes(ModuleState(session_of()).roles)(what) is writes


OURS = ("app.devices.tmcl.", "app.devices.core.tmcl_")


@pytest.mark.parametrize("model", FAMILY.models)
def test_parts_stay_small_and_have_few_ancestors(model: str) -> None:
    session = session_of(model)
    device: Device = FAMILY.compose("module", session.config, session.port, session.clock)
    parts = (device.identity, device.registers, device.raw, device.motion, device.monitor, device.counter)
    of_parts = {type(part) for part in (*parts, device.telemetry)}
    # What they are made of: everything of ours that they hold, however deep.
    waiting = [*parts, device.telemetry]
    while waiting:
        for held in vars(waiting.pop()).values():
            kind = type(held)
            if kind.__module__.startswith(OURS) and hasattr(held, "__dict__") and kind not in of_parts:
                of_parts.add(kind)
                waiting.append(held)
    of_parts = {kind for kind in of_parts if kind.__module__.startswith(OURS)}
    assert {ModuleState, TmclLink, OngoingMotion, Records, BorrowedAcceleration} < of_parts
    for kind in of_parts:
        ours = [base for base in kind.__mro__[1:] if base.__module__.startswith("app.")]
        assert len(ours) <= ANCESTORS_MAX, kind
        own = [name for name, value in vars(kind).items() if inspect.isfunction(value) or isinstance(value, property)]
        assert len(own) <= METHODS_MAX, kind
