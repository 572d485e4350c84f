"""Why a session may not change anything at present."""

from __future__ import annotations

from ..errors import WrongState


class BenchTaken(WrongState):
    """Another session has the bench: whose, for how long already, and when it is free unless they keep it [s]."""

    def __init__(self, holder: str, since_s: float, expires_in_s: float) -> None:
        super().__init__(
            f"{holder} has the bench",
            f"ask {holder} to hand it over (POST /lease/ask, stepscope lease ask), or try again when it is free; "
            "POST /stop stops every motor for everybody at any time",
        )
        self.holder, self.since_s, self.expires_in_s = holder, since_s, expires_in_s


class BenchNotTaken(WrongState):
    """A session that only looks wants to change something, or one whose lease has ended wants to keep it."""

    def __init__(self, why: str = "this session only looks") -> None:
        super().__init__(why, "take the bench first, it is free: POST /lease")
