"""What stands in the scene before anything moves: a NEMA 17 with its front taken off, a dial of electrical angles, and
a stage or a rotary table.

The viewer looks along +Y, Z is up; 1 stands for 10 mm of the motor. The stage is a scheme: always as long as it is
drawn, whatever its travel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .geometry import Mesh, arc, arrow, box, disc, merged, prism, ring, shoe, spindle, square, toothed

Vector = tuple[float, float, float]

TEETH = 50
"""Of the rotor: a full step is a quarter of a tooth, so 200 are a turn."""
POLES = 8
DIAL_AT: Vector = (5.1, 0.0, 0.0)
DIAL_RADIUS = 2.0
FIELD_LENGTH = 1.8
ROTOR_LENGTH = 1.5
ARC_RADII = (0.86, 0.98)
RAIL = (-1.35, 6.45)
"""Where the middle of the carriage may be, from the left end of what is drawn to its right end."""
STAGE_Z = -3.45
TABLE_AT: Vector = (2.55, 0.0, -3.7)
TABLE_RADIUS = 2.2
STAGE_SWITCHES = ("switch_left", "switch_right", "switch_home")
IDENTITY = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Part:
    """A body of one colour: a channel's or a material's. Its name ends in its own, after those of its frames."""

    name: str
    mesh: Mesh
    colour: str
    opacity: float | None = None
    visible: bool = True


@dataclass(frozen=True, slots=True)
class Label:
    """A text in the scene."""

    name: str
    text: str
    position: Vector
    scale: float = 0.8


@dataclass(frozen=True, slots=True)
class Scenery:
    """Frames with their places, bodies and labels."""

    frames: dict[str, Vector]
    parts: tuple[Part, ...]
    labels: tuple[Label, ...]


def scenery(*, linear: bool) -> Scenery:
    """All of it, with a stage (linear) or a rotary table."""
    frames: dict[str, Vector] = {
        "/motor/rotor": (0.0, 0.0, 0.0),
        "/motor/commanded": (0.0, 0.0, 0.0),
        "/motor/measured": (0.0, 0.0, 0.0),
        "/dial": DIAL_AT,
        "/dial/field": (0.0, 0.0, 0.0),
        "/dial/rotor": (0.0, 0.0, 0.0),
        "/dial/load": (0.0, 0.0, 0.0),
        "/dial/sine": (0.0, 0.0, 0.0),
        "/dial/cosine": (0.0, 0.0, 0.0),
    }
    parts = [*_motor(), *_dial()]
    x, y, z = DIAL_AT
    reach = DIAL_RADIUS + 0.34
    labels = [
        Label("/dial/label_sine", "", (0.0, 0.0, reach)),
        Label("/dial/label_cosine", "", (reach, 0.0, 0.0)),
        Label("/slips", "", (x, y, z - DIAL_RADIUS - 0.42)),
    ]
    if linear:
        frames["/stage"] = (0.0, 0.0, STAGE_Z)
        frames |= {f"/stage/{name}": (0.0, 0.0, 0.0) for name in ("carriage", "commanded", "spindle", *STAGE_SWITCHES)}
        parts += _stage()
        labels += [
            Label(f"/stage/label_{side}", "", (RAIL[end], -1.5, -1.0)) for end, side in enumerate(("from", "to"))
        ]
    else:
        frames |= {"/table": TABLE_AT, "/table/top": (0.0, 0.0, 0.0), "/table/commanded": (0.0, 0.0, 0.0)}
        parts += _table()
        labels += [
            Label(f"/table/label_{angle}", f"{angle}°", (*_around(angle, TABLE_RADIUS + 1.0), 0.1))
            for angle in (0, 90, 180, 270)
        ]
    return Scenery(frames, tuple(parts), tuple(labels))


def _motor() -> list[Part]:
    housing, cap = square(2.115, 0.55), square(2.115, 0.7)
    stem = box((1.2, 1.66), (-0.2, 0.2), (-1.25, 1.35))
    pole = merged([stem, shoe(5, 360.0 / TEETH, 1.175, 1.225, 1.33, -1.3, 1.38)])
    coil = merged([box((1.34, 1.6), (-0.36, -0.2), (-1.4, 1.5)), box((1.34, 1.6), (0.2, 0.36), (-1.4, 1.5)),
                   box((1.34, 1.6), (-0.36, 0.36), (1.36, 1.5))])  # fmt: skip
    turns = [number * 360.0 / POLES for number in range(POLES)]
    angles, outline = toothed(TEETH, 1.085, 1.155)
    cup = ring(0.27, outline, 0.1, 1.4, angles)
    magnet = merged([ring(0.27, 0.92, -0.05, 0.1), ring(0.5, 0.8, 1.4, 1.44)])
    screws = [disc(0.14, 1.8, 1.93, 20).moved(u, v, 0.0) for u in (-1.55, 1.55) for v in (-1.55, 1.55)]
    marks = [
        box((1.83, 2.0 if number % 3 else 2.06), (-0.012, 0.012), (1.8, 1.83)).turned(number * 30.0)
        for number in range(12)
    ]
    return [
        Part("/motor/housing", ring(1.74, housing, -1.5, 1.5).facing(), "housing"),
        Part("/motor/front", ring(1.8, cap, 1.5, 1.8).facing(), "cap"),
        Part("/motor/rear", merged([ring(0.3, cap, -1.85, -1.5)]).facing(), "cap"),
        Part("/motor/screws", merged(screws).facing(), "screw"),
        Part("/motor/marks", merged(marks).facing(), "line"),
        Part("/motor/yoke", ring(1.62, 1.75, -1.3, 1.38).facing(), "lamination"),
        Part("/motor/poles", merged([pole.turned(turn) for turn in turns]).facing(), "lamination"),
        # Of eight poles each coil has every second.
        Part("/motor/coils_cosine", merged([coil.turned(turn) for turn in turns[::2]]).facing(), "coil"),
        Part("/motor/coils_sine", merged([coil.turned(turn) for turn in turns[1::2]]).facing(), "coil"),
        Part("/motor/rotor/front_cup", cup.facing(), "rotor"),
        # The rear cup stands half a tooth off: that is what makes a hybrid motor.
        Part("/motor/rotor/rear_cup", cup.moved(0.0, 0.0, -1.45).turned(180.0 / TEETH).facing(), "rotor"),
        Part("/motor/rotor/magnet", magnet.facing(), "magnet"),
        Part("/motor/rotor/shaft", ring(1e-4, _flattened(0.25), -2.6, 2.3).facing(), "shaft"),
        Part("/motor/rotor/mark", box((0.3, 1.06), (-0.03, 0.03), (1.4, 1.46)).facing(), "field"),
        Part("/motor/commanded/hand", _hand(1.72, 0.045, 2.02).facing(), "position"),
        Part("/motor/measured/disc", _encoder_disc().facing(), "encoder_position", 0.55),
        Part("/motor/measured/hand", _hand(1.72, 0.07, 1.9).facing(), "encoder_position"),
    ]  # fmt: skip


def _flattened(radius: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Outline of a shaft with a flat."""
    angles = np.radians(np.arange(96) * (360.0 / 96))
    with np.errstate(divide="ignore"):
        flat = np.where(np.sin(angles) > 0, 0.8 * radius / np.maximum(np.sin(angles), 1e-9), np.inf)
    return np.minimum(radius, flat)


