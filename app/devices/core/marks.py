"""What may happen on a device while it is recorded: who tells of it and who keeps it name it by the same words."""

from __future__ import annotations

from typing import Literal

MarkKind = Literal["note", "move", "stopped", "event", "program", "gap", "command", "write", "trigger"]
