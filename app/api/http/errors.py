"""Errors that only the edge raises; the others are in links/errors.py."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...errors import UsageError, WrongState

if TYPE_CHECKING:  # the page is served before NumPy is there
    from ...calc.microsteps.mslut import Refusal
    from ...store.tokens import Role


class UnencodableWave(UsageError):
    """A wave that no register values make: the place, the reason, and how far the nearest encodable one is."""

    def __init__(self, refusal: Refusal, distance_max: float) -> None:
        super().__init__(f"entry {refusal.index} of the wave cannot be encoded: {refusal.detail}")
        self.index = refusal.index
        self.reason = refusal.reason
        self.distance_max = distance_max
        self.way_out = (
            "POST /calc/microstep-table answers the nearest encodable wave, "
            f"which is at most {distance_max:.1f} counts away"
        )


class ForeignPage(WrongState):
    """A page of another web site asks for what changes something, although it is asked by GET."""


class RoleTooLow(WrongState):
    """Who asks is in, and may not do that: with which role, and which one it needs."""

    def __init__(self, token: str, role: Role, needed: Role, what: str) -> None:
        whose = f"the token {token!r}" if token else "this token"
        super().__init__(
            f"{whose} has the role {role}, which {MAY[role]}; {what} needs {needed}",
            f"ask who administers this server for a token with the role {needed} "
            f"(stepscope tokens add NAME --role {needed}); POST /stop is for every role",
        )
        self.token, self.role, self.needed = token, role, needed


MAY: dict[Role, str] = {
    "look": "reads everything but tokens, calculates, and stops motors",
    "drive": "does everything but to administer tokens",
    "administer": "does everything",
}
