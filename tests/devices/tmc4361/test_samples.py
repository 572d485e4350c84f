"""Telemetry rows: what they ask, and what comes of the words."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.sample_plan import FloatArray
from app.devices.tmc4361.telemetry import QUANTITIES
from app.emulators.tmc4361.options import Tmc4361Patch
from app.errors import UnknownThing, UsageError
from tests.devices.tmc4361.harness import Bench, bench


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


async def test_every_channel_has_a_column_of_numbers() -> None:
    async with bench() as b:
        names = [f"{name}.0" for name in QUANTITIES]
        rows = Rows(b, names)
        await b.device.motion.move(0, 20_000)
        await b.clock.advance(0.3)
        times, columns = rows.decoded()
        assert columns.shape == (len(times), len(names))
        unknown = [name for name, column in zip(names, columns.T, strict=True) if np.isnan(column).all()]
        assert unknown == ["switch_home.0"]  # home_event 0 says nothing of the pin
        assert len(rows.plan.frames) == len(set(rows.plan.frames))


async def test_the_residual_of_an_s_ramp_stays_within_two_steps() -> None:
    async with bench() as b:
        rows = Rows(b, ["residual.0", "predicted_acceleration.0", "acceleration.0", "velocity.0"], 0.002)
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(1.3)
        _, columns = rows.decoded()
        residual, expected, acceleration, _ = columns.T
        moving = np.isfinite(residual)
        assert moving.sum() > 600
        assert np.abs(residual[moving]).max() <= 2
        assert np.nanmax(np.abs(expected - acceleration)) < 12_000  # 64 clocks of bow beside 200,000 pps^2


async def test_velocity_and_target_velocity_count_in_pps() -> None:
    async with bench() as b:
        rows = Rows(b, ["velocity.0", "target_velocity.0"])
        await b.device.motion.rotate(0, -12_345.5)
        await b.clock.advance(1)
        _, columns = rows.decoded()
        assert columns[-1].tolist() == pytest.approx([-12_345.5, -12_345.5], abs=1)


async def test_events_of_the_status_byte_have_the_time_of_their_row() -> None:
    async with bench() as b:
        await b.clock.advance(1)
        await b.device.identity.refresh()
        rows = Rows(b, ["position.0", "events.0"], 0.001)
        started = await b.device.motion.move(0, 3_000)
        assert started.predicted_duration_s is not None
        arrival_s = started.started_at_s + started.predicted_duration_s
        await b.clock.advance(started.predicted_duration_s + 0.02)
        times, columns = rows.decoded()
        reached = columns[:, 1].astype(np.int64) & 1
        assert times[np.flatnonzero(reached)[0]] == pytest.approx(arrival_s, abs=0.0015)


async def test_a_reset_that_a_status_byte_shows_first_forgets_what_was_written() -> None:
    async with bench() as b:
        await b.clock.advance(1)
        await b.device.identity.refresh()
        rows = Rows(b, ["position.0", "events.0"], 0.001)
        await b.device.registers.write("PID_P", 0, 99)
        b.patch(Tmc4361Patch(power_cycle=True))
        b.port.run_due_samples()
        await b.clock.advance(0.003)
        rows.decoded()
        assert b.event_names().count("RST_EV") == 2  # of power-on, and now
        await b.state()  # reads EVENTS: no news any more
        assert b.memory.kept_word(b.device.family.table.get("PID_P", 0)) is None


async def test_without_an_encoder_its_channels_are_unknown() -> None:
    async with bench(None) as b:
        rows = Rows(b, ["encoder_position.0", "deviation.0", "load_angle.0", "position.0"])
        await b.clock.advance(0.1)
        _, columns = rows.decoded()
        assert np.isnan(columns[:, :3]).all()
        assert np.isfinite(columns[:, 3]).all()
        state = await b.state()
        assert (state.encoder_position, state.deviation, state.load_angle_deg) == (None, None, None)


@pytest.mark.parametrize("code", [3, 12, 6, 9])
async def test_home_is_told_where_the_chip_lets_it_be_known(code: int) -> None:
    async with bench() as b:
        await b.device.registers.write("X_HOME", 0, 500)
        await b.device.registers.write("HOME_SAFETY_MARGIN", 0, 20)
        await b.device.registers.write("REFERENCE_CONF", 0, fields={"home_event": code})
        rows = Rows(b, ["switch_home.0"], 0.005)
        for level in (True, False):
            b.switches(home=level)
            await b.clock.advance(0.1)
            assert (await b.state()).switches.home is level
            assert rows.decoded()[1][-1, 0] == float(level)
        await b.device.motion.move(0, 510)
        await b.at_rest()
        assert (await b.state()).switches.home is None
        assert np.isnan(rows.decoded()[1][-1, 0])


async def test_what_is_no_channel_is_told() -> None:
    async with bench() as b:
        with pytest.raises(UnknownThing, match="position"):
            b.device.telemetry.sample_plan(["nonsense.0"])
        with pytest.raises(UsageError):
            b.device.telemetry.sample_plan([])
