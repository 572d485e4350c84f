"""Writes docs/not-modelled.md: the settings that an emulated device keeps without acting on them, from the tables."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from app.registers.catalog import MODELS

PAGE = Path(__file__).parent.parent / "docs" / "not-modelled.md"
HEAD = """\
# Settings that are not modelled

An emulated device keeps these, reads them back, and does nothing by them; why not stands beside each. The pages show
the same sentence as a tag of the row, and REST as `behaviour` in `GET /api/v1/catalog/MODEL`. Every other setting of
the motor driver of a TMC5xxx or a module changes what its emulated motor does:
`tests/emulators/tmc5xxx/test_every_setting.py` and
`tests/emulators/tmcl/test_every_setting.py` try each. The TMC26x behind
an emulated TMC4361 only keeps its words.

Written by `scripts/not_modelled.py` from the tables of registers and parameters.
"""


def text() -> str:
    """The whole page."""
    return "".join(f"{line}\n" for line in (HEAD, *_families()))


def _families() -> Iterator[str]:
    found: dict[str, dict[tuple[str, str], list[str]]] = {}
    for model in MODELS.values():
        rows = found.setdefault(model.family, {})
        for row in model.table:
            for name, why in [(row.name, row.behaviour), *((f"{row.name}.{f.name}", f.behaviour) for f in row.fields)]:
                titles = rows.setdefault((name, why), []) if why else []
                if model.title not in titles:
                    titles.append(model.title)
    for family, rows in found.items():
        if rows:
            yield f"## {family}\n"
            yield "| setting | of | why |\n|---|---|---|"
            yield from (f"| `{name}` | {', '.join(titles)} | {why} |" for (name, why), titles in rows.items())
            yield ""


if __name__ == "__main__":
    PAGE.write_text(text().rstrip() + "\n", encoding="utf-8")
