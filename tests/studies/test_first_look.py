"""The first look at an emulated axis: what it says of encoder and switches, against the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.emulators.tmc5xxx.options import AxisChange, EncoderChange, SwitchesChange, Tmc5xxxPatch
from app.profiles.capture import read_held
from app.studies.first_look.encoder_fit import fit_encoder
from app.studies.first_look.encoder_index import IndexMet, index_findings
from app.studies.first_look.faults import Way, pulled
from app.studies.first_look.plan import plan
from app.studies.record import Finding, StudyRecord
from app.studies.report import html_of
from app.studies.store import StudyStore
from app.telemetry.sampling import FloatArray
from tests.devices.harness import bench as controller
from tests.devices.tmc5xxx.harness import START
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.plants.broken import drawn
from tests.studies.harness import Studied, studied

TURN = 51_200
FULL = replace(START, counts_per_rev=40_000, irun=31, ihold=16)
NEAR = {"left_at_fullsteps": -300.0, "right_at_fullsteps": 300.0}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


async def looked(s: Studied, **study: Any) -> StudyRecord:
    record = await s.finish(s.begin(s.document({"kind": "first_look", **study})), 120)
    assert record.state == "done", record.message
    return record


def named(record: StudyRecord) -> dict[str, Finding]:
    return {one.name: one for one in record.findings}


async def test_a_right_encoder_is_told_right_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        before = await s.settings(*NAMES)
        record = await looked(s)
        found = named(record)
        assert record.verdict == "all is well"
        assert found["encoder"].value == pytest.approx(1, abs=1e-3)
        assert found["polarity"].value == 1
        assert found["eccentricity"].value == pytest.approx(0, abs=0.02)
        assert found["direction"].sure == "cannot be told"
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0


@pytest.mark.parametrize(("lines", "backwards"), [(1000, False), (10_000, True), (512, True)])
async def test_a_wrong_resolution_is_set_right_by_the_cure_that_it_names(
    tmp_path: Path, lines: int, backwards: bool
) -> None:
    async with studied(tmp_path, encoder={"lines": lines, "reversed": backwards}) as s:
        found = named(await looked(s))
        remedy = found["encoder"].remedy
        assert remedy is not None
        assert f"{4 * lines:,} counts a turn" in remedy.label
        assert found["polarity"].value == (-1 if backwards else 1)
        assert f"the encoder goes {'down' if backwards else 'up'}" in found["direction"].text
        body = remedy.body
        assert body is not None
        for write in body["writes"]:
            await s.device.registers.write(write["name"], write["axis"], write.get("value"), write.get("fields"))
        again = named(await looked(s))
        assert again["encoder"].remedy is None
        assert again["encoder"].value == pytest.approx(1, abs=2e-3)


async def broken(tmp_path: Path, slips: Callable[[], float] = lambda: 0.0, **options: Any) -> Sequence[str]:
    """The faults that are named of an axis with these options, whose encoder slips 3 times a second [full steps]."""
    async with studied(tmp_path, FULL, **{"full_scale_a": 1.5, **options}) as s:
        run = s.begin(s.document({"kind": "first_look", "travel_turns": 4.0 if "stage" in options else 0.0}))
        while run.running:
            slip = EncoderChange(slip_fullsteps=slips())
            s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, encoder=slip)]))
            await s.clock.advance(0.35)
        assert run.record.state == "done", run.record.message
        named = [one.fault for one in run.record.findings if one.fault]
        assert all(fault in run.record.verdict for fault in named)
        return named


async def test_a_healthy_axis_has_no_fault(tmp_path: Path) -> None:
    assert await broken(tmp_path, stage=NEAR, load={"friction_nm": 0.06, "inertia_kgm2": 5e-5}) == []


async def test_an_encoder_that_slips_is_named(tmp_path: Path) -> None:
    assert await broken(tmp_path, lambda: 1.3) == ["encoder slips"]


@pytest.mark.parametrize("coil", ["a", "b"])
async def test_an_open_phase_is_named(tmp_path: Path, coil: str) -> None:
    assert await broken(tmp_path, motor={"open_phase": coil}) == ["open phase"]


@pytest.mark.parametrize("load", [{"friction_nm": 0.6}, {"torque_nm": 0.6}])
async def test_a_load_that_is_too_heavy_is_named(tmp_path: Path, load: dict[str, float]) -> None:
    assert await broken(tmp_path, load=load) == ["overload"]


async def test_a_weight_that_pulls_the_shaft_into_a_switch_and_so_ends_the_move_is_named(tmp_path: Path) -> None:
    assert await broken(tmp_path, **drawn(1071).options) == ["overload"]


STOOD: FloatArray = np.concatenate((np.linspace(0, 1348, 10), np.full(200, 1348.0)))
"""A ramp that a switch ends after five full steps, and what comes then."""
ON: FloatArray = np.maximum(np.arange(210) - 9.0, 0.0)


@pytest.mark.parametrize(
    ("encoder", "is_pulled"),
    [
        (2000 * np.arange(210), True),
        (-2000 * np.arange(210), True),
        (STOOD, False),
        (20 * (STOOD + 200 * np.cos(ON) * np.exp(-ON / 20)), False),  # swings, by an encoder that is set wrong
        (STOOD + 700 * np.cumsum(np.where(ON % 20 == 19, np.sign(np.sin(0.02 * ON**2)), 0)), False),  # slips
    ],
)
def test_a_shaft_that_turns_on_while_the_ramp_stands_is_pulled(encoder: FloatArray, is_pulled: bool) -> None:
    assert pulled(Way(STOOD, encoder), 256) == is_pulled


def test_a_shaft_that_turns_while_the_ramp_does_not_begin_is_pulled_and_no_sample_tells_nothing() -> None:
    assert pulled(Way(np.zeros(50), np.linspace(0, -5000, 50)), 256)
    assert not pulled(Way(np.zeros(50), np.zeros(50)), 256)
    assert not pulled(Way(np.zeros(0), np.zeros(0)), 256)


async def test_the_backlash_of_a_switch_is_named(tmp_path: Path) -> None:
    assert await broken(tmp_path, stage={**NEAR, "backlash_fullsteps": 4.0}) == ["switch backlash"] * 2


async def test_looks_that_are_far_apart_are_no_backlash(tmp_path: Path) -> None:
    """Device time that runs ten times as fast, as a link does that is slow: two full steps pass from look to look."""
    assert await broken(tmp_path, stage=NEAR, time_scale=10.0) == []


async def test_a_chip_that_reads_no_encoder_is_not_told_to_be_given_one(tmp_path: Path) -> None:
    async with controller(stages=[{"right_at_fullsteps": 700.0, "start_fullsteps": 400.0}]) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        record = await looked(s)
        assert (named(record)["encoder"].sure, record.verdict) == ("cannot be told", "all is well")
        assert "encoder" not in named(record)["direction"].text


UNSET = replace(START, counts_per_rev=0)
ENCODERS = ("tmc5062", "tmc5072", "tmc5130", "tmc5160", "tmc5240")


async def held(s: Studied) -> dict[Any, int | None]:
    """All that is configuration, as it is set now."""
    return dict((await read_held(s.device)).words)


async def finds_one(s: Studied, counts: int) -> dict[str, Finding]:
    """Nobody has set what a count is: a look finds `counts` a turn, sets nothing, and its cure makes the next one
    find it right. What the first look found."""
    before = await held(s)
    found = named(await looked(s))
    assert await held(s) == before
    assert (await s.b.state()).encoder_position is None
    told, remedy = found["encoder"], found["encoder"].remedy
    assert told.value == counts
    assert told.interval is not None
    assert told.interval.low <= counts <= told.interval.high
    assert f"{counts:,} counts a turn ({counts // 4:,} lines)" in told.text
    assert remedy is not None
    assert remedy.body is not None
    for write in remedy.body["writes"]:
        await s.device.registers.write(write["name"], write["axis"], write.get("value"), write.get("fields"))
    again = named(await looked(s))
    assert (again["encoder"].remedy, again["polarity"].value) == (None, 1)
    assert again["encoder"].value == pytest.approx(1, abs=2e-3)
    return found


@pytest.mark.parametrize("model", ENCODERS)
async def test_an_encoder_that_nobody_has_set_is_found(tmp_path: Path, model: str) -> None:
    async with studied(tmp_path, UNSET, model=model, encoder={"lines": 1000, "reversed": True}) as s:
        found = await finds_one(s, 4000)
        assert found["polarity"].value == -1
        assert found["eccentricity"].value == pytest.approx(0, abs=0.02)


@pytest.mark.parametrize("lines", [128, 10_000, 1 << 20])
async def test_an_encoder_that_nobody_has_set_is_found_however_fine_it_is(tmp_path: Path, lines: int) -> None:
    async with studied(tmp_path, UNSET, encoder={"lines": lines}) as s:
        assert (await finds_one(s, 4 * lines))["polarity"].value == 1


async def test_what_is_set_to_find_an_encoder_goes_back_where_the_look_is_stopped(tmp_path: Path) -> None:
    async with studied(tmp_path, UNSET) as s:
        before = await held(s)
        run = s.begin(s.document({"kind": "first_look"}))
        await s.clock.advance(1.5)
        assert (await s.b.state()).encoder_position is not None
        await s.passing(run.abort("enough"))
        assert (run.record.state, run.record.left) == ("aborted", [])
        assert await held(s) == before


async def test_an_encoder_that_nobody_has_set_is_found_by_its_resolution_alone(tmp_path: Path) -> None:
    start = replace(START_4361, counts_per_rev=0, stops=False)
    async with bench_4361(start, encoder={"lines": 2500, "eccentricity_deg": 0.3}) as b:
        found = await finds_one(Studied(b, StudyStore(tmp_path, aside=False)), 10_000)
        assert found["eccentricity"].value == pytest.approx(0.3, abs=0.05)


@pytest.mark.parametrize("model", ENCODERS)
async def test_the_index_of_an_encoder_is_found_where_it_is(tmp_path: Path, model: str) -> None:
    """Its N line is high for four counts from the rotor's 0 on, which is not where the counter begins."""
    async with studied(tmp_path, model=model, start_fullsteps=60.0) as s:
        before = await held(s)
        found = named(await looked(s))
        index, offset = found["index"], found["offset"]
        assert index.value == pytest.approx(0, abs=16)
        assert "seen 4 times in 4 turns" in index.text
        assert offset.value == pytest.approx(TURN - 60 * 256, abs=16)
        assert await held(s) == before


