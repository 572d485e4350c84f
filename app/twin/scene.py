"""From the numbers of an axis to where the parts of the scene are and how they look: a pure function."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .bodies import ARC_RADII, FIELD_LENGTH, IDENTITY, RAIL, STAGE_SWITCHES, Vector
from .colours import Rgb, Scheme, between, rgb
from .geometry import Mesh, arc
from .shape import FIELD_LEAST, AxisPose, Coil, Shape, Travel

Quaternion = tuple[float, float, float, float]

FLASH_S = 1.5
"""How long a slip is shown in red, device time [s]."""
DIM, CLEAR = 0.28, 1.0
"""Opacity of what is not known or not measured, and of what is."""


@dataclass(frozen=True, slots=True)
class Placement:
    """What is told of one node; None: as it was."""

    wxyz: Quaternion | None = None
    position: Vector | None = None
    colour: Rgb | None = None
    opacity: float | None = None
    visible: bool | None = None
    text: str | None = None
    mesh: Mesh | None = None


def about(axis: Vector, degrees: float) -> Quaternion:
    """A turn about a unit vector, right-handed."""
    half = math.radians(degrees % 720.0) / 2
    x, y, z = (part * math.sin(half) for part in axis)
    return math.cos(half), x, y, z


def seen(degrees: float) -> Quaternion:
    """A turn counterclockwise, as the viewer sees the motor and the dial."""
    return about((0.0, -1.0, 0.0), degrees)


def half_turn(degrees: float) -> float:
    """The same direction within -180..180."""
    return (degrees + 180.0) % 360.0 - 180.0


def placements(shape: Shape, look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    """Every node that may differ from one look to the next."""
    placed = _motor(look, scheme) | _dial(look, scheme) | _coils(shape, look, scheme)
    placed |= _stage(look, scheme) if shape.linear else _table(look, scheme)
    return placed | {"/slips": Placement(text=slips_text(look))}


def slips_text(look: AxisPose) -> str:
    """What is told of lost steps."""
    if look.slips is None:
        return "no encoder: lost steps are not seen"
    if not look.slips.events:
        return "no step lost"
    times = "once" if look.slips.events == 1 else f"{look.slips.events} times"
    return f"slipped {times}, {abs(look.slips.lost_full_steps)} full steps off"


def flashing(look: AxisPose) -> bool:
    """Whether a slip was just now."""
    return look.slip_age_s is not None and look.slip_age_s < FLASH_S


def _motor(look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    measured = look.measured_deg is not None
    rotor_deg = look.measured_deg if measured else look.commanded_deg
    steel = rgb("fault", scheme) if flashing(look) else rgb("rotor", scheme)
    # Without an encoder the rotor stands where the counter says: grey, for nobody has looked.
    colour = steel if measured else rgb("missing", scheme)
    return {
        "/motor/rotor": Placement(wxyz=seen(rotor_deg or 0.0)),
        "/motor/rotor/front_cup": Placement(colour=colour),
        "/motor/rotor/rear_cup": Placement(colour=colour),
        "/motor/commanded": Placement(wxyz=seen(look.commanded_deg or 0.0), visible=look.commanded_deg is not None),
        "/motor/measured": Placement(wxyz=seen(look.measured_deg or 0.0), visible=measured),
    }


def _coils(shape: Shape, look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    """Both coils: how they glow in the motor, and where their currents are on the axes of the dial."""
    placed: dict[str, Placement] = {}
    other: Coil = "b" if shape.sine_coil == "a" else "a"
    for name, coil, x, z in (("sine", shape.sine_coil, 0.0, 1.0), ("cosine", other, 1.0, 0.0)):
        current: float | None = getattr(look, f"current_{coil}")
        own = "current_a" if coil == "a" else "coil_b"
        colour = rgb("missing" if current is None else own, scheme)
        amount = current or 0.0
        glow = colour if current is None else between(rgb("coil", scheme), colour, min(1.0, abs(amount)))
        way = FIELD_LENGTH * amount
        placed[f"/motor/coils_{name}"] = Placement(colour=glow)
        placed[f"/dial/{name}"] = Placement(position=(way * x, 0.0, way * z), visible=current is not None)
        placed[f"/dial/{name}/arrow"] = Placement(colour=colour)
        placed[f"/dial/track_{name}"] = Placement(colour=colour, opacity=DIM)
        placed[f"/dial/label_{name}"] = Placement(
            text=coil.upper() if current is not None else f"{coil.upper()}: not told"
        )
    return placed


def _dial(look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    placed: dict[str, Placement] = {}
    field_deg, rotor_deg = look.field_deg, look.rotor_deg
    dead = look.field_share is not None and look.field_share < FIELD_LEAST
    placed["/dial/field"] = Placement(wxyz=seen(field_deg or 0.0), visible=field_deg is not None and not dead)
    placed["/dial/field/arrow"] = Placement(
        # From the position counter alone it is what the chip means to do, not what the coils were seen doing.
        colour=rgb("missing" if look.field_from == "position" else "field", scheme),
    )
    placed["/dial/rotor"] = Placement(wxyz=seen(rotor_deg or 0.0), visible=rotor_deg is not None)
    placed["/dial/rotor/arrow"] = Placement(colour=rgb("fault" if flashing(look) else "encoder_position", scheme))
    known = field_deg is not None and look.load_deg is not None
    load_deg = half_turn(look.load_deg or 0.0)
    # It turns with the field, so that only its length comes late in a slow browser; whole degrees, so that it rests.
    placed["/dial/load"] = Placement(wxyz=seen(field_deg or 0.0))
    placed["/dial/load/arc"] = Placement(
        visible=known and abs(load_deg) >= 0.5,
        mesh=arc(-round(load_deg), 0.0, *ARC_RADII, 0.1, 0.16).facing() if known else None,
    )
    placed["/dial/slip"] = Placement(visible=flashing(look))
    return placed


def along_rail(travel: Travel, place_mm: float) -> float:
    """Where a place of the stage is drawn, a little beyond the ends at the most."""
    share = (place_mm - travel.from_mm) / (travel.to_mm - travel.from_mm)
    return RAIL[0] + (RAIL[1] - RAIL[0]) * max(-0.02, min(1.02, share))


def _mm(place: float) -> str:
    return f"{place:g} mm".replace("-", "\N{MINUS SIGN}")


def _stage(look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    travel = look.travel
    carriage = look.place_measured if look.place_measured is not None else look.place_commanded
    motor_deg = look.measured_deg if look.measured_deg is not None else look.commanded_deg
    known = travel is not None and carriage is not None
    placed = {
        "/stage/carriage": Placement(
            position=(along_rail(travel, carriage) if travel and carriage is not None else sum(RAIL) / 2, 0.0, 0.0)
        ),
        "/stage/carriage/body": Placement(colour=rgb("carriage" if known else "missing", scheme)),
        "/stage/carriage/pointer": Placement(visible=look.place_measured is not None),
        "/stage/commanded": Placement(
            position=(along_rail(travel, look.place_commanded), 0.0, 0.0)
            if travel and look.place_commanded is not None
            else None,
            visible=travel is not None and look.place_commanded is not None,
        ),
        "/stage/spindle": Placement(wxyz=about((1.0, 0.0, 0.0), motor_deg or 0.0)),
        "/stage/label_from": Placement(text="" if travel is None else _mm(travel.from_mm)),
        "/stage/label_to": Placement(text="" if travel is None else _mm(travel.to_mm)),
    }
    ends = {"switch_left": RAIL[0] - 0.95, "switch_right": RAIL[1] + 0.95, "switch_home": sum(RAIL) / 2}
    places = (
        {}
        if travel is None
        else {"switch_left": travel.left_mm, "switch_right": travel.right_mm, "switch_home": travel.home_mm}
    )
    for name in STAGE_SWITCHES:
        closed: bool | None = getattr(look, name)
        place = places.get(name)
        at = ends[name] if place is None or travel is None else along_rail(travel, place)
        # A home switch that never closed stands nowhere; the end switches are at least known to be at the ends.
        shown = closed is not None and (place is not None or name != "switch_home")
        placed[f"/stage/{name}"] = Placement(position=(at, 0.0, 0.0), visible=shown)
        placed[f"/stage/{name}/body"] = Placement(
            colour=rgb(name if closed else "missing", scheme), opacity=DIM if place is None and not closed else CLEAR
        )
    return placed


def _table(look: AxisPose, scheme: Scheme) -> dict[str, Placement]:
    measured = look.place_measured is not None
    place = look.place_measured if measured else look.place_commanded
    return {
        "/table/top": Placement(wxyz=about((0.0, 0.0, 1.0), place or 0.0) if place is not None else IDENTITY),
        "/table/top/plate": Placement(colour=rgb("carriage" if place is not None else "missing", scheme)),
        "/table/top/zero": Placement(colour=rgb("encoder_position" if measured else "position", scheme)),
        "/table/commanded": Placement(
            wxyz=about((0.0, 0.0, 1.0), look.place_commanded or 0.0),
            visible=measured and look.place_commanded is not None,
        ),
    }
