"""How long a study takes yet, where it does not tell itself: by its progress, by its plan, within its budget."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from app.studies.kinds import KINDS
from app.studies.run import StudyRun
from tests.studies.harness import Kept, Studied, studied


@pytest.fixture
async def s(tmp_path: Path) -> AsyncIterator[Studied]:
    async with studied(tmp_path) as made:
        yield made


def run_of(s: Studied, budget_s: float = 900.0) -> StudyRun:
    """A study that has not begun: what it tells is told by the test."""
    document = s.document({"kind": "first_look"}, budget={"time_s": budget_s})
    record = s.store.begin(document)
    return KINDS["first_look"].make(s.device, 0, s.clock, record, Kept(s.store, record.id))


def left_of(run: StudyRun) -> float | None:
    """How long it says that it takes yet [s]."""
    return run.record.left_s


async def test_progress_tells_once_there_is_some_and_the_plan_before(s: Studied) -> None:
    run = run_of(s)
    run.tell("preconditions", 0.0, "looking")
    assert left_of(run) is None, "nobody has planned it"
    run.planned_s = 80.0
    run.tell("preconditions", 0.0, "looking")
    assert left_of(run) == pytest.approx(80.0)
    await s.clock.advance(5)  # what comes before its first phase says nothing of the others
    run.tell("look", 0.0, "first")
    await s.clock.advance(10)
    run.tell("look", 0.02, "a little")
    assert left_of(run) == pytest.approx(70.0)
    run.tell("look", 0.1, "a tenth in ten seconds")
    assert left_of(run) == pytest.approx(90.0)
    run.tell("look", 0.2, "told by the study itself", 12.0)
    assert left_of(run) == 12.0
    run.tell("proof", 1.0, "over")
    assert left_of(run) == pytest.approx(0.0)


async def test_a_plan_that_was_exceeded_before_there_was_progress_tells_nothing(s: Studied) -> None:
    run = run_of(s)
    run.planned_s = 8.0
    run.tell("look", 0.0, "first")
    await s.clock.advance(10)
    run.tell("look", 0.01, "a little")
    assert left_of(run) is None


async def test_one_that_is_gone_on_with_began_at_its_progress(s: Studied) -> None:
    run = run_of(s)
    run.planned_s = 100.0
    run.tell("preconditions", 0.0, "looking")
    run.tell("search", 0.6, "trial 13")
    assert left_of(run) == pytest.approx(40.0)
    await s.clock.advance(20)
    run.tell("search", 0.7, "trial 15")
    assert left_of(run) == pytest.approx(60.0)


async def test_it_is_never_longer_than_the_budget_is(s: Studied) -> None:
    run = run_of(s, budget_s=50.0)
    run.tell("look", 0.0, "first")
    await s.clock.advance(30)
    run.tell("look", 0.1, "slowly")
    assert left_of(run) == pytest.approx(20.0)
    await s.clock.advance(30)
    run.tell("look", 0.11, "slowly")
    assert left_of(run) == 0.0


async def test_it_begins_anew_where_its_progress_does(s: Studied) -> None:
    run = run_of(s)
    run.tell("search", 0.5, "half")
    await s.clock.advance(10)
    run.tell("search", 0.3, "once more")
    assert left_of(run) is None
    await s.clock.advance(10)
    run.tell("search", 0.4, "on")
    assert left_of(run) == pytest.approx(60.0)
