"""Parts of the driver alone, without a Device: a session, a link, and what each part takes besides."""

from __future__ import annotations

from app.clock import VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.register_link import RegisterLink
from app.devices.core.session import Session
from app.devices.tmc4361 import roles
from app.devices.tmc4361.cruise import Cruise
from app.devices.tmc4361.events import Events
from app.devices.tmc4361.expected_motion import ExpectedMotion
from app.devices.tmc4361.memory import ChipMemory
from app.emulators.tmc4361 import EmulatedTmc4361
from app.errors import LinkDown
from app.links.emulator import EmulatorPort
from app.links.register_access import access_of
from app.registers.tmc4361.general import RESET_CODE


def a_link() -> RegisterLink:
    clock = VirtualClock()
    config = DeviceConfig("Alone", "tmc4361", {"kind": "emulator"})
    session = Session("alone", config, EmulatorPort(EmulatedTmc4361(clock)), clock)
    return RegisterLink(session, access_of(config.link, config.model), session.family.table)


def test_memory_forgets_words_with_the_link_but_not_what_was_written() -> None:
    link = a_link()
    memory = ChipMemory(link, Cruise())
    pid_p = link.table.get("PID_P", roles.AXIS)
    memory.saw(roles.AMAX, 77)
    memory.sent(pid_p, 99)
    link.session.set_state("failed", LinkDown("x", "gone"))
    assert (memory.known(roles.AMAX), memory.kept_word(pid_p)) == (None, 99)


def test_a_reset_by_hand_clears_the_shadow_and_tells_the_hooks_once() -> None:
    link = a_link()
    memory, told = ChipMemory(link, Cruise()), list[str]()
    memory.reset_hooks.append(lambda: told.append("reset"))
    pid_p = link.table.get("PID_P", roles.AXIS)
    memory.sent(pid_p, 99)
    assert memory.word_unread(pid_p) == 99
    memory.sent(roles.RESET, roles.part(roles.RESET, "RESET_REG").pack(RESET_CODE))
    assert told == ["reset"]
    assert memory.kept_word(pid_p) is None
    assert memory.word_unread(pid_p) == pid_p.reset


def test_what_a_command_writes_over_vmax_is_not_what_the_user_wants() -> None:
    cruise = Cruise()
    memory = ChipMemory(a_link(), cruise)
    memory.saw(roles.VMAX, 5_000)
    cruise.overwrite_vmax(0)
    memory.saw(roles.VMAX, 0)
    assert memory.as_set(roles.VMAX, 0) == 5_000
    memory.saw(roles.VMAX, 700)
    assert memory.as_set(roles.VMAX, 700) == 700


async def test_peeking_clears_a_reset_alone_and_clearing_tells_first() -> None:
    link = a_link()
    events = Events(link, ChipMemory(link, Cruise()))
    async with link.turn() as turn:
        io = link.io(turn)
        await events.peek(io)
        assert not events.has("RST_EV")  # it was told, and is to be seen to come again
        await io.write_many([(roles.XACTUAL, 100), (roles.XTARGET, 100)])
        await events.peek(io)
        seen = events.present
        assert events.has("TARGET_REACHED")
        await events.peek(io)
        assert events.present == seen
        await events.clear(io, roles.event("TARGET_REACHED"))
        await events.peek(io)
    assert not events.has("TARGET_REACHED")
    assert events._owed is None
    told = [name for entry in events.events(0).events for name in entry.names]
    assert (told.count("RST_EV"), told.count("TARGET_REACHED")) == (1, 1)
    assert events.resets == 1


def test_an_expected_motion_wakes_the_poller_and_ends_with_the_link() -> None:
    session = a_link().session
    expected, woken = ExpectedMotion(session), list[str]()
    expected.begun_hooks.append(lambda: woken.append("poll"))
    expected.uncertain("nobody knows")
    assert woken == ["poll"]
    assert expected.watch.under_way is not None
    assert expected.book.present() is None