async def test_the_index_of_an_encoder_that_nobody_has_set_is_found(tmp_path: Path) -> None:
    async with studied(tmp_path, UNSET, start_fullsteps=60.0, encoder={"lines": 1000, "reversed": True}) as s:
        found = named(await looked(s, turns=2.0))
        assert "seen 8 times in 8 turns" in found["index"].text
        assert found["offset"].value == pytest.approx(TURN - 60 * 256, abs=64)


async def test_the_index_of_an_encoder_is_found_by_what_latches_it(tmp_path: Path) -> None:
    start = replace(START_4361, stops=False)
    async with bench_4361(start, encoder={"zero_fullsteps": 37.3}) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = await held(s)
        found = named(await looked(s))
        assert found["index"].value == pytest.approx(0, abs=16)
        assert found["offset"].value == pytest.approx(37.3 * 256, abs=16)
        assert await held(s) == before


async def test_the_report_draws_the_encoder_over_the_position_both_ways(tmp_path: Path) -> None:
    """Of an encoder that counts against the motor, and whose counts are set wrong: neither shows."""
    start = replace(START_4361, stops=False)
    async with bench_4361(start, encoder={"lines": 2500, "reversed": True, "eccentricity_deg": 0.4}) as b:
        record = await looked(Studied(b, StudyStore(tmp_path, aside=False)))
        assert record.looked is not None
        assert [way.forward for way in record.looked.ways] == [True, False, True, False]
        for way in record.looked.ways:
            assert np.ptp(way.position_fullsteps) == pytest.approx(200, abs=2)
            assert np.ptp(way.deviation_fullsteps) == pytest.approx(2 * 0.4 / 1.8, abs=0.05)
        report = html_of(record)
        assert "Encoder over position" in report
        assert (report.count("<svg"), report.count("<polyline")) == (1, 4)
        unread = record.model_copy(update={"looked": None})
        assert "<svg" not in html_of(unread)


