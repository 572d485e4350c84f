"""The resolution of an encoder out of a measured move: known encoders, turned by exact angles and by inexact ones."""

from __future__ import annotations

import random

import pytest

from app.calc.positions.encoder_resolution import USUAL_COUNTS, constant_of, measured_encoder

TURN = 200 * 256
WAY = 16 * 256


@pytest.mark.parametrize("counts_per_turn", [400, 2000, 4000, 4096, 8192, 16_384, 20_000, 40_000])
def test_a_usual_encoder_is_known_by_a_move_within_its_slack(counts_per_turn: int) -> None:
    rng = random.Random(counts_per_turn)
    for way in (WAY, -WAY):
        for _ in range(200):
            turned = way + rng.uniform(-14, 14)
            found = measured_encoder(round(turned / TURN * counts_per_turn), way, TURN)
            assert abs(found.counts_per_turn - counts_per_turn) <= found.uncertainty
            assert found.usual == counts_per_turn


def test_one_that_counts_the_other_way_has_a_sign() -> None:
    found = measured_encoder(-320, WAY, TURN)
    assert found.counts_per_turn == -4000
    assert found.usual == 4000


def test_what_lies_between_the_usual_ones_is_not_snapped() -> None:
    assert measured_encoder(3500 * WAY / TURN, WAY, TURN).usual is None
    assert 3500 not in USUAL_COUNTS


def test_a_move_too_short_to_tell_two_encoders_apart_names_none() -> None:
    """1000 and 1024 lines over one full step: 20 counts and 20.5."""
    assert measured_encoder(20, 256, TURN).usual is None


def test_a_way_of_nothing_measures_nothing() -> None:
    with pytest.raises(ValueError, match="not 0"):
        measured_encoder(10, 0, TURN)


def test_a_word_of_the_constant_is_read_in_both_ways() -> None:
    assert constant_of(12 << 16 | 0xCCCD, decimal=False) == pytest.approx(12.8, abs=1e-4)
    assert constant_of(12 << 16 | 8000, decimal=True) == 12.8
