"""Parts of the driver alone, without a Device: a session, a link, and what each part takes besides."""

from __future__ import annotations

from typing import cast

import pytest

from app.calc.units.tmc5xxx import ACCELERATION_MAX, VELOCITY_MAX
from app.clock import VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.register_io import Snapshot
from app.devices.core.register_link import RegisterLink
from app.devices.core.results import MotionEnd
from app.devices.core.session import Session
from app.devices.tmc5xxx.decoded_registers import DecodedRegisters
from app.devices.tmc5xxx.events import Events
from app.devices.tmc5xxx.memory import ChipMemory
from app.devices.tmc5xxx.motions import Motions
from app.devices.tmc5xxx.predictions import Predictions
from app.devices.tmc5xxx.reader import ChipReader
from app.devices.tmc5xxx.roles import FORWARD, part, roles_of
from app.devices.tmc5xxx.signs import signs
from app.devices.tmc5xxx.standstill import Standstill
from app.emulators.build import build_emulator
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions
from app.errors import LinkDown
from app.links.emulator import EmulatorPort
from app.links.register_access import access_of
from tests.devices.tmc5xxx.harness import bench


def a_link(model: str) -> RegisterLink:
    clock = VirtualClock()
    config = DeviceConfig("Alone", model, {"kind": "emulator"})
    wire = build_emulator(model, clock, Tmc5xxxOptions(motor="rigid"))
    session = Session("alone", config, EmulatorPort(cast("EmulatedTmc5xxx", wire)), clock)
    return RegisterLink(session, access_of(config.link, config.model), session.family.table)


def test_a_word_that_cannot_be_read_is_known_once_it_was_written_or_the_chip_was_reset() -> None:
    memory = ChipMemory(a_link("tmc5130"), roles_of("tmc5130"))
    amax, mslutsel = memory.rows(0).amax, memory.rows(0).mslut[8]
    assert memory.word(amax) is None
    memory.sent(amax, 700)
    assert (memory.word(amax), memory.written(amax)) == (700, 700)
    memory.was_reset()
    assert memory.word(mslutsel) == mslutsel.reset != 0
    assert (memory.written(amax), memory.written(mslutsel)) == (None, None)


@pytest.mark.parametrize("clock_hz", [1.0, 1e3, 16e6])
async def test_a_remedy_for_an_unset_ramp_asks_no_more_than_the_clock_gives(clock_hz: float) -> None:
    async with bench(start=None) as b:
        told = signs(b.memory, clock_hz, 0, 0, await b.state(), 0.5)
    written = {
        name: remedy.body["value"]
        for name in ("VMAX", "AMAX")
        for sign in told.blocks
        for remedy in sign.remedies
        if remedy.body is not None and f"/{name}" in remedy.path
    }
    assert set(written) == {"VMAX", "AMAX"}
    assert 0 < cast("int", written["VMAX"]) <= VELOCITY_MAX
    assert 0 < cast("int", written["AMAX"]) <= ACCELERATION_MAX


def test_what_a_command_writes_over_vmax_is_not_what_the_user_wants() -> None:
    memory = ChipMemory(a_link("tmc5160"), roles_of("tmc5160"))
    vmax = memory.rows(0).vmax
    memory.sent(vmax, 900)
    memory.overwrite(vmax, 0)
    assert (memory.word(vmax), memory.wanted(vmax), memory.overwritten(vmax)) == (0, 900, True)
    memory.overwrite(vmax, 900)
    assert not memory.overwritten(vmax)
    memory.overwrite(vmax, 0)
    memory.sent(vmax, 5)
    assert (memory.wanted(vmax), memory.overwritten(vmax)) == (5, False)


def test_memory_forgets_with_the_link_what_can_be_read_again() -> None:
    memory = ChipMemory(a_link("tmc5160"), roles_of("tmc5160"))
    rows = memory.rows(0)
    memory.saw_word(rows.rampmode, FORWARD)
    memory.sent(rows.vmax, 900)
    memory.heard_state("failed", LinkDown("x", "gone"))
    assert (memory.known(rows.rampmode), memory.word(rows.vmax)) == (None, 900)


@pytest.mark.parametrize("model", ["tmc5072", "tmc5160"])
def test_a_flag_that_the_driver_took_is_owed_until_its_user_has_it(model: str) -> None:
    link, chip, resets = a_link(model), roles_of(model), list[str]()
    log = Events(link.session, chip, (lambda: resets.append("first"), lambda: resets.append("second")))
    reset, stat = part(chip.gstat, "reset").mask, chip.axes[0].ramp_stat
    arrived = part(stat, "event_pos_reached").mask
    log.saw(Snapshot((stat, chip.gstat), (arrived, reset)), 1.0)
    assert resets == ["first", "second"]
    assert (log.resets, log.lost) == (1, False)  # that of its power-on
    for register, bits in log.to_clear([0], stall=False):
        log.cleared(register, bits)
    assert (log.shown(stat, 0), log.shown(chip.gstat, 0)) == (arrived, reset)
    log.saw(Snapshot((stat, chip.gstat), (arrived, 0)), 2.0)
    names = [name for entry in log.events(0).events for name in entry.names]
    assert names.count("event_pos_reached") == 2  # once cleared, it has come again
    if chip.clears_on_read:
        log.delivered(stat)
    else:
        log.sent(stat, arrived)
    assert log.shown(stat, 0) == 0


async def test_ramp_stat_is_left_alone_while_a_stall_may_hold_an_axis_that_would_go_on() -> None:
    link = a_link("tmc5130")
    memory = ChipMemory(link, roles_of("tmc5130"))
    decoded = DecodedRegisters(link.session, memory)
    log = Events(link.session, memory.chip, (memory.was_reset,))
    reader = ChipReader(link, memory, decoded, log)
    rows = memory.rows(0)
    assert not reader.may_read_stat(0)  # nobody knows SW_MODE yet
    async with link.turn() as turn:
        io = link.io(turn)
        await reader.peek(io, [0])
        assert rows.ramp_stat.address in (await reader.peek(io, [0])).words
        await io.write(rows.sw_mode, part(rows.sw_mode, "sg_stop").mask)
        await reader.peek(io, [0])
        assert rows.ramp_stat.address not in (await reader.peek(io, [0])).words
        assert log.polled_stat(0) is None
        await Standstill(link.session, memory).keep(io, 0)
        assert rows.ramp_stat.address in (await reader.peek(io, [0])).words


def test_a_motion_wakes_the_poller_and_ends_with_the_link() -> None:
    link, woken = a_link("tmc5160"), list[str]()
    motions = Motions(link.session, Predictions(link.session))
    motions.wake = lambda: woken.append("awake")
    motions.heard_state("connected", None)
    motions.of(0).began("position", 0.0, 500)
    assert woken == ["awake", "awake"]
    told: list[object] = []
    link.session.listen(told.append)
    motions.heard_state("failed", LinkDown("x", "gone"))
    assert [end.reason for end in told if isinstance(end, MotionEnd)] == ["lost_link"]
    assert motions.to_poll()  # the flags that came with it shall not wait
    motions.polled()
    assert not motions.to_poll()
