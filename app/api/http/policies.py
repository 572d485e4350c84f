"""The policies of all routes of a program, by method and address."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import parse_qsl

from fastapi import FastAPI
from fastapi.routing import iter_route_contexts

from ...store.tokens import Role
from ..policy import DEFAULT, Policy, declared_for

CHANGING_METHODS = frozenset({"POST", "PUT", "PATCH", "DELETE"})
"""No route has another method that changes anything: others (QUERY, TRACE) are answered that there is no such call."""


@dataclass(frozen=True, slots=True)
class Declared:
    """A route: its method ("" for a WebSocket), its address below the base, and its policy."""

    method: str
    path: str
    policy: Policy


class Policies:
    """Of the routes of `app` below the address `base`. Whatever is not known to be free needs the bench, and the role
    `drive`, also addresses that nobody has declared anything for."""

    def __init__(self, app: FastAPI, base: str) -> None:
        self.base = base
        self.routes = tuple(_declared(app, base))
        self._free = self._pattern(each for each in self.routes if each.policy.lease == "free")
        self._dry_run = self._pattern(each for each in self.routes if each.policy.lease == "free as a dry run")
        self._looks = self._pattern(each for each in self.routes if each.policy.role == "look")
        self._by_key = {(each.method, re.sub(r"{[^}]*}", "{}", each.path[1:])): each.policy for each in self.routes}
        self.plain = frozenset(key for key in self._by_key if "{}" not in key[1])
        """Calls whose address names nothing."""
        administered = {each.path.split("/")[1] for each in self.routes if each.policy.role == "administer"}
        self._administered = tuple(f"{base}/{subject}" for subject in sorted(administered))

    def needs_no_lease(self, method: str, path: str, query: bytes = b"") -> bool:
        """Whether that call changes nothing that the lease is for."""
        if method not in CHANGING_METHODS:
            return True
        call = f"{method} {path}"
        if self._dry_run.fullmatch(call):
            said = [value for name, value in parse_qsl(query.decode("latin-1"), True) if name == "dry_run"]
            return bool(said) and all(value == "true" for value in said)
        return self._free.fullmatch(call) is not None

    def role(self, method: str, path: str) -> Role:
        """The least role for that call. All of a subject is for who administers it, where one of its calls is."""
        if path.startswith(self._administered):
            return "administer"
        changes = method in CHANGING_METHODS and not self._looks.fullmatch(f"{method} {path}")
        return "drive" if changes else "look"

    def role_of_socket(self, path: str) -> Role:
        """The least role for that WebSocket."""
        return "look" if self._looks.fullmatch(f" {path}") else "drive"

    def of_call(self, key: tuple[str, str]) -> Policy:
        """By method and address below the base without a slash in front, {} for what names something."""
        return self._by_key.get(key, DEFAULT)

    def _pattern(self, routes: Iterable[Declared]) -> re.Pattern[str]:
        calls = sorted({f"{each.method} {re.escape(self.base)}{_template(each.path)}" for each in routes})
        return re.compile("|".join(calls) or r"(?!)")


def _template(path: str) -> str:
    """A pattern for the addresses of a route."""
    return "[^/]+".join(re.escape(part) for part in re.split(r"{[^}]*}", path))


def _declared(app: FastAPI, base: str) -> Iterable[Declared]:
    for context in iter_route_contexts(app.routes):
        path, endpoint = getattr(context, "path", None), getattr(context, "endpoint", None)
        if path is None or endpoint is None or not path.startswith(f"{base}/"):
            continue
        for method in sorted(getattr(context, "methods", None) or ("",)):
            yield Declared(method, path.removeprefix(base), declared_for(endpoint))
