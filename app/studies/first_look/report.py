"""What a report tells of a first look: how far the encoder was from the position, on ways there and back."""

from __future__ import annotations

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line
from ..record import StudyRecord

COLOURS = {"up": "#1971c2", "down": "#e8590c"}


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.looked
    if found is None:
        return []
    x = PlotAxis([value for way in found.ways for value in way.position_fullsteps], EDGE, WIDTH - 10)
    y = PlotAxis([value for way in found.ways for value in way.deviation_fullsteps], HEIGHT - EDGE, 10)
    drawn = []
    for way in found.ways:
        name = "up" if way.forward else "down"
        points = zip(way.position_fullsteps, way.deviation_fullsteps, strict=True)
        drawn.append(line([(x.at(position), y.at(deviation)) for position, deviation in points], COLOURS[name], name))
    legend = ", ".join(f'<b style="color:{colour}">{name}</b>' for name, colour in COLOURS.items())
    plot = frame(x, y, "position [full steps]", "encoder less position [full steps]", "".join(drawn))
    return ["<h2>Encoder over position</h2>" + plot + f"<p>{legend}</p>"]
