"""Programs through the driver: stored, read back, run, stepped, stopped, on good lines and bad ones."""

from __future__ import annotations

import random

import pytest

from app.calc.tmcl.instructions import Command
from app.devices.core.capabilities import ProgramMemory, TmclCommands
from app.devices.core.results import ProgramEvent
from app.errors import BadReply, LinkError, OutOfRange, UsageError, WriteRefused, WrongState
from app.links.tmcl import Request
from app.registers.tmcl.commands import CONTROL_FIRST, Opcode, Status
from tests.calc.tmcl_programs import ROUTINES, SUBROUTINE
from tests.devices.tmcl.harness import MOVERS, Bench, bench, state_of

LONG = "".join(f"CALC LOAD, {number * 77}\nAGP {number % 256}, 2\n" for number in range(60))


def _commands(made: Bench, text: str) -> list[Command]:
    assembly = made.part(ProgramMemory).assemble(text, {})
    assert not assembly.problems
    return assembly.commands


def _program(made: Bench) -> ProgramMemory:
    return made.part(ProgramMemory)


def _memory(made: Bench) -> list[bytes]:
    return list(made.module._firmware.eeprom.program.values())


@pytest.mark.parametrize("model", ["pd42-1241", "tmcm-1161"])
async def test_a_program_is_stored_read_back_run_and_watched(model: str) -> None:
    async with bench(model) as made:
        program = _program(made)
        commands = _commands(
            made, "CALC LOAD, 7\nCALCX LOAD\nCALC ADD, 1\nAGP 5, 2\nWAIT TICKS, 0, 10\nGAP 250, 0\nSTOP"
        )
        stored = await program.download(commands)
        assert (stored.address, stored.commands, stored.sent_again) == (0, 7, 0)
        assert state_of(made.device) == "connected"
        assert await program.read_program(0, 8) == [*commands, Command(0)]
        assert (await program.program_state()).status == "stopped"
        await program.run_program(0)
        await made.clock.advance(0.05)
        state = await program.program_state([5, 6])
        assert (state.status, state.counter, state.accumulator, state.x) == ("running", 4, 8, 7)
        assert state.variables == {5: 8, 6: 0}
        await made.clock.advance(0.2)
        state = await program.program_state()
        assert (state.status, state.counter, state.downloading) == ("stopped", 6, False)
        assert state.error == (Status.WRONG_TYPE if model == "pd42-1241" else None)


async def test_steps_and_a_reset() -> None:
    async with bench() as made:
        program = _program(made)
        await program.download(_commands(made, "CALC LOAD, 7\nCALC ADD, 1\nCALC ADD, 1\nSTOP"))
        for at in (1, 2):
            await program.step_program()
            state = await program.program_state()
            assert (state.status, state.counter, state.accumulator) == ("stepping", at, 6 + at)
        await program.reset_program()
        state = await program.program_state()
        assert (state.status, state.counter, state.accumulator) == ("stopped", 0, 0)


async def test_a_stop_of_the_axis_ends_the_program_that_would_move_it_again() -> None:
    async with bench() as made:
        program = _program(made)
        await program.download(_commands(made, SUBROUTINE))
        await program.run_program(0)
        await made.clock.advance(0.5)
        assert (await made.device.monitor.axis_state(0)).moving
        outcome = (await made.device.motion.stop_axes([0], "ramp"))[0]
        assert outcome.ok, outcome.problem
        assert (await program.program_state()).status == "stopped"
        here = await made.at_rest()
        await made.clock.advance(3.0)
        assert (await made.device.monitor.axis_state(0)).position == here


async def test_what_a_program_does_is_told_as_marks_with_device_time() -> None:
    async with bench() as made:
        program = _program(made)
        told: list[ProgramEvent] = []
        made.device.listen(lambda event: told.append(event) if isinstance(event, ProgramEvent) else None)
        await program.download(_commands(made, "WAIT TICKS, 0, 10\nSTOP"))
        await program.run_program(0)
        await program.stop_program()
        await program.step_program()
        await program.reset_program()
        await program.run_program()
        await made.device.monitor.axis_state(0)
        assert [event.text for event in told] == [
            "program begins at 0",
            "program stopped",
            "program: one command",
            "program reset",
            "program goes on",
        ]
        await made.clock.advance(0.2)  # it has ended by itself, and only a look at the axis tells
        state = await made.device.monitor.axis_state(0)
        assert (told[-1].text, told[-1].address) == ("program ended at 1", 1)
        assert told[-1].time_s == pytest.approx(state.time_s, abs=0.01)
        assert told[0].time_s < told[-1].time_s - 0.1
        asked = made.tap.count(Opcode.GGP)
        await made.device.monitor.axis_state(0)
        assert made.tap.count(Opcode.GGP) == asked, "no question more while no program runs"


