"""Bodies as triangles: rings, boxes, arrows. Pure functions; lengths in the scene's unit (1 = 10 mm of a NEMA 17).

Every body here is closed, its faces wind outwards, and it is made along its own axis w; `facing` turns w towards the
viewer, who looks along +Y.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Mesh:
    """`vertices` [n, 3], `faces` [m, 3]."""

    vertices: FloatArray
    faces: NDArray[np.int64]

    @property
    def volume(self) -> float:
        """Of a closed body, by the divergence theorem; negative where faces wind inwards."""
        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)

    def moved(self, *by: float) -> Mesh:
        """Shifted."""
        return Mesh(self.vertices + np.array(by), self.faces)

    def turned(self, degrees: float) -> Mesh:
        """About w, from u to v."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return Mesh(self.vertices @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), self.faces)

    def facing(self) -> Mesh:
        """Turn u to the right, v up, w towards the viewer."""
        u, v, w = self.vertices.T
        return Mesh(np.stack([u, -w, v], axis=1), self.faces)

    def along_x(self) -> Mesh:
        """Turn w to the right, as a spindle lies."""
        u, v, w = self.vertices.T
        return Mesh(np.stack([w, u, v], axis=1), self.faces)


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Several bodies as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
    )


def ring(
    inner: FloatArray | float, outer: FloatArray | float, low: float, high: float, degrees: FloatArray | None = None
) -> Mesh:
    """A body between two outlines around w, from w = `low` to `high`.

    `inner` and `outer` are radii [n] at the angles `degrees` [n]; None stands for a full turn in 96 parts. Angles
    that end less than 360 degrees after they began make a segment, with two more sides.
    """
    angles = np.arange(96) * (360.0 / 96) if degrees is None else degrees
    whole = degrees is None or math.isclose(float(angles[-1] - angles[0]), 360.0)
    if degrees is not None and whole:
        angles = angles[:-1]
    count = len(angles)
    directions = np.stack([np.cos(np.radians(angles)), np.sin(np.radians(angles))], axis=1)
    radii = [np.broadcast_to(np.asarray(radius, dtype=np.float64).ravel()[:count], count) for radius in (inner, outer)]
    layers = [
        np.concatenate([directions * radius[:, None], np.full((count, 1), level)], axis=1)
        for level in (low, high)
        for radius in radii
    ]  # inner low, outer low, inner high, outer high
    in_low, out_low, in_high, out_high = (np.arange(count) + count * layer for layer in range(4))
    faces: list[NDArray[np.int64]] = []

    def strip(a: NDArray[np.int64], b: NDArray[np.int64]) -> None:
        """Quads between two outlines; seen from outside, b lies to the left of a."""
        a_next, b_next = np.roll(a, -1), np.roll(b, -1)
        quads = np.concatenate([np.stack([a, a_next, b_next], axis=1), np.stack([a, b_next, b], axis=1)])
        keep = np.ones(count, dtype=np.bool_)
        keep[-1] = whole
        faces.append(quads[np.concatenate([keep, keep])])

    strip(out_low, out_high)
    strip(in_high, in_low)
    strip(out_high, in_high)
    strip(in_low, out_low)
    if not whole:
        for end, flip in ((0, False), (count - 1, True)):
            a, b, c, d = in_low[end], out_low[end], out_high[end], in_high[end]
            quad = np.array([[a, b, c], [a, c, d]])
            faces.append(quad[:, ::-1] if flip else quad)
    return Mesh(np.concatenate(layers), np.concatenate(faces))


def disc(radius: float, low: float, high: float, sides: int = 64) -> Mesh:
    """A cylinder about w."""
    angles = np.linspace(0.0, 360.0, sides + 1)
    return ring(1e-4, radius, low, high, angles)


def square(half: float, chamfer: float) -> FloatArray:
    """Radii of a square with cut corners at the 96 angles of a full ring."""
    angles = np.radians(np.arange(96) * (360.0 / 96))
    side = half / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    corner = (2 * half - chamfer) / (np.abs(np.cos(angles)) + np.abs(np.sin(angles)))
    return np.asarray(np.minimum(side, corner), dtype=np.float64)


