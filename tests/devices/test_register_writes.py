"""Every write is read back: what the chip holds afterwards is what was sent, or the answer says why not."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.devices.core.lookup import modify
from app.devices.core.results import RegisterWritten, WriteItem
from app.errors import BenchError, OutOfRange, UnknownThing, UsageError, WriteRefused, WrongState
from app.links import datagram32
from app.registers.catalog import CHIPS_32, MODELS
from app.registers.model import Access, Register
from tests.devices.harness import Bench, bench

REGISTERS = [(model, register) for model in CHIPS_32 for register in CHIPS_32[model].table]
WRITABLE = [(model, register) for model, register in REGISTERS if register.access.writable]
READ_ONLY = [(model, register) for model, register in REGISTERS if not register.access.writable]


def name_of(case: object) -> str:
    return f"{case.name}.{case.axis}" if isinstance(case, Register) else str(case)


def chip_word(b: Bench, register: Register) -> int:
    """What the chip itself holds, past the driver."""
    reply = b.wire.exchange(datagram32.read(register.address))
    return datagram32.Reply.decode(reply).data & register.mask


async def outcome(b: Bench, register: Register, value: int) -> RegisterWritten | BenchError:
    try:
        return await b.device.registers.write(register.name, register.axis, value=value)
    except BenchError as error:
        return error


def values(register: Register) -> st.SearchStrategy[int]:
    edges = [register.minimum, register.maximum, 0, 1]
    return st.one_of(
        st.sampled_from(edges),
        st.integers(register.minimum, register.maximum),
        st.integers(register.minimum, register.maximum).map(lambda value: value & register.mask),
        st.integers(-(1 << 25), 1 << 25),
    )


@pytest.mark.parametrize(("model", "register"), WRITABLE, ids=name_of)
def test_what_reads_back_equals_or_is_reported(model: str, register: Register) -> None:
    # One chip for all examples of a register: what one left behind is a state for the next.
    with asyncio.Runner() as runner:
        around = bench(model, started=False)
        b = runner.run(around.__aenter__())

        @settings(max_examples=20, deadline=None)
        @given(value=values(register), mode=st.integers(0, 3), v_max=st.sampled_from([0, 900]))
        def check(value: int, mode: int, v_max: int) -> None:
            runner.run(prepare(b, mode, v_max))
            judge(b, register, value, runner.run(outcome(b, register, value)))

        check()
        runner.run(around.__aexit__(None, None, None))


async def prepare(b: Bench, mode: int, v_max: int) -> None:
    """Some ramp mode, able to move or not; and time for what was started before."""
    rows = b.chip.rows[0]
    await b.device.registers.write(rows.reference.name, 0, fields={rows.mode.name: mode})
    await b.device.registers.write("v_max", 0, value=v_max)
    await b.device.registers.write("a_max", 0, value=100)
    await b.clock.advance(0.01)


def judge(b: Bench, register: Register, value: int, written: RegisterWritten | BenchError) -> None:
    if isinstance(written, WriteRefused | WrongState):
        assert register.volatile or register.name == "cover_datagram", written
        return
    if isinstance(written, BenchError):
        assert isinstance(written, OutOfRange), written
        in_range = register.minimum <= value <= register.maximum
        broken = [
            part.name
            for part in register.fields
            if part.access.writable and not part.minimum <= part.unpack(value) <= part.maximum
        ]
        assert not in_range or broken or value & ~register.mask, written
        return
    assert written.written & ((1 << register.width) - 1) == value & ((1 << register.width) - 1)
    if register.access is Access.W:
        assert written.verified is None
        return
    assert written.raw == chip_word(b, register)
    if written.verified is None:
        assert written.note
        return
    assert written.verified
    for part in register.fields:
        if part.access is Access.RW and part.name != "cover_pos":
            assert written.fields[part.name] == part.unpack(value)
    if not register.fields:
        assert written.value == value


@pytest.mark.parametrize(("model", "register"), READ_ONLY, ids=name_of)
async def test_read_only_is_refused_before_anything_is_sent(model: str, register: Register) -> None:
    async with bench(model, started=False) as b:
        sent = sum(b.device.session.queue.counts.frames)
        with pytest.raises(WrongState, match="read only"):
            await b.device.registers.write(register.name, register.axis, value=0)
        assert sum(b.device.session.queue.counts.frames) == sent


@given(word=st.integers(0, 0xFFFF), mask=st.sampled_from(["MASK_POS_END", "MASK_STOP"]), value=st.integers(0, 1))
def test_a_changed_mask_never_clears_a_flag(word: int, mask: str, value: int) -> None:
    register = MODELS["tmc428"].table.get("interrupt_mask_interrupt_flags", 0)
    part = register.field_named(mask)
    assert part is not None
    sent = modify(register, word, [(part, value)])
    assert sent & 0xFF == 0
    assert sent >> 8 == (word >> 8 & ~(part.mask >> 8)) | value << part.lsb - 8


@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.parametrize("model", list(CHIPS_32))
async def test_changing_a_mask_leaves_the_flags_and_a_flag_is_cleared_by_a_one(model: str) -> None:
    async with bench(model) as b:
        await b.device.registers.write("interrupt_mask_interrupt_flags", 0, fields={"mask_pos_end": 1})
        await b.device.motion.move(0, 100)
        await b.at_rest()
        await b.device.registers.write("interrupt_mask_interrupt_flags", 0, fields={"mask_stop": 1})
        assert (await b.device.registers.read("int_pos_end", 0)).value == 1
        cleared = await b.device.registers.write("int_pos_end", 0, value=1)
        assert cleared.verified
        assert cleared.value == 0
        assert (await b.device.registers.read("mask_pos_end", 0)).value == 1


async def test_names_without_case_and_fields_by_their_own_name() -> None:
    async with bench() as b:
        assert (await b.device.registers.write("V_Max", 2, value=77)).value == 77
        assert (await b.device.registers.read("v_MAX", 2)).value == 77
        assert (await b.device.registers.read("v_max", 0)).value == 1500
        written = await b.device.registers.write("PMUL", 1, value=33)
        assert (written.name, written.value, written.fields["pmul"]) == ("pmul", 33, 33)
        reading = await b.device.registers.read("Ramp_Div", 1)
        assert (reading.name, reading.value, reading.fields["pulse_div"]) == ("ramp_div", 6, 4)


async def test_enumerated_names_are_numbers_too() -> None:
    async with bench() as b:
        assert (await b.device.registers.write("lp_ref_conf_rm", 0, fields={"rm": "hold_mode"})).fields["rm"] == 3
        assert (await b.device.registers.write("rm", 0, fields={"rm": "RAMP_MODE"})).value == 0
        with pytest.raises(OutOfRange, match="VELOCITY_MODE") as caught:
            await b.device.registers.write("rm", 0, fields={"rm": "WARP_MODE"})
        assert (caught.value.minimum, caught.value.maximum) == (0, 3)


@pytest.mark.parametrize(
    ("name", "axis", "value", "fields", "error", "text"),
    [
        ("v_max", 0, 2048, None, OutOfRange, r"v_max is 2048, allowed is 0\.\.2047"),
        ("v_max", 0, -1, None, OutOfRange, r"0\.\.2047"),
        ("x_target", 0, 1 << 23, None, OutOfRange, "-8388608..8388607"),
        ("pulse_div", 0, 14, None, OutOfRange, r"0\.\.13"),
        ("pulse_div_ramp_div_usrs", 0, 0xE000, None, OutOfRange, r"pulse_div is 14"),
        ("lp_ref_conf_rm", 0, 0x80, None, OutOfRange, "bits 0x80 mean nothing"),
        ("nothing", 0, 1, None, UnknownThing, "no register is called 'nothing'"),
        ("v_max", 3, 1, None, UnknownThing, "axis"),
        ("v_max", None, 1, None, UsageError, "say which"),
        ("v_max", 0, None, None, UsageError, "either"),
        ("v_max", 0, 1, {"a": 1}, UsageError, "either"),
        ("rm", 0, None, {}, UsageError, "no field"),
        ("rm", 0, None, {"speed": 1}, UnknownThing, "speed"),
        ("rm", 0, None, {"rm": 1, "RM": 2}, UsageError, "twice"),
        ("rm", 0, None, {"lp": 1}, WrongState, "read only"),
        ("pmul_pdiv", 0, None, {"pmul": 128}, OutOfRange, r"0\.\.127"),
    ],
)
async def test_what_cannot_be_written_names_its_limits(
    name: str,
    axis: int | None,
    value: int | None,
    fields: dict[str, int | str] | None,
    error: type[Exception],
    text: str,
) -> None:
    async with bench() as b:
        sent = sum(b.device.session.queue.counts.frames)
        with pytest.raises(error, match=text):
            await b.device.registers.write(name, axis, value=value, fields=fields)
        assert sum(b.device.session.queue.counts.frames) == sent


@pytest.mark.sheet("DS-TMC428", "8.6")
async def test_v_actual_is_written_in_hold_mode_only() -> None:
    async with bench() as b:
        with pytest.raises(WriteRefused, match="HOLD_MODE only"):
            await b.device.registers.write("v_actual", 0, value=100)
        await b.device.registers.write("rm", 0, fields={"rm": "HOLD_MODE"})
        assert (await b.device.registers.write("v_actual", 0, value=-100)).verified
        assert (await b.device.registers.read("v_actual", 0)).value == -100


@pytest.mark.sheet("DS-TMC428", "8.5")
async def test_v_target_belongs_to_the_ramp_generator_outside_velocity_mode() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 100_000)
        await b.clock.advance(0.1)
        written = await b.device.registers.write("v_target", 0, value=3)
        await b.clock.advance(0.1)
        assert (await b.device.monitor.axis_state(0)).velocity_pps > 5000
        assert written.verified is None or written.value == 3
        await b.device.registers.write("rm", 0, fields={"rm": "VELOCITY_MODE"})
        assert (await b.device.registers.write("v_target", 0, value=-55)).verified


@pytest.mark.sheet("DS-TMC428", "8.16")
async def test_x_latched_is_armed_by_any_write_and_keeps_its_value() -> None:
    async with bench() as b:
        written = await b.device.registers.write("x_latched", 0, value=1234)
        assert (written.verified, written.value) == (None, 0)
        assert "armed" in written.note
        assert (await b.device.registers.read("lp", 0)).value == 1


@pytest.mark.sheet("DS-TMC428", "9.2")
async def test_cover_pos_reads_back_one_more_and_is_not_moved_by_that() -> None:
    async with bench() as b:
        written = await b.device.registers.write("cover_pos_cover_len", fields={"cover_pos": 7, "cover_len": 3})
        assert written.verified
        assert written.fields == {"cover_len": 3, "cover_pos": 8, "cw": 0}
        assert (await b.device.registers.write("cover_len", value=5)).fields["cover_pos"] == 8


@pytest.mark.sheet("DS-TMC428", "8.14")
async def test_pulse_div_outside_ramp_mode_is_told() -> None:
    async with bench() as b:
        assert (await b.device.registers.write("pulse_div", 0, value=5)).note == ""
        await b.device.registers.write("rm", 0, fields={"rm": "VELOCITY_MODE"})
        assert "microstep" in (await b.device.registers.write("pulse_div", 0, value=6)).note
        assert (await b.device.registers.write("ramp_div", 0, value=7)).note == ""


@pytest.mark.sheet("DS-TMC428", "8.2")
async def test_x_actual_in_ramp_mode_is_told_to_start_the_motor() -> None:
    async with bench() as b:
        written = await b.device.registers.write("x_actual", 0, value=500)
        assert "drives to x_target" in written.note
        await b.at_rest()
        assert (await b.device.monitor.axis_state(0)).position == 0


@pytest.mark.sheet("DS-TMC428", "8.7")
async def test_a_max_0_while_turning_is_told() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(0.5)
        assert "immediate stop" in (await b.device.registers.write("a_max", 0, value=0)).note


@pytest.mark.sheet("DS-TMC428", "9.5")
async def test_power_down_is_not_read_back_because_that_would_wake_the_chip() -> None:
    async with bench() as b:
        written = await b.device.registers.write("power_down", value=0)
        assert written.verified is None
        assert b.wire.state().powered_down
        with pytest.raises(WrongState, match="write only"):
            await b.device.registers.read("power_down")


async def test_two_writers_at_once_lose_nothing() -> None:
    async with bench() as b:
        bits = ["DISABLE_STOP_L", "DISABLE_STOP_R", "SOFT_STOP", "REF_RnL"]
        await b.device.registers.write("lp_ref_conf_rm", 0, value=0)
        await asyncio.gather(*(b.device.registers.write("lp_ref_conf_rm", 0, fields={bit: 1}) for bit in bits))
        assert (await b.device.registers.read("lp_ref_conf_rm", 0)).value == 0xF00


async def test_a_batch_ends_at_the_first_failure_and_says_how_far_it_came() -> None:
    async with bench() as b:
        result = await b.device.registers.write_many(
            [WriteItem("v_max", 0, 1), WriteItem("v_max", 0, 9999), WriteItem("v_max", 0, 3), WriteItem("v_min", 0, 1)]
        )
        assert [written.value for written in result.done] == [1]
        assert isinstance(result.failed, OutOfRange)
        assert result.not_tried == 2
        assert (await b.device.registers.read("v_max", 0)).value == 1


@pytest.mark.parametrize("model", list(CHIPS_32))
async def test_read_all_is_every_readable_register(model: str) -> None:
    async with bench(model) as b:
        everything = await b.device.registers.read_all()
        assert [(r.name, r.axis) for r in everything] == [
            (r.name, r.axis) for r in b.device.family.table if r.access.readable
        ]
        for reading, register in zip(everything, (r for r in b.device.family.table if r.access.readable), strict=True):
            assert reading.raw == chip_word(b, register)
        of_axis = await b.device.registers.read_all(0)
        assert {r.axis for r in of_axis} == {0}


async def test_a_raw_datagram_is_told_in_words() -> None:
    async with bench() as b:
        answer = await b.device.raw.exchange(bytes.fromhex("07000000"))
        assert answer.decoded["register"] == "v_max"
        assert (answer.decoded["rw"], answer.decoded["value"], answer.decoded["axis"]) == ("read", 1500, 0)
        written = await b.device.raw.exchange(datagram32.write(0x2C, 0x5706))
        assert written.decoded["fields"] == {"usrs": 6, "ramp_div": 7, "pulse_div": 5}
        assert b.device.axes[2].pulse_div == 5
        unused = await b.device.raw.exchange(datagram32.read(0x0F))
        assert (unused.decoded["register"], unused.decoded["data"]) == (None, 0)
        for length in (0, 3, 5):
            with pytest.raises(OutOfRange, match="frame length"):
                await b.device.raw.exchange(bytes(length))