def _hand(length: float, width: float, level: float) -> Mesh:
    return prism([(0.62, -width), (length, -0.012), (length, 0.012), (0.62, width)], level, level + 0.04)


def _encoder_disc() -> Mesh:
    slots = [ring(0.5, 0.58, 1.9, 1.94, np.linspace(at - 3.0, at + 3.0, 3)) for at in range(0, 360, 12)]
    return merged([ring(0.26, 0.5, 1.9, 1.94), ring(0.58, 0.64, 1.9, 1.94), *slots])


def _dial() -> list[Part]:
    radius = DIAL_RADIUS
    long = box((radius - 0.3, radius - 0.04), (-0.015, 0.015), (0.0, 0.02))
    short = box((radius - 0.14, radius - 0.04), (-0.015, 0.015), (0.0, 0.02))
    ticks = [(short if number % 6 else long).turned(number * 15.0) for number in range(24)]
    # The current of a coil is a slide on the coil's own axis: it only moves, which a browser shows at once, while what
    # changes its size comes a frame or more later.
    slide = merged([prism([(-0.2, 0.0), (0.0, -0.2), (0.2, 0.0), (0.0, 0.2)], 0.03, 0.09)])
    track = box((-FIELD_LENGTH, FIELD_LENGTH), (-0.035, 0.035), (0.0, 0.03))
    arrows = {
        "sine": slide,
        "cosine": slide,
        "field": arrow(FIELD_LENGTH, 0.08, 0.3, 0.08).moved(0.0, 0.0, 0.2),
        "rotor": arrow(ROTOR_LENGTH, 0.16, 0.36, 0.05).moved(0.0, 0.0, 0.13),
    }
    colours = {"sine": "coil", "cosine": "coil", "field": "field", "rotor": "encoder_position"}
    return [
        Part("/dial/face", disc(radius, -0.12, -0.02, 96).facing(), "face"),
        Part("/dial/rim", ring(radius - 0.04, radius + 0.05, -0.14, 0.05).facing(), "line"),
        Part("/dial/ticks", merged(ticks).facing(), "line"),
        Part("/dial/hub", disc(0.12, 0.0, 0.28, 32).facing(), "line"),
        Part("/dial/track_sine", track.turned(90.0).facing(), "coil"),
        Part("/dial/track_cosine", track.facing(), "coil"),
        Part("/dial/load/arc", arc(0.0, 1.0, *ARC_RADII, 0.1, 0.16).facing(), "load_angle", visible=False),
        Part("/dial/slip", ring(radius + 0.07, radius + 0.2, -0.1, 0.05).facing(), "fault", visible=False),
        *(Part(f"/dial/{name}/arrow", each.facing(), colours[name]) for name, each in arrows.items()),
    ]  # fmt: skip


