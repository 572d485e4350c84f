"""Colours of the scene: channels as on every page (web/src/lib/palette.ts; a test compares them), materials calm.

Red is for lost steps alone, as everywhere.
"""

from __future__ import annotations

from typing import Literal

Rgb = tuple[int, int, int]
Scheme = Literal["light", "dark"]

CHANNEL_SHADES: dict[str, tuple[str, str]] = {
    "position": ("#0068a8", "#56b4e9"),
    "encoder_position": ("#6a0f5c", "#e65fb0"),
    "load_angle": ("#4b2fa3", "#8f7bff"),
    "current_a": ("#5c5200", "#f0e442"),
    "coil_b": ("#a86400", "#e69f00"),
    "switch_left": ("#0068a8", "#56b4e9"),
    "switch_right": ("#008060", "#a6e36a"),
    "switch_home": ("#4b2fa3", "#8f7bff"),
}
"""(light, dark) of each channel that is drawn."""

MATERIALS: dict[str, tuple[str, str]] = {
    "background": ("#ffffff", "#242424"),  # of the page around it
    "housing": ("#3c4248", "#3a4046"),
    "cap": ("#c3c8ce", "#9aa1a9"),
    "lamination": ("#8f98a3", "#7a838d"),
    "rotor": ("#b4bcc6", "#a3acb6"),
    "magnet": ("#5d6772", "#5b6570"),
    "shaft": ("#dfe3e8", "#d3d8de"),
    "screw": ("#6b747e", "#8b949e"),
    "rail": ("#c9ced5", "#6a727b"),
    "carriage": ("#9aa4af", "#98a2ad"),
    "line": ("#5a6472", "#a4adb8"),
    "face": ("#f1f3f5", "#2e3338"),
    "field": ("#23292f", "#f1f3f5"),
    "coil": ("#d5d2cc", "#4b4d50"),
    "missing": ("#b9bec5", "#656c74"),
    "fault": ("#d02828", "#d92d2d"),
}


def rgb(name: str, scheme: Scheme) -> Rgb:
    """A channel's or a material's colour. Raises KeyError for what has none."""
    text = (CHANNEL_SHADES.get(name) or MATERIALS[name])[0 if scheme == "light" else 1]
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def between(first: Rgb, second: Rgb, share: float) -> Rgb:
    """`share` 0..1 of the way from one colour to the other."""
    red, green, blue = (round(a + (b - a) * share) for a, b in zip(first, second, strict=True))
    return red, green, blue
