"""Where the time of a file lies on that of the recording beside which it is."""

from __future__ import annotations

from ...calc.signals.alignment import match_of
from ...errors import OutOfRange, UnknownThing, UsageError, WrongState
from ...store.recordings.library import Library
from .schemas import Align
from .views import zero_of

ALIKE = 0.3
"""Correlations below say nothing: those of noise reach so far."""
ROWS_MAX = 4_000_000


def offset_of(library: Library, recording: str, number: int, align: Align) -> tuple[float, str]:
    """The file's 0 since the recording's zero [s], and how it was found.

    Raises UnknownThing, UsageError, WrongState.
    """
    if sum(each is not None for each in (align.offset_s, align.mark, align.like)) > 1:
        raise UsageError("a file is aligned by one of offset_s, mark and like")
    of = library.one_added(recording, number)
    opened, marks = library.open(recording), library.marks(recording)
    zero_s = zero_of(opened, marks) or 0.0
    if align.mark is not None:
        if align.mark >= len(marks):
            raise OutOfRange("mark", align.mark, 0, len(marks) - 1)
        mark = marks[align.mark]
        return mark.time_s - zero_s, f"its 0 on the mark “{mark.text[:80]}”"
    if align.like is None:
        if align.offset_s is None:
            return 0.0, "its 0 on the recording's zero"
        return align.offset_s, "as typed"
    names, own = ([column.name for column in columns] for columns in (opened.head.columns, of.columns))
    for name, known in ((align.like, names), (align.channel or own[0], own)):
        if name not in known:
            raise UnknownThing("channel", name, known)
    if opened.rows > ROWS_MAX:
        raise OutOfRange("rows to align with", opened.rows, 0, ROWS_MAX)
    channel = align.channel or own[0]
    rows, beside = opened.read(0, opened.rows), library.rows_of_one(recording, of)
    values = beside.columns[own.index(channel)]
    recorded = rows.columns[names.index(align.like)]
    found = match_of(rows.time_s - zero_s, recorded, beside.time_s - of.offset_s, values)
    if found is None or abs(found.correlation) < ALIKE:
        how = "one of them does not change" if found is None else f"correlation {found.correlation:.2f} at the best"
        raise WrongState(f"{channel} looks nowhere like {align.like}: {how}", "type the offset, or choose a mark")
    return found.offset_s, f"{channel} like {align.like}, correlation {found.correlation:.3f}"
