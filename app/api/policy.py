"""What a call needs, and what the audit log is told of it: declared beside its route.

A route that declares nothing needs the bench and the role `drive` where it changes something, is there for everybody
who is in where it only reads, and is entered in the audit log: forgetting a declaration cannot open anything.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

from fastapi import APIRouter
from fastapi.routing import APIRoute, APIWebSocketRoute

from ..store.audit_entries import Value
from ..store.tokens import Role

Lease = Literal["needed", "free", "free as a dry run"]
"""Whether the caller has to have the bench; of the last only where the query says `dry_run=true`."""
Audit = Literal["entered", "silent", "silent as a dry run", "told by drivers"]
"""What of a call that was done is in the audit log. What registers hold afterwards drivers tell: only what they have
not told is entered for such a call. Refused ones are entered, but for silent ones."""
Json = Mapping[str, Any]
F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Call:
    """A call from outside, taken apart. `key` is its method and address, with {} for what names something."""

    key: tuple[str, str]
    names: tuple[str, ...]
    """What stood in place of each {}."""
    query: Json
    body: Json
    answer: Any = None
    device: str | None = None
    axis: int | None = None


@dataclass(frozen=True, slots=True)
class Said:
    """A call in words."""

    action: str
    subject: str = ""
    old: Value = None
    new: Value = None
    detail: str = ""
    device: str | None = None
    axis: int | None = None
    more: tuple[Said, ...] = field(default=())
    """Further entries of the same call."""


def _never(_: Call) -> bool:
    return False


@dataclass(frozen=True, slots=True)
class Policy:
    """Of one call.

    role : the least role; None for `look` where it reads and `drive` where it changes something
    stops : it stops a motor: free for everybody who is in
    partly : its answer is a success as a whole and may hold failures
    whole : many writes that are one thing: entered as such too, when one has failed and the drivers have told of it
    words : how the audit log calls it; None for words made of its address
    changed_nothing : whether a call that was done changed nothing, by its answer: then it is not entered
    """

    lease: Lease = "needed"
    role: Role | None = None
    stops: bool = False
    audit: Audit = "entered"
    partly: bool = False
    whole: bool = False
    words: Callable[[Call], Said] | None = None
    changed_nothing: Callable[[Call], bool] = _never


DEFAULT = Policy()
_declared: dict[Callable[..., Any], Policy] = {}
"""By the route's function."""


def policy(
    *,
    lease: Lease = "needed",
    role: Role | None = None,
    stops: bool = False,
    audit: Audit = "entered",
    partly: bool = False,
    whole: bool = False,
    words: Callable[[Call], Said] | None = None,
    changed_nothing: Callable[[Call], bool] = _never,
) -> Callable[[F], F]:
    """Declare the policy of the route's function below it."""
    if stops:
        lease, role = "free", "look"

    def declared(function: F) -> F:
        _declared[function] = Policy(lease, role, stops, audit, partly, whole, words, changed_nothing)
        return function

    return declared


def policy_of_all(router: APIRouter, of_all: Policy) -> None:
    """Declare one policy for every route of `router` that has none of its own."""
    for route in router.routes:
        if isinstance(route, APIRoute | APIWebSocketRoute):
            _declared.setdefault(route.endpoint, of_all)


def declared_for(function: Callable[..., Any]) -> Policy:
    """The policy of a route's function."""
    return _declared.get(function, DEFAULT)
