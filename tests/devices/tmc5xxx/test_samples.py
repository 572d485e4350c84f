"""Telemetry rows: what they ask, what comes of the words, and that no row takes a flag away."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.counter import PositionSeen
from app.devices.core.sample_plan import FloatArray
from app.devices.tmc5xxx.roles import roles_of
from app.devices.tmc5xxx.telemetry import quantities
from app.emulators.tmc5xxx import Tmc5xxxPatch
from app.errors import UnknownThing, UsageError
from app.registers.tmc5xxx.table import AXES
from tests.devices.tmc5xxx.harness import MODELS, Bench, bench


class Rows:
    """Samples of some channels, taken on the chip's own time."""

    def __init__(self, b: Bench, channels: list[str], period_s: float = 0.01) -> None:
        self.plan = b.device.telemetry.sample_plan(channels)
        self.times: list[float] = []
        self.replies: list[bytes] = []
        self._bench = b
        self._end = b.port.start_sampling(self.plan.frames, period_s, self._sink)

    def _sink(self, time_s: float, replies: bytes) -> None:
        self.times.append(time_s)
        self.replies.append(replies)

    def decoded(self) -> tuple[FloatArray, FloatArray]:
        """Times [rows] and columns [rows, channels] since the last call."""
        self._bench.port.run_due_samples()
        times = np.array(self.times)
        columns = self.plan.decode(times, b"".join(self.replies))
        self.times.clear()
        self.replies.clear()
        return times, columns


@pytest.mark.parametrize("model", MODELS)
async def test_every_channel_has_a_column_of_numbers(model: str) -> None:
    async with bench(model) as b:
        names = [channel.name for channel in b.device.telemetry.channels()]
        rows = Rows(b, names)
        for axis in range(AXES[model]):
            await b.device.motion.move(axis, 20_000)
        await b.clock.advance(0.3)
        times, columns = rows.decoded()
        assert columns.shape == (len(times), len(names))
        unknown = {name for name, column in zip(names, columns.T, strict=True) if np.isnan(column).all()}
        wanted = {f"target_velocity.{axis}" for axis in range(AXES[model])}  # of velocity mode alone
        assert unknown - {"encoder_position.1", "deviation.1"} == wanted  # the pins of encoder 2 are switches
        assert len(rows.plan.frames) <= len(set(rows.plan.frames)) + 1  # the last fetches what GCONF's address may be


def test_channels_are_those_of_the_chip() -> None:
    def names(model: str) -> set[str]:
        return set(quantities(roles_of(model).axes[0]))

    assert names("tmc5160") - names("tmc5072") == {"tstep"}
    assert names("tmc5072") - names("tmc5031") == {"encoder_position", "deviation"}
    assert names("tmc5130") == names("tmc5160")


@pytest.mark.parametrize("model", MODELS)
async def test_no_sample_clears_a_flag(model: str) -> None:
    async with bench(model) as b:
        stat, gstat = b.memory.rows(0).ramp_stat, b.memory.chip.gstat
        names = [channel.name for channel in b.device.telemetry.channels()]
        asked = {frame[0] for frame in b.device.telemetry.sample_plan(names).frames}
        assert gstat.address not in asked
        assert (stat.address in asked) == (model in ("tmc5160", "tmc5240"))


async def test_the_residual_of_a_ramp_stays_within_three_steps() -> None:
    async with bench() as b:
        rows = Rows(b, ["residual.0", "acceleration.0", "velocity.0", "position.0"], 0.002)
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(1.3)
        _, columns = rows.decoded()
        residual, acceleration, velocity, _ = columns.T
        moving = np.isfinite(residual)
        assert moving.sum() > 600
        assert np.abs(residual[moving]).max() <= 3
        assert np.nanmax(acceleration) == pytest.approx(200_000, rel=0.001)
        assert velocity.max() == pytest.approx(50_000, abs=1)


async def test_velocity_and_target_velocity_count_in_pps() -> None:
    async with bench("tmc5072") as b:
        rows = Rows(b, ["velocity.1", "target_velocity.1", "velocity.0"])
        await b.device.motion.rotate(1, -12_345.5)
        await b.clock.advance(1)
        _, columns = rows.decoded()
        assert columns[-1, :2].tolist() == pytest.approx([-12_345.5, -12_345.5], abs=1)
        assert columns[-1, 2] == 0


@pytest.mark.parametrize("model", MODELS)
async def test_switches_show_without_a_flag_being_read(model: str) -> None:
    async with bench(model) as b:
        axis = AXES[model] - 1
        rows = Rows(b, [f"switch_left.{axis}", f"switch_right.{axis}"], 0.005)
        for left, right in ((True, False), (False, True)):
            b.switches(axis, left=left, right=right)
            await b.clock.advance(0.7)  # what only looks can tell is as old as the latest of them
            assert rows.decoded()[1][-1].tolist() == [float(left), float(right)]
            switches = (await b.state(axis)).switches
            assert (switches.left, switches.right) == (left, right)


async def test_polarity_and_swapping_count_for_pins_too() -> None:
    async with bench("tmc5130") as b:
        await b.device.registers.write("SW_MODE", 0, fields={"pol_stop_l": 1, "swap_lr": 1})
        rows = Rows(b, ["switch_left.0", "switch_right.0"], 0.005)
        for left, right in ((True, False), (False, True), (False, False)):
            b.switches(0, left=left, right=right)
            await b.clock.advance(0.05)
            switches = (await b.state()).switches
            assert rows.decoded()[1][-1].tolist() == [float(bool(switches.left)), float(bool(switches.right))]


async def test_without_a_set_encoder_its_channels_are_unknown() -> None:
    async with bench(start=None) as b:
        rows = Rows(b, ["encoder_position.0", "deviation.0", "position.0"])
        await b.clock.advance(0.1)
        _, columns = rows.decoded()
        assert np.isnan(columns[:, :2]).all()
        assert np.isfinite(columns[:, 2]).all()
        state = await b.state()
        assert (state.encoder_position, state.deviation) == (None, None)


async def test_rows_tell_where_the_counter_is_until_the_chip_is_reset() -> None:
    async with bench() as b:
        rows = Rows(b, ["position.0", "deviation.0"])
        await b.device.motion.rotate(0, 10_000)
        await b.clock.advance(0.35)
        b.told.clear()
        _, columns = rows.decoded()
        seen = [told for told in b.told if isinstance(told, PositionSeen)]
        assert seen[-1].count == columns[-1, 0]
        assert seen[-1].encoder_count is not None
        b.patch(Tmc5xxxPatch(power_cycle=True))
        b.told.clear()
        await b.clock.advance(0.015)
        rows.decoded()
        assert not [told for told in b.told if isinstance(told, PositionSeen)]


async def test_what_is_no_channel_is_told() -> None:
    async with bench() as b:
        with pytest.raises(UnknownThing, match="position"):
            b.device.telemetry.sample_plan(["nonsense.0"])
        with pytest.raises(UnknownThing):
            b.device.telemetry.sample_plan(["position.1"])
        with pytest.raises(UsageError):
            b.device.telemetry.sample_plan([])