async def test_an_index_beside_the_way_is_not_told_to_be_missing(tmp_path: Path) -> None:
    async with studied(tmp_path, start_fullsteps=60.0) as s:
        index = named(await looked(s, turns=0.25))["index"]
        assert (index.sure, index.value) == ("cannot be told", None)
        assert "0.25 turns" in index.text


def met(*latched: Sequence[int], turns: float = 1.0) -> list[IndexMet]:
    """Ways there and back, and where the index of an encoder that tells twice the way was met on each."""
    there = np.linspace(0, turns * TURN, 400)
    ways = [there if not at % 2 else there[::-1] for at in range(len(latched))]
    return [IndexMet(Way(way, 2 * way), at) for way, at in zip(ways, latched, strict=True)]


def test_the_index_is_told_by_the_ways_on_which_it_was_met() -> None:
    def told(ways: Sequence[IndexMet]) -> dict[str, Finding]:
        return {one.name: one for one in index_findings(ways, TURN, 256)}

    once = 2 * 1000
    none = told(met([], [], [], []))
    assert "none seen in 4 turns" in none["index"].text
    assert "offset" not in none
    found = told(met([once], [once + 40], [once + 6], [once + 40]))
    assert found["index"].value == pytest.approx(3)
    assert found["offset"].value == pytest.approx(1000 + (1.5 + 20) / 2)
    # at the end of a turn, and at its beginning
    found = told(met([2 * (TURN - 3)], [2], [4], [2]))
    assert found["index"].value == pytest.approx(5)
    wandering = told(met([once], [once], [3 * once], [once]))
    assert "no whole turns apart" in wandering["index"].text
    assert "offset" not in wandering
    alone = told(met([once], [], [], []))["index"]
    assert (alone.sure, "seen once in 4 turns" in alone.text) == ("cannot be told", True), alone.text


