"""What of a module that is known by name alone is configuration: what it was seen to take, but for state by its name.

The list that such a module comes from tells of no parameter whether it can be written. So its driver keeps in mind what
was written and read back; of that, names tell what is state all the same: where the axis is and is sent, flags, and
what happens once as it is written. Of bank 0 TMCL's standard numbers tell (FM-PD42-1241 5.1).
"""

from __future__ import annotations

import re

from ...registers.listed.modules import role_of
from ...registers.listed.ramp import role_by_name
from ...registers.model import Register, Space
from ..rules import ProfileRules

_STATE = re.compile(
    r"^(linear)?actual|^(linear)?target(position|velocity|torque|flux)$|(encoder|hall|ramp|openloop|latched)\w*position$"
    r"|flags?$|status|state$|acknowledge|trig$|initialization$|^clear(?!on)|^reinit|^driverinit|sum\d?$|^debug"
)
"""Names, in small letters and without underscores."""
_APART = frozenset({*range(64, 77), 81, 82, 83, 86, 87, 88, *range(128, 134), 255})
"""Of bank 0: interfaces, protection, and what a program does."""
_COMMANDED = frozenset({"mode", "target", "position"})
_APART_OF_CHIPS = re.compile(r"otp|factory|test|prog|command|nodeconf|slaveconf|^(?:\w+_)?x_enc$", re.IGNORECASE)
"""Registers that act when they are written, cannot be taken back, or cut the connection."""
_STANDARD = frozenset({"max_speed", "max_acceleration"})


def is_state(row: Register) -> bool:
    """Whether it is no configuration although it can be written."""
    if row.space is Space.REGISTER and (role_by_name(row) in _COMMANDED or _APART_OF_CHIPS.search(row.name)):
        return True
    if row.volatile or row.read_clears or row.space is Space.GLOBAL_2:
        return True
    if row.space is Space.GLOBAL_0:
        return row.address in _APART
    role = role_of(row)
    return role not in _STANDARD if role is not None else bool(_STATE.search(row.name.replace("_", "").casefold()))


RULES = ProfileRules(state=frozenset(), order=("global",), is_state=is_state)
