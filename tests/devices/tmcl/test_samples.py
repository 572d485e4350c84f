"""Telemetry: each thing asked once, deviations of one moment, and never a number out of a wrong answer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.devices.core.tmcl_samples import values_of
from app.devices.tmcl.roles import RegisterRoles
from app.devices.tmcl.samples import Quantities
from app.errors import UnknownThing, UsageError
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES
from tests.devices.tmcl.harness import bench

EVERY = [f"{quantity}.0" for quantity in Quantities(RegisterRoles(MODULES["pd42-1241"])).units]
FRAMES = tuple(Request(1, Opcode.GAP, number).encode() for number in (1, 3, 209))


async def test_only_what_the_channels_need_is_asked_and_each_thing_once() -> None:
    async with bench() as b:
        asked = {
            ("position.0",): [1],
            ("position.0", "velocity.0", "switch_left.0"): [1, 3, 11],
            ("deviation.0",): [1, 209, 1],
            ("encoder_position.0", "position.0", "deviation.0"): [1, 209, 1],
            ("deviation.0", "external_deviation.0"): [1, 209, 1, 216, 1],
            ("residual.0", "predicted_position.0"): [3, 1],
        }
        for channels, numbers in asked.items():
            frames = b.device.telemetry.sample_plan(channels).frames
            assert [Request.decode(frame).type for frame in frames] == numbers
        with pytest.raises(UnknownThing):
            b.device.telemetry.sample_plan(["acceleration.0"])
        with pytest.raises(UsageError):
            b.device.telemetry.sample_plan([])


async def test_every_channel_agrees_with_the_axis_state() -> None:
    async with bench() as b:
        await b.device.motion.move(0, -100_000)
        await b.clock.advance(0.7)
        plan = b.device.telemetry.sample_plan(EVERY)
        replies = b"".join([await b.device.session.queue.exchange(frame) for frame in plan.frames])
        row = dict(zip(EVERY, plan.decode(np.array([b.device.device_time_s()]), replies)[0], strict=True))
        state = await b.device.monitor.axis_state(0)
        assert row["position.0"] == state.position < -1000
        assert row["target_position.0"] == -100_000
        assert row["velocity.0"] == state.velocity_pps
        assert row["encoder_position.0"] == state.encoder_position
        assert row["deviation.0"] == state.deviation
        assert row["external_deviation.0"] == state.external_deviation
        assert row["driver_flags.0"] == 0
        assert row["predicted_position.0"] == pytest.approx(state.position, abs=5)
        assert row["residual.0"] == pytest.approx(0, abs=5)


async def test_speeds_are_unknown_until_the_unit_mode_is() -> None:
    async with bench() as b:
        plan = b.device.telemetry.sample_plan(["velocity.0", "position.0"])
        b.patch(faults={"silence": True})
        await b.clock.advance(2.5)
        assert b.device.state == "failed"
        zeros = b"".join(Reply(2, 1, 100, Opcode.GAP, 0).encode() for _ in plan.frames)
        assert np.isnan(plan.decode(np.zeros(1), zeros)[0]).tolist() == [True, False]


def answers_of(replies: bytes | bytearray, questions: int) -> NDArray[np.uint8]:
    return np.frombuffer(bytes(replies), dtype=np.uint8).reshape(-1, questions, 9)


@given(
    values=st.lists(st.tuples(*[st.integers(-(1 << 31), (1 << 31) - 1)] * 3), min_size=1, max_size=5),
    bit=st.integers(0, 9 * 8 - 1),
    which=st.integers(0, 14),
)
def test_a_flipped_bit_is_no_number(values: list[tuple[int, int, int]], bit: int, which: int) -> None:
    replies = bytearray(b"".join(Reply(2, 1, 100, Opcode.GAP, value).encode() for row in values for value in row))
    which %= 3 * len(values)
    replies[9 * which + bit // 8] ^= 1 << bit % 8
    decoded = values_of(FRAMES, answers_of(replies, 3)).ravel()
    assert np.isnan(decoded[which])
    others = np.delete(decoded, which)
    assert others.tolist() == np.delete(np.array(values, dtype=float).ravel(), which).tolist()


@pytest.mark.parametrize(
    "reply",
    [Reply(2, 1, 4, Opcode.GAP, 7), Reply(2, 1, 100, Opcode.GGP, 7), Reply(2, 3, 100, Opcode.GAP, 7)],
    ids=["a status of an error", "another command", "another module"],
)
def test_a_sound_answer_to_something_else_is_no_number(reply: Reply) -> None:
    assert np.isnan(values_of(FRAMES[:1], answers_of(reply.encode(), 1))).all()


async def test_the_rate_follows_from_the_number_of_questions() -> None:
    async with bench() as b:
        one, all_ = (b.device.telemetry.sample_plan(channels) for channels in (["position.0"], EVERY))
        assert b.device.telemetry.sample_rate_max_hz(one) == b.device.telemetry.rate_max_hz == 1000
        assert b.device.telemetry.sample_rate_max_hz(all_) < 1000
        assert b.device.telemetry.calls_per_s_possible is None