def _stage() -> list[Part]:
    left, right = RAIL[0] - 1.05, RAIL[1] + 1.05
    base = box((left, right), (-1.25, 1.25), (-0.95, -0.7))
    rails = [box((left + 0.3, right - 0.3), (y - 0.12, y + 0.12), (-0.7, -0.5)) for y in (-0.85, 0.85)]
    ends = [box((x, x + 0.3), (-1.1, 1.1), (-0.7, 0.25)) for x in (left, right - 0.3)]
    carriage = merged(
        [box((-0.65, 0.65), (-1.05, 1.05), (-0.48, 0.18)), box((-0.75, 0.75), (-1.15, 1.15), (0.18, 0.34))]
    )
    ticks = [
        box((x - 0.012, x + 0.012), (-1.27, -1.25), (-0.95, -0.82 if number % 5 else -0.74))
        for number, x in enumerate(np.linspace(*RAIL, 21))
    ]
    lever = merged(
        [box((-0.16, 0.16), (-1.62, -1.3), (-0.95, -0.35)), box((-0.05, 0.05), (-1.5, -1.4), (-0.35, -0.12))]
    )
    pointer = prism([(-0.11, -0.72), (0.11, -0.72), (0.0, -0.46)], 1.16, 1.24)
    thread = spindle(0.13, 0.06, 0.42, right - left - 0.6)
    return [
        Part("/stage/base", base, "rail"),
        Part("/stage/rails", merged(rails), "cap"),
        Part("/stage/ends", merged(ends), "housing"),
        Part("/stage/ticks", merged(ticks), "line"),
        Part("/stage/spindle/thread", thread.along_x().moved(left + 0.3, 0.0, 0.0), "shaft"),
        Part("/stage/carriage/body", carriage, "carriage"),
        Part("/stage/carriage/mark", box((-0.03, 0.03), (-1.17, 1.15), (0.18, 0.36)), "field"),
        Part("/stage/carriage/pointer", pointer.moved(0.0, 0.5, 0.02).facing(), "encoder_position"),
        Part("/stage/commanded/pointer", pointer.moved(0.0, -0.02, 0.12).facing(), "position"),
        *(Part(f"/stage/{name}/body", lever, name) for name in STAGE_SWITCHES),
    ]  # fmt: skip


def _around(degrees: float, radius: float) -> tuple[float, float]:
    """A place on the table at that mark; 0 is towards the viewer."""
    angle = math.radians(degrees - 90.0)
    return radius * math.cos(angle), radius * math.sin(angle)


def _table() -> list[Part]:
    radius = TABLE_RADIUS
    marks = [
        box((radius + 0.12, radius + 0.12 + length), (-0.02, 0.02), (0.1, 0.13)).turned(number * 10.0 - 90.0)
        for number in range(36)
        for length in (0.42 if number % 9 == 0 else 0.3 if number % 3 == 0 else 0.18,)
    ]
    slots = [
        box((0.5, radius - 0.3), (-0.06, 0.06), (0.24, 0.255)).turned(turn) for turn in (-45.0, 45.0, 135.0, 225.0)
    ]
    zero = prism([(0.35, -0.09), (radius, -0.02), (radius, 0.02), (0.35, 0.09)], 0.24, 0.32).turned(-90.0)
    hand = prism([(-0.12, -0.26), (0.12, -0.26), (0.0, 0.0)], 0.13, 0.2)
    return [
        Part("/table/base", merged([disc(1.7, -0.75, -0.1), disc(2.0, -0.85, -0.75)]), "housing"),
        Part("/table/scale", ring(radius + 0.06, radius + 0.7, -0.1, 0.1), "rail"),
        Part("/table/marks", merged(marks), "line"),
        Part("/table/top/plate", disc(radius, -0.1, 0.24, 96), "carriage"),
        Part("/table/top/slots", merged(slots), "housing"),
        Part("/table/top/hub", disc(0.3, 0.24, 0.36, 32), "shaft"),
        Part("/table/top/zero", zero, "encoder_position"),
        Part("/table/commanded/hand", hand.moved(0.0, -radius - 0.14, 0.0), "position"),
    ]