def toothed(teeth: int, root: float, tip: float, tooth: float = 0.42) -> tuple[FloatArray, FloatArray]:
    """Angles [degrees] of a full turn and radii of an outline with teeth; `tooth` is the share of a pitch at the tip.

    A tooth has its middle at 0 degrees.
    """
    half = tooth / 2
    corners = ((-half, tip), (half, tip), (half + 0.06, root), (1 - half - 0.06, root))
    angles = [(number + at) * 360.0 / teeth for number in range(teeth) for at, _ in corners]
    radii = [radius for _ in range(teeth) for _, radius in corners]
    return np.array([*angles, angles[0] + 360.0]), np.array([*radii, radii[0]])


def shoe(teeth: int, pitch_deg: float, tip: float, root: float, outer: float, low: float, high: float) -> Mesh:
    """The end of a pole: a segment around 0 degrees whose inner side has teeth, the middle one (or gap) at 0."""
    angles: list[float] = []
    inner: list[float] = []
    for number in range(teeth):
        middle = (number - (teeth - 1) / 2) * pitch_deg
        for at, radius in ((-0.27, root), (-0.21, tip), (0.21, tip), (0.27, root)):
            angles.append(middle + at * pitch_deg)
            inner.append(radius)
    return ring(np.array(inner), outer, low, high, np.array(angles))


def box(u: tuple[float, float], v: tuple[float, float], w: tuple[float, float]) -> Mesh:
    """Between two corners."""
    vertices = np.array([[x, y, z] for x in u for y in v for z in w], dtype=np.float64)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return Mesh(vertices, np.array(faces))


def prism(outline: Sequence[tuple[float, float]], low: float, high: float) -> Mesh:
    """A convex outline in u, v, counterclockwise, from w = `low` to `high`."""
    count = len(outline)
    flat = np.array(outline, dtype=np.float64)
    vertices = np.concatenate([np.column_stack([flat, np.full(count, level)]) for level in (low, high)])
    faces: list[tuple[int, int, int]] = []
    for corner in range(1, count - 1):
        faces += [(0, corner + 1, corner), (count, count + corner, count + corner + 1)]
    for a in range(count):
        b = (a + 1) % count
        faces += [(a, b, count + b), (a, count + b, count + a)]
    return Mesh(vertices, np.array(faces))


def arrow_head(length: float, width: float, thick: float) -> Mesh:
    """A triangle whose tip is at the origin and which points along u."""
    return prism([(-length, -width / 2), (0.0, 0.0), (-length, width / 2)], -thick / 2, thick / 2)


def arrow(length: float, width: float, head: float, thick: float) -> Mesh:
    """From the origin along u."""
    shaft = box((0.0, length - head * 0.9), (-width / 2, width / 2), (-thick / 2, thick / 2))
    return merged([shaft, arrow_head(head, 3.2 * width, thick).moved(length, 0.0, 0.0)])


ARC_PARTS = 48


def arc(from_deg: float, to_deg: float, inner: float, outer: float, low: float, high: float) -> Mesh:
    """A segment of a ring, counterclockwise or clockwise; always of as many parts, so that it can change its size."""
    first, last = min(from_deg, to_deg), max(from_deg, to_deg)
    return ring(inner, outer, low, high, np.linspace(first, max(last, first + 0.05), ARC_PARTS))


def spindle(radius: float, depth: float, pitch: float, length: float, sides: int = 16, per_pitch: int = 6) -> Mesh:
    """A rod along w with a thread: what makes a turn visible."""
    rows = max(2, round(length / pitch * per_pitch)) + 1
    along = np.linspace(0.0, length, rows)
    angles = np.arange(sides) * 2 * math.pi / sides
    phase = (along[:, None] / pitch - angles[None, :] / (2 * math.pi)) % 1.0
    radii = radius + depth * np.abs(2 * phase - 1)
    vertices = np.stack(
        [radii * np.cos(angles), radii * np.sin(angles), np.broadcast_to(along[:, None], radii.shape)], axis=2
    ).reshape(-1, 3)
    grid = np.arange(rows * sides).reshape(rows, sides)
    a, b = grid[:-1], np.roll(grid, -1, axis=1)[:-1]
    c, d = np.roll(grid, -1, axis=1)[1:], grid[1:]
    faces = [np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([a, c, d], axis=2).reshape(-1, 3)]
    ends = np.concatenate([vertices, [[0.0, 0.0, 0.0], [0.0, 0.0, length]]])
    low, high = len(vertices), len(vertices) + 1
    first, last = grid[0], grid[-1]
    faces.append(np.stack([np.full(sides, low), np.roll(first, -1), first], axis=1))
    faces.append(np.stack([np.full(sides, high), last, np.roll(last, -1)], axis=1))
    return Mesh(ends, np.concatenate(faces))
