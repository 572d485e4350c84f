"""Who a request is let in as: by which token, with which role."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from starlette.types import Scope

from ...store.tokens import Role, at_least
from .errors import RoleTooLow

_KEY = "stepscope.identity"


@dataclass(frozen=True, slots=True)
class Identity:
    """One who is in. `hash` is that of the token that let it in: "" is the server's own, None is no token at all."""

    name: str
    """The token's; empty for the server's own token, and without any."""
    role: Role
    hash: str | None
    session: str | None = None
    """The cookie's session, a secret; None for a call that brings its token itself, or none."""

    def require(self, needed: Role, what: str) -> None:
        """Raises RoleTooLow where that role is beyond this one."""
        if not at_least(self.role, needed):
            raise RoleTooLow(self.name, self.role, needed, what)


ANYBODY = Identity("", "administer", None)
"""On a server that asks for no token."""
OWN = Identity("", "administer", "")
"""With the server's own token."""


def identity_of(scope: Scope) -> Identity:
    """Who sent that request, as the door has found."""
    return cast("Identity", scope[_KEY])


def identify(scope: Scope, identity: Identity) -> None:
    """The door has found who it is."""
    scope[_KEY] = identity
