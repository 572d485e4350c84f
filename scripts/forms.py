"""Makes of the API's schema what the page's connection form is made of: groups of fields for each kind of link."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

Json = dict[str, Any]
UNIT = re.compile(r"\s*\[([^\[\]]+)\]$")
NULL = re.compile(r"; null\b[^;]*$")
"""What null stands for is said in the place of a value: hint `empty`."""
COPIED = ("minimum", "maximum", "pattern", "maxLength", "examples")
HINTS = (
    "heading", "proposed", "empty", "words", "ports", "where", "above", "at_least", "needed_with",
)  # fmt: skip


class UnknownShape(ValueError):
    """A field of a kind that no form can show: it wants the hint `rest_only`, or a form that can."""


def connection_forms(schema: Json) -> Json:
    """Return the forms of every link and of an axis, and which model has which link by which kind."""
    components: Json = schema["components"]["schemas"]
    bodies = [_resolved(each, components) for each in components["DeviceCreate"]["oneOf"]]
    links: Json = {}
    models: list[Json] = []
    for body in bodies:
        properties = body["properties"]
        kinds = {kind: _name(ref) for kind, ref in properties["link"]["discriminator"]["mapping"].items()}
        links |= {name: link_form(components[name], components) for name in kinds.values()}
        # Listed models have a pattern instead of names: of those entries the one with all of their wires is theirs.
        models.append({"names": _values(properties["model"]), "links": kinds})
    axes = bodies[0]["properties"]["axes"]
    axis = link_form(_resolved(_not_null(axes)["items"], components), components)
    name = _field("name", bodies[0]["properties"]["name"], required=True, group={})
    return {"models": models, "links": links, "axis": axis, "name": name}


def link_form(schema: Json, components: Json) -> Json:
    """Return the form of one link (or of an axis): its own fields first, then a group for each object within."""
    own: list[Json] = []
    groups: list[Json] = []
    for name, prop in schema["properties"].items():
        hints = prop.get("form", {})
        if "const" in prop or hints.get("rest_only"):
            continue
        inner = _object_of(prop, components)
        if inner is None:
            field = _field(name, prop, name in schema.get("required", ()), hints)
            _put(groups, hints["group"], [field]) if "group" in hints else own.append(field)
            continue
        is_list = _not_null(prop).get("type") == "array"
        # Beside a word that may stand for the object, a description is of the word.
        about = "" if "anyOf" in prop else prop.get("description", "")
        of_list = {"list": name} if is_list else {}
        objects = {key: found for key, value in inner["properties"].items() if (found := _object_of(value, components))}
        prefix = "" if is_list else f"{name}."
        fields = _fields(prefix, inner, hints, but=objects)
        _put(groups, prop.get("title", name), fields, help=about, **of_list)
        for key, within in objects.items():
            value = inner["properties"][key]
            if not value.get("form", {}).get("rest_only"):
                fields = _fields(f"{prefix}{key}.", within, hints)
                _put(groups, value.get("title", key), fields, help=value.get("description", ""), **of_list)
    # A description beside a form is the first paragraph, in one line.
    first = " ".join(schema.get("description", "").split("\n\n")[0].split())
    fold = schema.get("form", {}).get("fold")
    return {**({"fold": fold} if fold else {}), "groups": [{"title": "", "help": first, "fields": own}, *groups]}


def _fields(prefix: str, schema: Json, group: Json, but: Collection[str] = ()) -> list[Json]:
    """The fields of an object that a form shows."""
    return [
        _field(f"{prefix}{key}", value, key in schema.get("required", ()), group)
        for key, value in schema["properties"].items()
        if key not in but and not value.get("form", {}).get("rest_only")
    ]


def _put(groups: list[Json], title: str, fields: list[Json], **more: str) -> None:
    """Add fields to the group of that title, or a new one."""
    for group in groups:
        if group["title"] == title:
            group["fields"] += fields
            return
    groups.append({"title": title, "help": "", **more, "fields": fields})


def _field(path: str, prop: Json, required: bool, group: Json) -> Json:
    plain = _not_null(prop)
    hints = prop.get("form", {})
    known = plain.get("type") in ("integer", "number", "string", "boolean")
    if not known or hints.keys() - {*HINTS, "unit", "group"}:
        raise UnknownShape(f"{path}: {plain}")
    text = NULL.sub("", prop.get("description", ""))
    found = UNIT.search(text)
    unit = hints.get("unit", found.group(1) if found else "")
    field: Json = {"path": path, "title": prop.get("title", path), "type": plain["type"]}
    field |= {"help": UNIT.sub("", text), "unit": unit, "required": required}
    if "default" in prop:
        field["default"] = prop["default"]
    field |= {key: (prop | plain)[key] for key in COPIED if key in prop or key in plain}
    if "exclusiveMinimum" in plain:
        field |= {"minimum": plain["exclusiveMinimum"], "above_minimum": True}
    if "exclusiveMaximum" in plain:
        if plain["type"] != "integer":
            raise UnknownShape(f"{path} is less than a number: a form knows at most")
        field["maximum"] = plain["exclusiveMaximum"] - 1
    values = [True, False] if plain["type"] == "boolean" else _values(plain)
    if values:
        words = {"true": "yes", "false": "no"} | hints.get("words", {})
        texts = [str(value).lower() if isinstance(value, bool) else str(value) for value in values]
        field["options"] = [{"value": text, "label": words.get(text, text)} for text in texts]
    field |= {key: value for key, value in hints.items() if key in HINTS and key != "words"}
    if "where" in group:
        field["where"] = group["where"] | field.get("where", {})
    return {key: value for key, value in field.items() if key == "default" or (value != "" and value is not False)}


def _values(prop: Json) -> list[Any]:
    """The values that a property is limited to, or none."""
    return [prop["const"]] if "const" in prop else prop.get("enum", [])


def _not_null(prop: Json) -> Json:
    """A property without its null, and of an object or a word the object."""
    choices = [each for each in prop.get("anyOf", ()) if each.get("type") != "null" and "const" not in each]
    return choices[0] if len(choices) == 1 else prop


def _object_of(prop: Json, components: Json) -> Json | None:
    plain = _not_null(prop)
    item = plain["items"] if plain.get("type") == "array" else plain
    return _resolved(item, components) if "$ref" in item else None


def _resolved(item: Json, components: Json) -> Json:
    found: Json = components[_name(item["$ref"])] if "$ref" in item else item
    return found


def _name(ref: str) -> str:
    return ref.rpartition("/")[2]
