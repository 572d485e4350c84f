"""What a report tells of motor and machine beside its findings: a ring as it was measured, and as it was fitted."""

from __future__ import annotations

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line
from ...number_text import plain
from ..record import StudyRecord

MEASURED, FITTED = "#e8590c", "#1971c2"


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    ringing = None if record.identified is None else record.identified.ringing
    if ringing is None:
        return []
    x = PlotAxis(ringing.time_s, EDGE, WIDTH - 10)
    y = PlotAxis([*ringing.measured_deg, *ringing.fitted_deg], HEIGHT - EDGE, 10)
    drawn = "".join(
        line([(x.at(t), y.at(value)) for t, value in zip(ringing.time_s, curve, strict=True)], colour, name)
        for name, curve, colour in (
            ("measured", ringing.measured_deg, MEASURED),
            ("fitted", ringing.fitted_deg, FITTED),
        )
    )
    legend = (
        f'<p><b style="color:{MEASURED}">measured</b>, <b style="color:{FITTED}">fitted</b>: '
        f"{plain(ringing.residual_deg, 3)} degrees electrical are left of all rings, root mean square</p>"
    )
    return ["<h2>A ring after a hop</h2>" + frame(x, y, "time [s]", "rotor [deg electrical]", drawn) + legend]
