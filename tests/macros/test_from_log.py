"""Pauses of the audit log as waits: for a move's end where it had ended, for a time where it had not."""

from __future__ import annotations

from typing import Any

from app.macros.from_log import draft_of
from app.store.audit_entries import Entry


def entry(at_s: float, action: str, subject: str = "", **more: Any) -> Entry:
    return Entry(at_s, "Ann", "browser", "", "bench", more.pop("axis", 0), action, subject, **more)


def moved(at_s: float, takes_s: float, **more: Any) -> Entry:
    return entry(at_s, "move", "position", old=0, new=5000, detail=f"microsteps, in {takes_s} s", **more)


def steps_of(*entries: Entry, longest_pause_s: float = 5.0) -> list[str]:
    draft = draft_of(entries, "bench", longest_pause_s, {"quiet": 7}.get)
    return [step.text for step in draft.steps]


def test_what_came_behind_a_move_waits_for_its_end_and_pauses_on() -> None:
    assert steps_of(moved(0, 1.5), entry(4, "write", "VMAX", new=9)) == [
        "move axis 0 to 5000 microsteps",
        "wait until axis 0 is there, at most 10 s",
        "wait 2.5 s",
        "write VMAX of axis 0: 9",
    ]


def test_what_came_during_a_move_waits_for_a_time_alone() -> None:
    assert steps_of(moved(0, 8), entry(2, "write", "VMAX", new=9)) == [
        "move axis 0 to 5000 microsteps",
        "wait 2 s",
        "write VMAX of axis 0: 9",
        "wait until axis 0 is there, at most 16 s",
    ]
    stopped = steps_of(moved(0, 8), entry(2, "stop", detail="mode: immediate"))
    assert stopped[1:] == ["wait 2 s", "stop axis 0 dead"]


def test_a_pause_is_no_longer_than_it_may_be() -> None:
    write = [entry(at, "write", "VMAX", new=at) for at in (0, 1000)]
    assert steps_of(*write)[1] == "wait 5 s"
    assert steps_of(*write, longest_pause_s=0.5)[1] == "wait 0.5 s"
    assert len(steps_of(*write, longest_pause_s=0)) == 2


def test_fields_that_were_written_are_what_is_written_again() -> None:
    told = entry(0, "write", "CHOPCONF", old=1, new=2, detail="toff 3 -> 4, tbl -> 2")
    assert steps_of(told) == ["write CHOPCONF of axis 0: toff 4, tbl 2"]


def test_a_profile_is_one_step_and_its_own_writes_are_none() -> None:
    writes = [entry(at, "write", "VMAX", new=1, call=5) for at in (0, 1, 2)]
    assert steps_of(*writes, entry(3, "apply profile", "quiet", call=5)) == ["apply profile 7, quiet"]
    draft = draft_of([entry(3, "apply profile", "loud", call=5)], "bench", 5, lambda _: None)
    assert draft.steps == []
    assert "keep it first" in draft.left_out[0]


def test_stop_everything_stops_what_was_moved() -> None:
    everything = Entry(1, "Ann", "browser", "", None, None, "stop everything", "", detail="mode: ramp")
    assert steps_of(moved(0, 9, axis=2), everything)[1:] == ["wait 1 s", "stop axis 2"]
