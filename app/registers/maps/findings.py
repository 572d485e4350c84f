"""What is wrong with a register map: every mistake with its line, all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...errors import UsageError

TOLD_MAX = 50
"""Mistakes that are told of one file; of more there is their number."""


@dataclass(frozen=True, slots=True, order=True)
class Finding:
    """One mistake: on which line, of what, and what is allowed instead."""

    line: int
    where: str
    """`register XTARGET, address`; empty where it is the file."""
    what: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.where}{': ' if self.where else ''}{self.what}"


class UnreadableMap(UsageError):
    """A register map that says what cannot be. `findings` has every mistake, by lines."""

    def __init__(self, name: str, findings: Sequence[Finding]) -> None:
        told = sorted(findings)[:TOLD_MAX]
        more = len(findings) - len(told)
        text = "; ".join(str(finding) for finding in told[:3])
        rest = len(findings) - len(told[:3])
        super().__init__(f"the register map {name!r} is not right: {text}{f'; and {rest} more' if rest > 0 else ''}")
        self.name, self.more = name, more
        self.findings: list[dict[str, Any]] = [
            {"line": each.line, "where": each.where, "what": each.what} for each in told
        ]