async def test_no_encoder_that_answers_is_told_to_be_missing(tmp_path: Path) -> None:
    """The chip waits for A and B lines, and one that speaks SSI is connected."""
    async with bench_4361(replace(START_4361, counts_per_rev=0, stops=False), encoder={"kind": "ssi"}) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = await held(s)
        record = await looked(s)
        told = named(record)["encoder"]
        assert (told.sure, told.remedy, record.verdict) == ("missing", None, "1 to be set right: encoder")
        assert "nothing answers" in told.text
        assert await held(s) == before


async def test_an_encoder_whose_pins_serve_something_else_is_told_to_be_untold(tmp_path: Path) -> None:
    async with studied(tmp_path, UNSET, model="tmc5072") as s:
        await s.device.registers.write("GCONF", None, fields={"poscmp_enable": 1})
        told = named(await looked(s))["encoder"]
        assert told.sure == "cannot be told"
        assert "position compare has the pins of encoder 1" in told.text


async def test_a_chip_without_an_encoder_input_says_so(tmp_path: Path) -> None:
    async with studied(tmp_path, UNSET, model="tmc5031") as s:
        told = named(await looked(s))["encoder"]
        assert told.sure == "cannot be told"
        assert "this chip reads none" in told.text


async def test_the_plan_tells_that_an_encoder_is_looked_for(tmp_path: Path) -> None:
    async with studied(tmp_path, UNSET) as s:
        told = await plan(s.device, 0, s.document({"kind": "first_look"}))
        assert told.missing == []
        assert "4,000 counts a turn" in told.steps[0]
        assert {"ENC_CONST of axis 0", "ENCMODE of axis 0"} <= set(told.registers)


@pytest.mark.parametrize(("turns", "said"), [(1.0, "twice 1 turn there"), (2.5, "twice 2.5 turns there")])
async def test_the_plan_counts_turns(tmp_path: Path, turns: float, said: str) -> None:
    async with studied(tmp_path) as s:
        told = await plan(s.device, 0, s.document({"kind": "first_look", "turns": turns, "velocity_rps": 1.0}))
        assert any(said in step and "at 1 turn a second" in step for step in told.steps), told.steps


