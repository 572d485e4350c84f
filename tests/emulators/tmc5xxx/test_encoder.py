"""The encoder interface: constants, the N line in every setting of ENCMODE, latches, deviation, and pins by GCONF.

Choices: N is high for one line (four counts) a turn; A is high in the middle two counts of a line, B in the last two.
`clr_once` acts once after each write of ENCMODE that has it set, and can be read back afterwards. A level-sensitive N
event counts at every count at which the level is active.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.tmc5xxx import Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import BACKWARD, FORWARD, TURN, WITH_ENCODER, Bench, moving

POL_A, POL_B, POL_N, IGNORE_AB, CLR_CONT, CLR_ONCE, POS_EDGE, NEG_EDGE, CLR_ENC_X, LATCH_X, DECIMAL, LATCH_NOW = (
    1 << bit for bit in range(12)
)
PLACES = [("tmc5062", 0), ("tmc5062", 1), ("tmc5072", 0), ("tmc5072", 1), ("tmc5130", 0), ("tmc5160", 0)]


def encoded(model: Tmc5xxxModel, axis: int = 0, lines: int = 12_800) -> Bench:
    """A bench whose encoder is connected and counts microsteps: 12,800 lines are one count each."""
    bench = moving(model, axis, encoder={"lines": lines})
    if axis == 1:
        bench.write("GCONF", 1 << 5)  # enc2_enable
    bench.put(axis, ENC_CONST=1 << 16)
    bench.write("ENC_STATUS", bench.raw("ENC_STATUS", axis), axis)
    return bench


def n_event(bench: Bench, axis: int = 0) -> bool:
    """ENC_STATUS.n_event, cleared as this chip does it."""
    word = bench.raw("ENC_STATUS", axis)
    bench.write("ENC_STATUS", word, axis)
    return bool(word & 1)


@dataclass
class PlainEncoder:
    """The interface again, one count after the other."""

    mode: int
    per_turn: int
    count: int
    x_enc: int = 0
    latch: int = 0
    armed: bool = False
    event: bool = False

    def level(self, count: int) -> bool:
        place = count % self.per_turn
        if (place <= 3) is not bool(self.mode & POL_N):
            return False
        a, b = place % 4 in (1, 2), place % 4 in (2, 3)
        return bool(self.mode & IGNORE_AB) or (a is bool(self.mode & POL_A) and b is bool(self.mode & POL_B))

    def fire(self) -> None:
        self.event = True
        if self.mode & CLR_CONT or self.armed:
            self.armed = False
            self.latch = self.x_enc
            if self.mode & CLR_ENC_X:
                self.x_enc = 0

    def write_mode(self) -> None:
        self.armed = bool(self.mode & CLR_ONCE)
        self.look()

    def look(self) -> None:
        """An active level counts without an edge."""
        if not self.mode & (POS_EDGE | NEG_EDGE) and self.level(self.count):
            self.fire()

    def clear_event(self) -> None:
        if self.event:
            self.event = False
            self.look()

    def go(self, to: int) -> None:
        way = 1 if to > self.count else -1
        while self.count != to:
            before = self.level(self.count)
            self.count += way
            self.x_enc += way
            now = self.level(self.count)
            if not self.mode & (POS_EDGE | NEG_EDGE):
                if now:
                    self.fire()
            elif (self.mode & POS_EDGE and now and not before) or (self.mode & NEG_EDGE and before and not now):
                self.fire()


@settings(max_examples=30, deadline=None)
@given(
    place=st.sampled_from(PLACES),
    mode=st.integers(0, 0x1FF),
    lines=st.sampled_from([4, 50, 400]),
    moves=st.lists(st.tuples(st.sampled_from([1, 2]), st.floats(0.01, 0.8), st.booleans(), st.booleans()), max_size=6),
)
def test_every_setting_of_encmode_is_that_of_the_plain_encoder(
    place: tuple[Tmc5xxxModel, int], mode: int, lines: int, moves: list[tuple[int, float, bool, bool]]
) -> None:
    model, axis = place
    bench = encoded(model, axis, lines)
    plain = PlainEncoder(mode, 4 * lines, bench.counts(axis))
    bench.put(axis, X_ENC=0, ENCMODE=mode)
    plain.write_mode()
    for direction, seconds, rewrite, clear in moves:
        bench.put(axis, RAMPMODE=direction)
        # the ramp may have to turn round: follow it in pieces that go one way
        end_s = bench.now_s + seconds
        while bench.now_s < end_s:
            bench.wait(0.002)
            plain.go(bench.counts(axis))
        assert bench.read("X_ENC", axis) == plain.x_enc
        assert bench.read("ENC_LATCH", axis) == plain.latch
        if rewrite:
            bench.put(axis, ENCMODE=mode)
            plain.write_mode()
        if clear:
            assert n_event(bench, axis) == plain.event
            plain.clear_event()
    assert n_event(bench, axis) == plain.event


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_an_index_search_latches_and_clears_once(model: Tmc5xxxModel, axis: int) -> None:
    bench = encoded(model, axis)
    bench.put(axis, X_ENC=1_000_000, ENCMODE=POL_N | IGNORE_AB | CLR_ONCE | POS_EDGE | CLR_ENC_X | LATCH_X)
    bench.put(axis, XTARGET=3 * TURN + 700)
    bench.wait(4)
    assert n_event(bench, axis)
    assert bench.read("ENC_LATCH", axis) == 1_000_000 + TURN
    assert bench.read("XLATCH", axis) == pytest.approx(TURN, abs=4)  # XACTUAL at the tick of 16 us in which it was seen
    assert bench.read("X_ENC", axis) == 2 * TURN + 700
    assert bench.read("ENCMODE", axis) & CLR_ONCE


def test_latch_now_of_a_tmc5072() -> None:
    """Bit 11 of ENCMODE: latches with the write. That latch_x_act then goes for XLATCH too is a choice."""
    bench = encoded("tmc5072")
    bench.put(XTARGET=12_345)
    bench.wait(2)
    bench.put(ENCMODE=LATCH_NOW)
    assert (bench.read("ENC_LATCH"), bench.read("XLATCH")) == (12_345, 0)
    bench.put(ENCMODE=LATCH_NOW | LATCH_X)
    assert (bench.read("ENC_LATCH"), bench.read("XLATCH")) == (12_345, 12_345)


@pytest.mark.parametrize(("model", "axis"), PLACES)
@pytest.mark.parametrize(
    ("decimal", "constant", "microsteps"),
    [
        (False, 51_200 * 65_536 // 40_000, 1.28),
        (False, -(51_200 * 65_536 // 40_000), -1.28),
        (True, 1 << 16 | 2800, 1.28),
        # NOTES-TMC5XXX 8: the integer part 2^16 - (F + 1), the fraction 10,000 - dec
        (True, (2**16 - 2) << 16 | (10_000 - 2800), -1.28),
    ],
)
def test_a_count_is_worth_the_constant(
    model: Tmc5xxxModel, axis: int, decimal: bool, constant: int, microsteps: float
) -> None:
    bench = encoded(model, axis, lines=10_000)
    bench.put(axis, ENCMODE=DECIMAL * decimal, ENC_CONST=constant, XTARGET=10 * TURN)
    bench.wait(6)
    assert bench.read("X_ENC", axis) == pytest.approx(400_000 * microsteps, abs=8)


def test_the_encoder_constant_after_power_on() -> None:
    """0 in a TMC5130 (its data sheet; the API header says 1.0), 1.0 in the others."""
    for model, moved in (("tmc5062", 200), ("tmc5072", 200), ("tmc5130", 0), ("tmc5160", 200)):
        bench = moving(model, encoder={"lines": 50})  # type: ignore[arg-type]
        bench.put(XTARGET=TURN)
        bench.wait(2)
        assert bench.read("X_ENC") == moved


def test_deviation_is_told_by_a_tmc5160_and_stops_nothing() -> None:
    bench = encoded("tmc5160")
    bench.put(ENC_DEVIATION=1000)
    bench.put(XTARGET=TURN)
    bench.wait(2)
    assert bench.field("ENC_STATUS", "deviation_warn") == 0
    bench.stage(encoder={"slip_fullsteps": 5.0})
    assert bench.field("ENC_STATUS", "deviation_warn") == 1
    bench.write("ENC_STATUS", 2)
    bench.wait(0.001)
    assert bench.field("ENC_STATUS", "deviation_warn") == 1, "it cannot be cleared while it persists"
    bench.put(XTARGET=0)
    bench.wait(2)
    assert bench.read("XACTUAL") == 0
    bench.put(ENC_DEVIATION=0)
    bench.write("ENC_STATUS", 2)
    bench.wait(0.001)
    assert bench.field("ENC_STATUS", "deviation_warn") == 0


@pytest.mark.parametrize("model", ["tmc5062", "tmc5072"])
def test_gconf_gives_the_encoders_their_pins(model: Tmc5xxxModel) -> None:
    """poscmp_enable takes those of encoder 1; encoder 2 shares its own with the right switches."""
    bench = Bench(model, encoder={"lines": 12_800})
    for axis in (0, 1):
        bench.put(axis, ENC_CONST=1 << 16, AMAX=60_000, VMAX=20_000, RAMPMODE=FORWARD)

    def connected() -> list[bool]:
        before = [bench.read("X_ENC", axis) for axis in (0, 1)]
        bench.wait(0.1)
        counted = [bench.read("X_ENC", axis) != before[axis] for axis in (0, 1)]
        encoders = [axis.encoder for axis in bench.state().axes]
        assert counted == [encoder is not None and encoder.connected for encoder in encoders]
        return counted

    assert connected() == [True, False]
    bench.write("GCONF", 1 << 5)
    assert connected() == [True, True]
    bench.write("GCONF", 1 << 3)
    assert connected() == [False, False]


@pytest.mark.parametrize("model", ["tmc5062", "tmc5072"])
def test_switches_whose_pins_an_encoder_has_are_not_seen(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for axis in (0, 1):
        bench.stage(axis, switches={"left": True, "right": True})
    both = {"status_stop_l", "status_stop_r"}
    for gconf, seen in (
        (0, (both, both)),
        (1 << 5, ({"status_stop_l"}, {"status_stop_l"})),
        (1 << 4, ({"status_stop_r"}, both)),
        (1 << 6, (both, {"status_stop_r"})),
    ):
        bench.write("GCONF", gconf)
        bench.wait(0.001)
        assert tuple(bench.flags(axis) & both for axis in (0, 1)) == seen


@pytest.mark.parametrize("model", WITH_ENCODER)
def test_a_reversed_encoder_counts_down(model: Tmc5xxxModel) -> None:
    bench = moving(model, encoder={"lines": 12_800, "reversed": True})
    bench.put(ENC_CONST=1 << 16, RAMPMODE=BACKWARD)
    bench.wait(0.5)
    assert bench.read("X_ENC") == pytest.approx(-bench.read("XACTUAL"), abs=1)
    assert bench.read("X_ENC") > 0


def test_a_tmc5031_has_no_encoder() -> None:
    bench = moving("tmc5031")
    bench.put(RAMPMODE=FORWARD)
    bench.wait(3)
    assert bench.chip.read(0x39, bench.now_s) == bench.chip.read(0x3B, bench.now_s) == 0
    assert bench.state().axes[0].encoder is None


@pytest.mark.parametrize("model", WITH_ENCODER)
def test_with_physics_the_encoder_follows_the_motor(model: Tmc5xxxModel) -> None:
    bench = moving(model, rigid=False, encoder={"lines": 12_800})
    bench.put(ENC_CONST=1 << 16, ENCMODE=POL_N | IGNORE_AB | POS_EDGE | CLR_CONT, XTARGET=TURN + TURN // 2)
    bench.wait(2)
    assert bench.read("X_ENC") == pytest.approx(TURN + TURN // 2, abs=40)
    assert n_event(bench)
    assert bench.read("ENC_LATCH") == pytest.approx(TURN, abs=3)