async def test_stopping_the_program_leaves_the_motor_alone() -> None:
    async with bench() as made:
        program = _program(made)
        await program.download(_commands(made, ROUTINES))
        await program.run_program(2)
        await made.clock.advance(1.0)
        await program.stop_program()
        assert (await program.program_state()).status == "stopped"
        await made.clock.advance(8.0)
        assert (await made.device.monitor.axis_state(0)).velocity_pps == pytest.approx(1000, rel=0.01)


async def test_what_cannot_be_stored_is_refused_before_anything_is_sent() -> None:
    async with bench() as made:
        program = _program(made)
        before = made.tap.count(Opcode.ENTER_DOWNLOAD)
        for commands, address, error in (
            ([], 0, UsageError),
            ([Command(Opcode.STOP)], 2048, OutOfRange),
            ([Command(Opcode.STOP)] * 3, 2046, OutOfRange),
            ([Command(CONTROL_FIRST)], 0, OutOfRange),
        ):
            with pytest.raises(error):
                await program.download(commands, address)
        await made.device.motion.rotate(0, 5000)
        await made.clock.advance(0.2)
        with pytest.raises(WrongState, match="the motor moves"):
            await program.download([Command(Opcode.STOP)])
        assert made.tap.count(Opcode.ENTER_DOWNLOAD) == before


async def test_a_protected_memory_is_told() -> None:
    async with bench() as made:
        await made.part(TmclCommands).tmcl("SGP", 81, 0, 3)
        with pytest.raises(WrongState, match="locked"):
            await _program(made).download([Command(Opcode.STOP)])
        with pytest.raises(WrongState, match="locked"):
            await _program(made).read_program(0, 1)
        assert state_of(made.device) == "connected"


async def test_a_memory_that_holds_something_else_is_told() -> None:
    async with bench() as made:

        def swallow(request: Request, reply: bytes) -> bytes:
            if request.opcode == Opcode.READ_MEMORY and request.value == 1:
                return bytes((2, Opcode.ROR)) + bytes(7)
            return reply

        made.tap.spoil = swallow
        with pytest.raises(WriteRefused, match="command 1 of the program"):
            await _program(made).download(_commands(made, "STOP\nSTOP"))
        assert state_of(made.device) == "connected"


async def test_a_module_that_leaves_download_mode_ends_the_download() -> None:
    async with bench() as made:

        def restarts(request: Request, reply: bytes) -> bytes:
            if request.opcode == Opcode.CALC and request.value == 77 * 3:
                made.patch(power_cycle=True)
            return reply

        made.tap.spoil = restarts
        with pytest.raises(WrongState, match="instead of storing"):
            await _program(made).download(_commands(made, LONG))
        assert len(_memory(made)) < 10


async def test_lossy_lines_leave_the_program_whole_or_tell_it() -> None:
    whole = failed = 0
    for seed in range(25):
        rng = random.Random(seed)

        def lose(request: Request, reply: bytes, rng: random.Random = rng) -> bytes:
            if rng.random() < 0.01:
                return (
                    reply[:4]
                    if rng.random() < 0.5
                    else bytes((*reply[:4], reply[4] ^ 1 << rng.randrange(8), *reply[5:]))
                )
            return reply

        async with bench() as made:
            commands = _commands(made, LONG)
            made.tap.spoil = lose
            before = made.tap.count(*MOVERS)
            try:
                await _program(made).download(commands)
            except (LinkError, BadReply, WrongState):
                failed += 1
            else:
                whole += 1
                assert [made.module._firmware.eeprom.program[at] for at in range(len(commands))] == [
                    Request(1, *command).encode()[1:8] for command in commands
                ]
            assert made.tap.count(*MOVERS) == before
    assert whole + failed == 25
    assert whole >= 24
