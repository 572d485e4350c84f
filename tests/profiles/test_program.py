"""The program of a module in its profile: read back, written by hand, compared, stored as a part of the transaction."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from app.calc.tmcl.instructions import Command
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import ProgramMemory
from app.devices.core.config import AxisSettings
from app.devices.manager import DeviceChange
from app.emulators.tmcl.module import EmulatedModule
from app.errors import SoftLimit, WrongState
from app.links.tmcl import Request
from app.profiles import journal
from app.profiles.apply import Transaction
from app.profiles.capture import capture
from app.profiles.diff import compare, diff
from app.profiles.document import ProfileDocument, parse, plain, text_of
from app.profiles.errors import ProfileLeft, ProfileTakenBack, UnreadableProfile
from app.profiles.journal import FileJournal
from app.profiles.program import BLOCK, EMPTY, read_stored
from app.profiles.service import ProfileService
from app.registers.tmcl.commands import Opcode
from tests.profiles.harness import Bench, bench

MODEL = "pd42-1241"
THERE_AND_BACK = """\
#include TMCLParam.tmc
Loop:
    SAP APMaxPositioningSpeed, 0, 20000
    MVP ABS, 0, 5000   // there
    WAIT POS, 0, 0
    JA Loop
""".splitlines()


def program_of(source: list[str], **registers: int) -> ProfileDocument:
    """A profile of a program, and of a few parameters."""
    return parse(
        {
            "format": "stepscope-profile",
            "version": 1,
            "name": "with a program",
            "model": MODEL,
            "clock_hz": 16_000_000,
            "parameters": [{"name": name, "value": value} for name, value in registers.items()],
            "program": {"name": "there.tmc", "source": source},
        }
    )


async def stored(b: Bench) -> tuple[Command, ...]:
    return await read_stored(b.device)


async def apply(b: Bench, document: ProfileDocument, noted: Any = None) -> Any:
    return await Transaction(b.device, document, journal=noted).run()


# --- as a document ------------------------------------------------------------------------------


async def test_a_profile_of_a_module_has_the_program_of_its_memory() -> None:
    async with bench(MODEL) as b:
        assert (await capture(b.device, program=True)).program is None, "an empty memory says nothing"
        await apply(b, program_of(THERE_AND_BACK))
        commands = await stored(b)
        assert [command.opcode for command in commands] == [Opcode.SAP, Opcode.MVP, Opcode.WAIT, Opcode.JA]
        document = await capture(b.device, program=True)
        assert document.program is not None
        assert document.program.source[0] == "L0:"
        assert (await capture(b.device)).program is None, "only where it is asked for"
        again = parse(plain(document))
        assert again == document
        assert (await diff(b.device, document)).writes == 0


async def test_in_a_file_each_line_of_it_stands_on_a_line() -> None:
    text = text_of(program_of(["L: MVP ABS, 0, 1", "JA L"]))
    assert '    "source": [\n      "L: MVP ABS, 0, 1",\n      "JA L"\n    ]\n  },' in text
    assert '"program"' not in text_of(ProfileDocument(model="tmc428", clock_hz=16e6))


async def test_a_program_behind_an_empty_stretch_is_read_up_to_there() -> None:
    async with bench(MODEL) as b:
        memory = b.device.need(ProgramMemory)
        await memory.download([Command(Opcode.STOP, 0, 0, 0)])
        await memory.download([Command(Opcode.STOP, 0, 0, 0)], BLOCK - 1)
        await memory.download([Command(Opcode.STOP, 0, 0, 0)], 3 * BLOCK)
        assert len(await stored(b)) == BLOCK


async def test_a_protected_memory_is_told_as_not_known() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(THERE_AND_BACK))
        b.wire.emulator.exchange(Request(1, Opcode.SGP, 81, 0, 1).encode())
        document = await capture(b.device, program=True)
        assert document.program is None
        assert "program" in [part.name for part in document.unknown]


@pytest.mark.parametrize(
    ("model", "source", "told"),
    [
        (MODEL, ["ROX 1"], "no command is called ROX"),
        (MODEL, ["JA Nowhere"], "nothing is called Nowhere"),
        ("tmc5160", ["STOP"], "stores no program"),
    ],
)
def test_a_program_that_cannot_be_is_refused(model: str, source: list[str], told: str) -> None:
    document = program_of(source).model_copy(update={"model": model})
    with pytest.raises(UnreadableProfile, match=told):
        compare(document, document)


def test_two_profiles_are_compared_command_by_command() -> None:
    one, other = program_of(["MVP ABS, 0, 1", "STOP"]), program_of(["MVP ABS, 0, 2", "STOP", "STOP"])
    found = compare(one, other).program
    assert found is not None
    assert (found.left_commands, found.right_commands, found.differing) == (2, 3, 2)
    assert [(each.address, each.left, each.right) for each in found.commands] == [
        (0, "MVP ABS, 0, 1", "MVP ABS, 0, 2"),
        (2, "", "STOP"),
    ]
    assert compare(one, one).program is None
    silent = one.model_copy(update={"program": None})
    assert any("speaks of a program" in warning for warning in compare(one, silent).warnings)


# --- applied ------------------------------------------------------------------------------------


async def test_it_is_stored_with_the_parameters_and_read_back() -> None:
    async with bench(MODEL) as b:
        document = program_of(THERE_AND_BACK, maximum_positioning_speed=12_345)
        found = await diff(b.device, document)
        assert found.program is not None
        assert (found.program.left_commands, found.program.right_commands, found.writes) == (0, 4, 2)
        assert await stored(b) == (), "a comparison stores nothing"
        applied = await apply(b, document)
        assert (applied.stored, [change.name for change in applied.written]) == (4, ["maximum_positioning_speed"])
        assert len(await stored(b)) == 4
        again = await apply(b, document)
        assert (again.stored, again.written) == (None, [])


async def test_a_shorter_program_leaves_nothing_of_a_longer_one() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(["WAIT TICKS, 0, 1"] * 100))
        await apply(b, program_of(["STOP"]))
        assert len(await stored(b)) == 1
        assert set(await b.device.need(ProgramMemory).read_program(1, 120)) == {EMPTY}
        await apply(b, program_of([]))
        assert await stored(b) == ()


async def test_a_profile_that_is_silent_leaves_the_program() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(THERE_AND_BACK))
        await apply(b, program_of([], maximum_positioning_speed=999).model_copy(update={"program": None}))
        assert len(await stored(b)) == 4


async def test_what_runs_or_moves_is_not_written_over() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(["Loop: JA Loop"]))
        await b.device.need(ProgramMemory).run_program(0)
        with pytest.raises(WrongState, match="a program runs"):
            await apply(b, program_of(THERE_AND_BACK))


async def test_what_it_may_not_do_is_told_before_anything_is_written(tmp_path: Path) -> None:
    async with bench(MODEL) as b:
        axis = AxisSettings(limits=AxisLimits(position_min=-1000, position_max=1000))
        await b.manager.edit(b.device.id, DeviceChange(axes=(axis,)))
        before = b.truth()
        document = program_of(THERE_AND_BACK, maximum_positioning_speed=12_345)
        noted = FileJournal(journal.path_of(tmp_path, b.device.id), b.device, document)
        with pytest.raises(SoftLimit, match="1000"):
            await apply(b, document, noted)
        assert b.truth() == before
        assert await stored(b) == ()
        assert journal.read_all(tmp_path) == []


@pytest.mark.parametrize("at", [Opcode.SAP, Opcode.EXIT_DOWNLOAD, Opcode.READ_MEMORY])
async def test_a_line_that_fails_in_the_middle_brings_the_old_program_back(at: Opcode) -> None:
    """For a while: what is then told is all as before, and so it is."""
    async with bench(MODEL) as b:
        await apply(b, program_of(["MVP ABS, 0, 77", "STOP"]))
        before, old = b.truth(), await stored(b)
        left = [6]
        begun = [False]

        def spoil(frame: bytes, answered: Any) -> bytes:
            begun[0] = begun[0] or frame[1] == Opcode.ENTER_DOWNLOAD
            if begun[0] and frame[1] == at and left[0]:
                left[0] -= 1
                raise TimeoutError
            return bytes(answered(frame))

        b.wire.spoil = spoil
        with pytest.raises(ProfileTakenBack, match="program failed") as told:
            await apply(b, program_of(THERE_AND_BACK, maximum_positioning_speed=12_345))
        b.wire.spoil = None
        assert not isinstance(told.value, ProfileLeft), told.value
        assert await stored(b) == old
        assert b.truth() == before


async def test_a_parameter_that_fails_takes_the_program_back_too() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(["MVP ABS, 0, 77", "STOP"]))
        before, old = b.truth(), await stored(b)

        def spoil(frame: bytes, answered: Any) -> bytes:
            # The parameter is stored in the program, and refused outside of it.
            wrong = frame[1] == Opcode.SAP and frame[2] == 5 and frame[7] == 99
            return bytes(answered(Request(1, Opcode.SAP, 5, 0, -1).encode() if wrong else frame))

        b.wire.spoil = spoil
        with pytest.raises(ProfileTakenBack) as told:
            await apply(b, program_of(THERE_AND_BACK, maximum_acceleration=99))
        assert (told.value.failed["name"], told.value.left) == ("maximum_acceleration", [])
        b.wire.spoil = None
        assert await stored(b) == old
        assert b.truth() == before


async def test_where_the_old_program_cannot_be_brought_back_that_is_told() -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(["MVP ABS, 0, 77", "STOP"]))

        def spoil(frame: bytes, answered: Any) -> bytes:
            if frame[1] == Opcode.WAIT:
                spoil.gone = True  # type: ignore[attr-defined]  # the cable is out from here on
            if getattr(spoil, "gone", False):
                raise ConnectionError
            return bytes(answered(frame))

        b.wire.spoil = spoil
        with pytest.raises(ProfileLeft) as told:
            await apply(b, program_of(THERE_AND_BACK))
        assert [(change["name"], change["was"], change["now"], change["wanted"]) for change in told.value.left] == [
            ("program", 2, None, 4)
        ]


# --- after a crash ------------------------------------------------------------------------------


class Crash(BaseException):
    """The process is gone: nothing catches this."""


async def test_after_a_crash_the_old_program_can_be_brought_back(tmp_path: Path) -> None:
    async with bench(MODEL) as b:
        await apply(b, program_of(["MVP ABS, 0, 77", "STOP"]))
        before, old = b.truth(), await stored(b)

        def spoil(frame: bytes, answered: Any) -> bytes:
            if frame[1] == Opcode.WAIT:
                raise Crash
            return bytes(answered(frame))

        b.wire.spoil = spoil
        noted = FileJournal(journal.path_of(tmp_path, b.device.id), b.device, program_of(THERE_AND_BACK))
        with pytest.raises(Crash):
            await apply(b, program_of(THERE_AND_BACK, maximum_positioning_speed=12_345), noted)
        b.wire.spoil = None
        assert noted._file is not None
        noted._file.close()  # as the system does for a process that is gone
        # The process is gone, and with it whatever it would have done in the end; the module still stores.
        emulator = b.wire.emulator
        assert isinstance(emulator, EmulatedModule)
        emulator.exchange(Request(1, Opcode.EXIT_DOWNLOAD).encode())
        assert await stored(b) != old
        profiles = ProfileService(tmp_path, lambda _: "", _no_settings)
        unfinished = profiles.unfinished(b.device)
        assert unfinished is not None
        assert [(half.change.name, half.state) for half in unfinished.halves] == [
            ("program", "perhaps written"),
            ("maximum_positioning_speed", "not begun"),
        ]
        with pytest.raises(WrongState, match="did not come to its end"):
            await profiles.apply(b.device, program_of(THERE_AND_BACK))
        assert [change.name for change in await profiles.take_back(b.device)] == ["program"]
        assert await stored(b) == old
        assert b.truth() == before
        assert profiles.unfinished(b.device) is None


async def _no_settings(*_: Any) -> None:
    raise AssertionError("no settings differ")
