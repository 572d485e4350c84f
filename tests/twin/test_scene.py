"""Where the parts are and how they look, as numbers."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.twin.bodies import FIELD_LENGTH, RAIL, scenery
from app.twin.colours import CHANNEL_SHADES, MATERIALS, Scheme, between, rgb
from app.twin.scene import FLASH_S, Placement, about, half_turn, placements, seen
from app.twin.shape import AxisPose, Shape, Slips, Travel, look_of, sine_coil_of

STAGE = Shape("bench", 0, "X", microsteps=16, travel_mm_per_rev=8.0)
TABLE = Shape("pair", 1, "turn", microsteps=16)
TRAVEL = Travel(-40.0, 40.0, left_mm=-38.0)
EVERYTHING = look_of(
    STAGE,
    2.0,
    {
        "position": 3200.0,
        "encoder_position": 3192.0,
        "deviation": -8.0,
        "mscnt": 128.0,
        "current_a": 175.0,
        "current_b": 175.0,
        "switch_left": 1.0,
        "switch_right": 0.0,
    },
    Slips(),
    TRAVEL,
)
PALETTE = Path(__file__).parents[2] / "web" / "src" / "lib" / "palette.ts"


def turned(wxyz: tuple[float, float, float, float] | None, vector: tuple[float, float, float]) -> np.ndarray:
    """A vector, turned by a quaternion."""
    assert wxyz is not None
    w, q = wxyz[0], np.array(wxyz[1:])
    v = np.array(vector)
    return np.asarray(v + 2 * w * np.cross(q, v) + 2 * np.cross(q, np.cross(q, v)))


def direction(placed: dict[str, Placement], name: str) -> float:
    """Where an arrow of the dial points, as the viewer sees it [degrees]."""
    x, _, z = turned(placed[name].wxyz, (1.0, 0.0, 0.0))
    return math.degrees(math.atan2(z, x)) % 360.0


@pytest.mark.parametrize("shape", [STAGE, TABLE], ids=["stage", "table"])
@pytest.mark.parametrize("look", [AxisPose(), EVERYTHING], ids=["nothing", "everything"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_whatever_is_placed_exists(shape: Shape, look: AxisPose, scheme: Scheme) -> None:
    made = scenery(linear=shape.linear)
    known = {*made.frames, *(part.name for part in made.parts), *(label.name for label in made.labels)}
    assert placements(shape, look, scheme).keys() <= known


def test_arrows_point_where_the_numbers_say() -> None:
    placed = placements(STAGE, EVERYTHING, "light")
    assert direction(placed, "/dial/field") == pytest.approx(45.0)
    assert direction(placed, "/dial/rotor") == pytest.approx(0.0, abs=1e-6)  # a half step of load is 45 degrees
    shift = FIELD_LENGTH * 175.0 / 256.0
    assert placed["/dial/sine"].position == pytest.approx((0.0, 0.0, shift))
    assert placed["/dial/cosine"].position == pytest.approx((shift, 0.0, 0.0))


@pytest.mark.parametrize(
    ("model", "sine", "cosine"), [("tmc4361", "current_a", "current_b"), ("tmc5160", "current_b", "current_a")]
)
def test_the_field_is_the_sum_of_both_currents(model: str, sine: str, cosine: str) -> None:
    shape = replace(STAGE, sine_coil=sine_coil_of(model))
    for turn in range(0, 360, 15):
        amounts = {sine: 256 * math.sin(math.radians(turn)), cosine: 256 * math.cos(math.radians(turn))}
        placed = placements(shape, look_of(shape, 0.0, amounts), "dark")
        assert half_turn(direction(placed, "/dial/field") - turn) == pytest.approx(0.0, abs=1e-6)
        up, right = placed["/dial/sine"].position, placed["/dial/cosine"].position
        assert up is not None
        assert right is not None
        assert half_turn(math.degrees(math.atan2(up[2], right[0])) - turn) == pytest.approx(0.0, abs=1e-6)
        assert placed["/dial/label_sine"].text == sine[-1].upper()


@pytest.mark.parametrize("model", ["tmc4361", "tmc5160"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_coil_has_its_colour_in_the_motor_and_on_the_dial_and_the_other_one_another(
    model: str, scheme: Scheme
) -> None:
    shape = replace(STAGE, sine_coil=sine_coil_of(model))
    placed = placements(shape, look_of(shape, 0.0, {"current_a": 256.0, "current_b": 256.0}), scheme)
    sine, cosine = (
        {placed[place].colour for place in (f"/motor/coils_{name}", f"/dial/{name}/arrow", f"/dial/track_{name}")}
        for name in ("sine", "cosine")
    )
    assert len(sine) == len(cosine) == 1
    assert sine != cosine


def test_the_arc_reaches_from_the_rotor_to_the_field() -> None:
    placed = placements(STAGE, EVERYTHING, "light")
    mesh = placed["/dial/load/arc"].mesh
    assert mesh is not None
    assert placed["/dial/load/arc"].visible
    angles = np.degrees(np.arctan2(mesh.vertices[:, 2], mesh.vertices[:, 0]))
    assert angles.min() == pytest.approx(-45.0)
    assert angles.max() == pytest.approx(0.0, abs=0.1)
    assert direction(placed, "/dial/load") == pytest.approx(45.0)


def test_what_is_not_measured_is_grey_and_hidden() -> None:
    placed = placements(STAGE, look_of(STAGE, 1.0, {"position": 3200.0}, travel=TRAVEL), "light")
    grey = rgb("missing", "light")
    for name in (
        "/motor/coils_sine",
        "/motor/coils_cosine",
        "/motor/rotor/front_cup",
        "/dial/field/arrow",
        "/dial/track_sine",
    ):
        assert placed[name].colour == grey
    for name in (
        "/motor/measured",
        "/dial/sine",
        "/dial/cosine",
        "/dial/rotor",
        "/dial/load/arc",
        "/stage/carriage/pointer",
    ):
        assert placed[name].visible is False
    assert placed["/slips"].text == "no encoder: lost steps are not seen"
    assert placed["/motor/commanded"].visible is True


def test_with_nothing_at_all_nothing_moves() -> None:
    placed = placements(STAGE, AxisPose(), "dark")
    assert placed["/stage/carriage/body"].colour == rgb("missing", "dark")
    for name in ("/motor/commanded", "/motor/measured", "/dial/field", "/stage/commanded", "/stage/switch_left"):
        assert placed[name].visible is False


def test_coils_glow_with_their_current_whichever_way_it_flows() -> None:
    for amount in (-256.0, 256.0):
        placed = placements(STAGE, look_of(STAGE, 0.0, {"current_a": amount, "current_b": 0.0}), "dark")
        assert placed["/motor/coils_sine"].colour == rgb("current_a", "dark")
        assert placed["/motor/coils_cosine"].colour == rgb("coil", "dark")


def test_the_shaft_turns_with_the_encoder_and_the_thin_hand_with_the_counter() -> None:
    placed = placements(STAGE, EVERYTHING, "light")
    assert direction(placed, "/motor/rotor") == pytest.approx(360.0 * 3192 / 3200)
    assert half_turn(direction(placed, "/motor/commanded")) == pytest.approx(0.0, abs=1e-6)


def test_the_carriage_stands_where_it_was_measured() -> None:
    placed = placements(STAGE, EVERYTHING, "light")
    carriage, commanded = placed["/stage/carriage"].position, placed["/stage/commanded"].position
    assert carriage is not None
    assert commanded is not None
    per_mm = (RAIL[1] - RAIL[0]) / 80.0
    assert carriage[0] == pytest.approx(RAIL[0] + (40.0 + 7.98) * per_mm)
    assert commanded[0] == pytest.approx(RAIL[0] + 48.0 * per_mm)


@given(st.floats(-1e6, 1e6))
def test_the_carriage_never_leaves_the_picture(position: float) -> None:
    look = look_of(STAGE, 0.0, {"position": position}, travel=TRAVEL)
    carriage = placements(STAGE, look, "light")["/stage/carriage"].position
    assert carriage is not None
    assert RAIL[0] - 0.2 <= carriage[0] <= RAIL[1] + 0.2


def test_switches_show_their_state_and_what_is_known_of_their_place() -> None:
    placed = placements(STAGE, EVERYTHING, "light")
    assert placed["/stage/switch_left/body"].colour == rgb("switch_left", "light")
    left = placed["/stage/switch_left"].position
    assert left is not None
    assert left[0] == pytest.approx(RAIL[0] + 2.0 / 80.0 * (RAIL[1] - RAIL[0]))
    assert placed["/stage/switch_right/body"].colour == rgb("missing", "light")
    assert placed["/stage/switch_right/body"].opacity is not None
    assert placed["/stage/switch_right/body"].opacity < 1  # nobody has seen where it is
    assert placed["/stage/switch_home"].visible is False


def test_a_table_turns_against_its_scale() -> None:
    placed = placements(TABLE, look_of(TABLE, 0.0, {"position": 800.0}), "light")
    assert turned(placed["/table/top"].wxyz, (1.0, 0.0, 0.0)) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert placed["/table/top/zero"].colour == rgb("position", "light")


def test_a_slip_flashes_and_is_told() -> None:
    slipped = look_of(STAGE, 10.0, {"deviation": -64.0, "mscnt": 0.0}, Slips(4, 1, 10.0 - FLASH_S / 2))
    placed = placements(STAGE, slipped, "light")
    assert placed["/dial/slip"].visible is True
    assert placed["/motor/rotor/front_cup"].colour != rgb("rotor", "light")
    assert placed["/slips"].text == "slipped once, 4 full steps off"
    later = placements(STAGE, look_of(STAGE, 12.0, {"deviation": -64.0}, Slips(4, 1, 10.0 - FLASH_S / 2)), "light")
    assert later["/dial/slip"].visible is False
    assert later["/slips"].text == "slipped once, 4 full steps off"


@given(st.floats(-1e7, 1e7))
def test_turns_are_turns(degrees: float) -> None:
    assert math.hypot(*seen(degrees)) == pytest.approx(1.0)
    assert -180.0 <= half_turn(degrees) <= 180.0
    x, y, z = turned(about((0.0, 0.0, 1.0), degrees), (1.0, 0.0, 0.0))
    assert (x, y, z) == pytest.approx((math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.0), abs=1e-6)


def test_channels_have_the_colours_of_every_other_page() -> None:
    palette = PALETTE.read_text()
    shades = re.findall(r'^  (\w+): \{ light: "(.+)", dark: "(.+)" \},', palette, re.MULTILINE)
    of_kind = {kind: (light, dark) for kind, light, dark in shades}
    kinds = dict(re.findall(r'^  (\w+): \{ kind: "(\w+)"', palette, re.MULTILINE))
    for name, pair in CHANNEL_SHADES.items():
        assert of_kind[kinds[name]] == pair, name


def test_colours_mix() -> None:
    assert between((0, 0, 0), (200, 100, 50), 0.5) == (100, 50, 25)
    assert not MATERIALS.keys() & CHANNEL_SHADES.keys()
