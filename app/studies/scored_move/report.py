"""What a report tells of a scored move: its figures, and the settings that were in force."""

from __future__ import annotations

from ...html_report import number, table
from ...number_text import plain
from ..record import StudyRecord


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found, trial = record.scored, record.trial(record.best)
    if found is None or trial is None:
        return []
    rows = (
        ("time of a move [s]", number(found.time_s)),
        ("overshoot [full steps]", number(found.overshoot_fullsteps, 3)),
        ("greatest deviation [full steps]", number(found.peak_fullsteps, 3)),
        ("vibration under way [full steps]", number(found.vibration_fullsteps, 3)),
        ("vibration at its end [full steps]", number(found.rest_fullsteps, 3)),
        ("lost [full steps]", number(found.lost_fullsteps, 3)),
        ("least load value", number(found.load_min, 3)),
        ("that above a stall's", number(found.load_margin, 3)),
        (
            "stopped by a stall",
            f"at {found.stalled_at}, after {number(100 * found.reached, 3)} %" if found.stalls else "no",
        ),
    )
    settings = [(name, plain(value, 6)) for name, value in trial.setting.items()]
    return ["<h2>Figures</h2>" + table(("", ""), rows), "<h2>Settings in force</h2>" + table(("", ""), settings)]
