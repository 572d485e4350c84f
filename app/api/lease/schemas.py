"""Shapes of the lease: who has the bench, and who would like to have it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, ConfigDict, Field, StringConstraints

from ...settings import VANISH_AFTER_S, OnVanish
from ..http.actor import NAME_MAX, plain_name
from ..schemas import Answer, Body, Number


def _shown(name: str) -> str:
    plain = plain_name(name)
    if not plain:
        raise ValueError("a name has at least one character that can be shown")
    return plain


PersonName = Annotated[
    str,
    StringConstraints(strict=True, min_length=1, max_length=NAME_MAX, strip_whitespace=True),
    AfterValidator(_shown),
]


class LeaseTake(Body):
    """Under which name to take, or to ask for, the bench."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"name": "Zoë, bench 2"}]})

    name: PersonName = Field(description="what others see")


class LeaseKeep(Body):
    """Empty to say that one is there; or what shall happen when one is not any more, until the server ends."""

    model_config = ConfigDict(json_schema_extra={"examples": [{}, {"on_vanish": "hold", "vanish_after_s": 30}]})

    on_vanish: OnVanish | None = Field(
        default=None,
        description="stop: every motor that this server moved is ramped down, procedures end. hold: rotations, shuttles"
        " and procedures end, a move to a target runs to its end and holds. nothing: all go on",
    )
    vanish_after_s: Annotated[Number, Field(ge=VANISH_AFTER_S[0], le=VANISH_AFTER_S[1])] | None = Field(
        default=None, description="without a sign for so long, the holder has vanished [s]; one is due every 5 s"
    )


class LeaseHandOver(Body):
    """To whom."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"to": "a1b2c3d4"}]})

    to: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=40)] = Field(
        description="`id` of one of those who ask"
    )


class LeaseAsking(Answer):
    """A session that would like to have the bench."""

    id: str
    name: str
    since_s: float = Field(description="how long it has been asking [s]")


class LeaseInfo(Answer):
    """Who has the bench now."""

    state: Literal["free", "taken"]
    holder: str | None = Field(description="the holder's name")
    mine: bool = Field(description="whether the session that asks has it")
    left: bool = Field(
        description="the holder's last page was closed: any other session may take the bench, and a sign of the holder "
        "before that is its return"
    )
    since_s: float | None = Field(description="how long the holder has had it [s]")
    expires_in_s: float | None = Field(description="when the holder will have vanished without another sign [s]")
    asking: list[LeaseAsking] = Field(description="who would like to have it, the longest waiting first")
    on_vanish: OnVanish = Field(description="what happens to moving motors when the holder vanishes")
    vanish_after_s: float
