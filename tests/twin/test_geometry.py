"""Bodies are closed, wind outwards and have the size that they should."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from app.twin.bodies import TEETH, Part, scenery
from app.twin.geometry import ARC_PARTS, Mesh, arc, arrow, box, disc, merged, prism, ring, shoe, spindle, toothed

PARTS = {part.name: part for linear in (True, False) for part in scenery(linear=linear).parts}


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (ring(1.0, 2.0, 0.0, 1.0), 3 * math.pi),
        (disc(1.0, -1.0, 1.0), 2 * math.pi),
        (arc(20.0, 110.0, 1.0, 2.0, 0.0, 1.0), 3 * math.pi / 4),
        (box((-1.0, 1.0), (0.0, 2.0), (0.0, 3.0)), 12.0),
        (prism([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], 0.0, 1.0), 0.5),
        (arrow(2.0, 0.1, 0.3, 0.1), 1.73 * 0.1 * 0.1 + 0.5 * 0.32 * 0.3 * 0.1),
        (spindle(0.5, 0.0, 1.0, 4.0, sides=90), math.pi),
    ],
)
def test_volumes(mesh: Mesh, volume: float) -> None:
    assert mesh.volume == pytest.approx(volume, rel=5e-3)
    assert mesh.turned(33.0).volume == pytest.approx(mesh.volume)
    assert mesh.moved(1.0, -2.0, 3.0).volume == pytest.approx(mesh.volume)
    assert mesh.facing().volume == pytest.approx(mesh.volume)
    assert mesh.along_x().volume == pytest.approx(mesh.volume)
    assert merged([mesh, mesh.moved(9.0, 0.0, 0.0)]).volume == pytest.approx(2 * mesh.volume)


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS.keys())
def test_every_body_is_closed_and_solid(part: Part) -> None:
    edges = Counter[tuple[int, int]]()
    for a, b, c in part.mesh.faces.tolist():
        edges.update([(a, b), (b, c), (c, a)])
    assert all(edges[b, a] == count for (a, b), count in edges.items())  # each side has its neighbour
    assert part.mesh.volume > 0
    assert np.isfinite(part.mesh.vertices).all()


def test_a_rotor_has_its_teeth() -> None:
    degrees, radii = toothed(TEETH, 1.0, 1.1)
    tips = radii > 1.05
    assert np.count_nonzero(np.diff(tips[:-1].astype(int), append=int(tips[0])) > 0) == TEETH
    assert degrees[-1] - degrees[0] == pytest.approx(360.0)


def test_a_pole_has_a_tooth_in_its_middle() -> None:
    mesh = shoe(5, 7.2, 1.17, 1.22, 1.33, -1.0, 1.0)
    radii = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    angles = np.degrees(np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0]))
    assert radii[np.abs(angles) < 1.6].min() == pytest.approx(1.17)
    assert np.abs(angles).max() < 22.5 - 3.0  # eight of them have room, and a gap between


@pytest.mark.parametrize(("first", "last"), [(0.0, 0.0), (0.0, -90.0), (-180.0, 180.0 - 1e-3), (10.0, 11.0)])
def test_an_arc_keeps_its_number_of_parts(first: float, last: float) -> None:
    assert len(arc(first, last, 0.9, 1.0, 0.0, 0.1).vertices) == 4 * ARC_PARTS


def test_frames_and_bodies_have_names_of_their_own() -> None:
    for linear in (True, False):
        made = scenery(linear=linear)
        names = [*made.frames, *(part.name for part in made.parts), *(label.name for label in made.labels)]
        assert len(names) == len(set(names))
