"""What a call may raise. `exit_code` is what the command line ends with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class ClientError(Exception):
    """Anything that went wrong between a script and the bench."""

    exit_code = 1


class Refused(ClientError):
    """The server said no, and why: the problem of RFC 9457 that it answered with."""

    def __init__(self, status: int, problem: Mapping[str, object]) -> None:
        self.status = status
        self.type = str(problem.get("type", "about:blank"))
        """Stable, made for code: `/problems/out-of-range`."""
        self.detail = str(problem.get("detail") or problem.get("title") or f"status {status}")
        way_out = problem.get("way_out")
        self.way_out = str(way_out) if way_out else ""
        """What to do about it; "" where there is nothing to say."""
        facts = problem.get("facts")
        self.facts: Mapping[str, object] = facts if isinstance(facts, Mapping) else {}
        """The numbers behind: minimum, maximum, known..."""
        told = not self.way_out or self.way_out in self.detail
        super().__init__(self.detail if told else f"{self.detail} ({self.way_out})")


class BenchTaken(Refused):
    """Another session has the bench; `stop` and reading work all the same."""

    exit_code = 6

    @property
    def holder(self) -> str:
        """Their name."""
        return str(self.facts.get("holder", ""))


class BenchNotTaken(Refused):
    """The lease of this client has ended: it gave no sign for too long, or handed the bench over."""

    exit_code = 6


def refusal(status: int, problem: Mapping[str, object]) -> Refused:
    """The kind of Refused that a problem is."""
    kinds: Mapping[object, type[Refused]] = {
        "/problems/bench-taken": BenchTaken,
        "/problems/bench-not-taken": BenchNotTaken,
    }
    return kinds.get(problem.get("type"), Refused)(status, problem)


class NoServer(ClientError):
    """Nobody listens there: nothing was sent."""

    exit_code = 3


class NoAnswer(ClientError):
    """The call went out and no answer came back: what it asked for may have happened, or may yet."""

    exit_code = 4


class MoveEnded(ClientError):
    """The axis came to rest elsewhere, or was sent elsewhere, before it arrived."""

    exit_code = 5

    def __init__(self, message: str, position: int, target: int) -> None:
        super().__init__(message)
        self.position = position
        """Where it was seen last [microsteps]."""
        self.target = target


class SearchEnded(ClientError):
    """A search for the reference has failed, or was ended."""

    exit_code = 5

    def __init__(self, state: Mapping[str, Any]) -> None:
        super().__init__(f"the search {state['state']}: {state['message']}")
        self.state = state
        """As the server told it."""