async def test_a_shaft_that_is_clamped_is_named(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        record = await looked(s)
        assert named(record)["overload"].fault == "overload"
        assert "overload" in record.verdict


@pytest.mark.parametrize("amplitude_deg", [0.0, 0.15, 0.4])
async def test_the_eccentricity_of_an_encoder_is_told_within_its_interval(tmp_path: Path, amplitude_deg: float) -> None:
    start = replace(START_4361, stops=False)
    async with bench_4361(start, encoder={"eccentricity_deg": amplitude_deg}) as b:
        found = named(await looked(Studied(b, StudyStore(tmp_path, aside=False))))
        told = found["eccentricity"]
        assert told.value == pytest.approx(amplitude_deg, abs=0.03)
        assert told.interval is not None
        assert told.interval.low - 0.02 <= amplitude_deg <= told.interval.high + 0.02


async def test_switches_are_found_where_they_are(tmp_path: Path) -> None:
    stage = {"left_at_fullsteps": -900.0, "right_at_fullsteps": 1500.0}
    async with studied(tmp_path, START, stage=stage) as s:
        found = named(await looked(s, travel_turns=10.0, velocity_rps=2.0))
        assert found["left switch"].value == pytest.approx(-900 * 256, abs=0.06 * TURN)
        assert found["right switch"].value == pytest.approx(1500 * 256, abs=0.06 * TURN)
        assert found["travel"].value == pytest.approx(12, abs=0.12)
        assert (await s.b.state()).position == 0


@pytest.mark.parametrize("inertia_kgm2", [2e-4, 5e-4])
async def test_a_switch_out_of_which_the_rotor_swings_again_is_found(tmp_path: Path, inertia_kgm2: float) -> None:
    """It had stopped the motor, and was waited for in vain: on the way to the other one, or at its edge."""
    stage = {"left_at_fullsteps": -121.3, "right_at_fullsteps": 231.0}
    async with bench_4361(START_4361, load={"inertia_kgm2": inertia_kgm2, "friction_nm": 0.02}, stage=stage) as b:
        await b.device.registers.write("RAMPMODE", 0, fields={"RAMP_PROFILE": 1})
        found = named(await looked(Studied(b, StudyStore(tmp_path, aside=False)), travel_turns=3.0, velocity_rps=0.5))
        assert found["left switch"].value == pytest.approx(-121.3 * 256, abs=512)
        assert found["right switch"].value == pytest.approx(231 * 256, abs=512)


async def test_no_switch_within_what_it_may_go_is_told(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        found = named(await looked(s, travel_turns=1.5, velocity_rps=2.0))
        assert (found["left switch"].sure, found["right switch"].sure) == ("missing", "missing")


def test_the_fit_finds_what_it_was_made_of_and_its_intervals_hold_it() -> None:
    rng = np.random.default_rng(3)
    held = 0
    for _ in range(100):
        ratio, play, once, phase = rng.uniform(0.9, 1.1), rng.uniform(0, 40), rng.uniform(20, 90), rng.uniform(0, 6)
        there = np.linspace(0, TURN, 400)
        position = np.concatenate((there, there[::-1]))
        forward = np.arange(800) < 400
        error = once * np.sin(2 * np.pi * position / TURN + phase) + rng.normal(0, 4, 800)
        found = fit_encoder(position, ratio * position + np.where(forward, play / 2, -play / 2) + error, forward, TURN)
        assert found.ratio == pytest.approx(ratio, abs=1e-4)
        assert found.eccentricity == pytest.approx(once, abs=1.5)
        held += found.play_interval[0] <= play <= found.play_interval[1]
    assert held >= 95


def test_less_than_a_turn_tells_no_eccentricity() -> None:
    position = np.linspace(0, TURN / 2, 100)
    found = fit_encoder(position, position, position < TURN / 4, TURN)
    assert (found.eccentricity, found.twice) == (None, None)
    with pytest.raises(ValueError, match="40 samples"):
        fit_encoder(position[:10], position[:10], position[:10] < 3, TURN)


async def test_an_axis_between_two_pressed_switches_is_told_that_they_are(tmp_path: Path) -> None:
    """It was called overloaded: its load value is 0 while it stands."""
    async with studied(tmp_path, FULL) as s:
        both = SwitchesChange(left=True, right=True)
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, switches=both)]))
        record = await s.finish(s.begin(s.document({"kind": "first_look"})), 120)
        assert record.state == "failed"
        assert "both of its end switches read as pressed" in record.message
