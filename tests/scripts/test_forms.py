"""What becomes of a link's model in the page's connection form."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import pytest
from forms import UnknownShape, link_form
from pydantic import BaseModel, Field

from app.api.devices.schemas import ModuleSerialLink
from app.form_hints import REST_ONLY, form


def form_of(model: type[BaseModel]) -> dict[str, Any]:
    schema = model.model_json_schema(ref_template="#/components/schemas/{model}")
    return link_form(schema, schema.get("$defs", {}))


class Inner(BaseModel):
    depth: float = Field(default=2.5, gt=0, title="Depth", description="of the bore [mm]")
    hidden: int = Field(default=0, json_schema_extra=REST_ONLY)


class Wider(ModuleSerialLink):
    """A serial link with more to say."""

    guard_us: Annotated[int, Field(strict=True, ge=10, lt=901)] | None = Field(
        default=40, title="Guard time", description="silence between two frames [µs]; null: none"
    )
    parity: Literal["none", "even"] = Field(default="none", json_schema_extra=form(words={"even": "even: 8E1"}))
    swapped: bool = False
    inner: Inner = Field(default_factory=Inner, title="The inside", json_schema_extra=form(where={"axes": [1]}))


class OfAxis(BaseModel):
    name: str = Field(default="", title="Name")
    inner: Inner = Field(default_factory=Inner, title="The insides", description="of each")
    untold: Inner = Field(default_factory=Inner, json_schema_extra=REST_ONLY)


class Listed(ModuleSerialLink):
    each: list[OfAxis] = Field(default_factory=list, title="Each axis")


def test_an_object_in_a_list_has_a_group_of_its_own() -> None:
    _, each, insides = form_of(Listed)["groups"]
    assert [(group["title"], group["list"]) for group in (each, insides)] == [
        ("Each axis", "each"),
        ("The insides", "each"),
    ]
    assert insides["help"] == "of each"
    assert [[field["path"] for field in group["fields"]] for group in (each, insides)] == [["name"], ["inner.depth"]]


def test_a_field_that_is_added_to_a_link_is_in_its_form() -> None:
    first, second = form_of(Wider)["groups"]
    assert first["help"] == "A serial link with more to say."
    added = {field["path"]: field for field in first["fields"]}
    assert list(added) == ["port", "baud", "address", "timeout_s", "guard_us", "parity", "swapped"]
    assert added["guard_us"] == {
        "path": "guard_us",
        "title": "Guard time",
        "type": "integer",
        "help": "silence between two frames",
        "unit": "µs",
        "default": 40,
        "minimum": 10,
        "maximum": 900,
    }
    assert added["parity"]["options"] == [{"value": "none", "label": "none"}, {"value": "even", "label": "even: 8E1"}]
    assert added["swapped"]["default"] is False
    assert [each["label"] for each in added["swapped"]["options"]] == ["yes", "no"]
    assert second["title"] == "The inside"
    (depth,) = second["fields"]
    assert depth["above_minimum"]
    assert depth["minimum"] == 0
    assert depth["where"] == {"axes": [1]}


def test_a_field_that_no_form_can_show_is_refused() -> None:
    class Listing(BaseModel):
        codes: list[int]

    with pytest.raises(UnknownShape, match="codes"):
        form_of(Listing)


def test_a_hint_that_no_form_knows_is_refused() -> None:
    class Misspelt(BaseModel):
        code: int = Field(default=1, json_schema_extra={"form": {"untis": "s"}})

    with pytest.raises(UnknownShape, match="code"):
        form_of(Misspelt)
