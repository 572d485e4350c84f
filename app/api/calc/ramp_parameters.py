"""The named parameters of a ramp, as they come in: known names, and kinds of numbers."""

from __future__ import annotations

from collections.abc import Mapping

from ...errors import UsageError


def check_names(
    given: Mapping[str, object], known: tuple[str, ...], needed: tuple[str, ...], others: tuple[str, ...] = ()
) -> None:
    unknown = [name for name in given if name not in known]
    missing = [name for name in needed if name not in given]
    if unknown:
        raise UsageError(f"there is no parameter {unknown[0]!r}; known: {', '.join((*known, *others))}")
    if missing:
        raise UsageError(f"missing parameters: {', '.join(missing)}")


def number_of(name: str, value: float | str) -> float:
    if isinstance(value, str):
        raise UsageError(f"{name} is a number, not {value!r}")
    return value


def whole_of(name: str, value: float | str) -> int:
    if isinstance(value, str) or value != int(value):
        raise UsageError(f"{name} is a whole number, not {value!r}")
    return int(value)
