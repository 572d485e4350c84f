"""Shapes of who may come in."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints

from ...store.tokens import Role
from ..schemas import Answer, Body


class AccessInfo(Answer):
    """Who asks, as the server knows it."""

    name: str | None = Field(description="of the token; null for the server's own one, and without any")
    role: Role = Field(description="look: reads, and stops. drive: everything but tokens. administer: all")
    by: Literal["nothing", "token", "session"] = Field(
        description="nothing: this server asks for no token. session: a cookie, which logging out ends"
    )


class TokenAdd(Body):
    """Who is to come in."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"name": "anna", "role": "drive"}]})

    name: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60)] = Field(
        description="letters, digits and . @ + - _, spaces between; what the lease and the audit log show"
    )
    role: Role


class TokenInfo(Answer):
    """A named token. Itself it is told only once."""

    name: str
    role: Role
    created_unix_s: float
    sessions: int = Field(description="browsers that are logged in with it")


class TokenMade(Answer):
    """A new token: kept nowhere in clear, so write it down."""

    name: str
    role: Role
    token: str
