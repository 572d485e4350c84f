"""Profiles as the API tells them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from ...profiles.diff import Diff
from ...profiles.document import parse
from ...profiles.errors import Change
from ...profiles.journal import Unfinished
from ...profiles.service import Outcome
from ...profiles.writing import Progress
from ...registers.catalog import MODELS, listings
from ...store.profiles import SavedProfile
from .schemas import (
    ApplyProgress,
    HalfApplied,
    ProfileApplied,
    ProfileDetail,
    ProfileInfo,
    RegisterChange,
    TakenBack,
    UnfinishedProfile,
)


def dry_run(diff: Diff) -> ProfileApplied:
    """What would be done."""
    return ProfileApplied(**_parts(diff), state="dry run", written=[], prepared=[], settings=[])


def applied(outcome: Outcome) -> ProfileApplied:
    """What was done."""
    done = outcome.applied
    return ProfileApplied(
        **_parts(done.diff),
        state="applied" if done.written or outcome.settings or done.stored is not None else "unchanged",
        written=[change(each) for each in done.written],
        prepared=done.prepared,
        stored_commands=done.stored,
        settings=outcome.settings,
        took_s=outcome.took_s,
    )


def _parts(diff: Diff) -> dict[str, object]:
    return {name: getattr(diff, name) for name in Diff.model_fields}


def change(told: Change) -> RegisterChange:
    return RegisterChange.model_validate(told)


def progress_of(progress: Progress | None, unfinished: Unfinished | None) -> ApplyProgress:
    """What is under way, or was left."""
    if progress is not None:
        return ApplyProgress(
            state="running",
            phase=progress.phase,
            done=progress.done,
            total=progress.total,
            register_name=progress.place,
        )
    if unfinished is None:
        return ApplyProgress(state="idle")
    halves = [HalfApplied(**asdict(half.change), state=half.state) for half in unfinished.halves]
    told = UnfinishedProfile(
        profile=unfinished.profile,
        model=unfinished.model,
        started_unix_s=unfinished.started_unix_s,
        by=unfinished.by,
        crashed=unfinished.crashed,
        registers=halves,
    )
    return ApplyProgress(state="unfinished", unfinished=told)


def taken_back(changes: Sequence[Change]) -> TakenBack:
    return TakenBack(registers=[change(each) for each in changes])


def info(saved: SavedProfile) -> ProfileInfo:
    """A kept profile's line of the list."""
    return ProfileInfo.model_validate(_info(saved))


def detail(saved: SavedProfile) -> ProfileDetail:
    """A kept profile. Raises UnreadableProfile for one that another version has written."""
    return ProfileDetail.model_validate({**_info(saved), "document": parse(saved.document)})


def _info(saved: SavedProfile) -> dict[str, object]:
    titles = {model.name: model.title for model in (*MODELS.values(), *listings())}
    tables = saved.document.get("tables") or {}
    words = sum(len(table) for table in tables.values() if isinstance(table, list | dict))
    return {
        "id": saved.id,
        "name": saved.name,
        "model": saved.model,
        "title": titles.get(saved.model, saved.model),
        "device": str(saved.document.get("device", "")),
        "note": saved.note,
        "created_unix_s": saved.created_unix_s,
        "version": saved.version,
        "registers": len(saved.document.get("registers", ())) + len(saved.document.get("parameters", ())) + words,
    }
