"""What the page's forms want to know of a field beyond JSON Schema: the key `form` of the field's schema."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict, Unpack, cast

from pydantic import Field

if TYPE_CHECKING:
    from pydantic.config import JsonDict


class FormHints(TypedDict, total=False):
    """Title, description, bounds, default and examples are the schema's own. These are for a form alone."""

    rest_only: bool
    """No form shows it; what it is set to stays."""
    unit: str
    """Where the description does not end with it in brackets."""
    heading: str
    """A shorter title, above a column."""
    group: str
    """The title of the group that it stands in: with others, or alone."""
    proposed: str
    """What a new form begins with. Such a field cannot be left empty."""
    empty: str
    """What holds when nothing is typed, where that is no default of the schema."""
    words: dict[str, str]
    """What its values are called."""
    ports: bool
    """A device name: the ports of the server's machine are offered."""
    where: dict[str, list[str | int]]
    """Models that have it, by keys of their entries in the catalog: one of these values is, or is among, theirs."""
    above: str
    """The field of the same object that it has to be greater than."""
    at_least: str
    """The field of the same object that it must not be less than."""
    needed_with: str
    """The field of the same object that means nothing without it."""
    fold: str
    """Of a whole link: its fields are folded away, and this is what they are about."""


def form(**hints: Unpack[FormHints]) -> JsonDict:
    """The hints as `json_schema_extra`."""
    return {"form": cast("JsonDict", hints)}


REST_ONLY = form(rest_only=True)


def shown(default: Any, title: str, description: str, **hints: Unpack[FormHints]) -> Any:
    """A field of a document that a form shows, with what it is when it is left out."""
    return Field(
        default=default, title=title, description=description, json_schema_extra=form(**hints) if hints else None
    )


def rest_only(default: Any, description: str) -> Any:
    """A field that no form shows."""
    return Field(default=default, description=description, json_schema_extra=REST_ONLY)
