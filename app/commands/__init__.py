"""Commands that ask a running stepscope: `devices | axis | read | write | move | ... | api`.

Each is one call of `app.client` and a way to print its answer: a table for people, `--json` for programs. What went
wrong is one line on the terminal; exit codes are 1 refused, 2 wrong usage, 3 no server, 4 no answer, 5 not arrived,
6 another session has the bench.

A file a subject; what they share is in `shared`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import typer

from .audit import audit
from .calls import api, calc
from .devices import conditions, devices, read, write
from .diagnosis import doctor
from .history import history, undo
from .lease import lease
from .macros import macro
from .measuring import compare, record, recordings, replay, watch
from .motion import axis, home, move, rotate, stop
from .profile_scripts import script
from .profiles import profile
from .programs import tmcl
from .register_maps import maps
from .start_up import start_up
from .tokens import tokens
from .tuning import tune

COMMANDS: Sequence[Callable[..., None]] = (
    devices,
    conditions,
    axis,
    read,
    write,
    start_up,
    move,
    rotate,
    home,
    stop,
    watch,
    record,
    recordings,
    replay,
    compare,
    audit,
    history,
    undo,
    calc,
    api,
    doctor,
)
WITHOUT_ARGUMENTS = frozenset({"audit", "conditions", "devices", "doctor", "recordings", "stop"})
"""Commands that do something when nothing follows; the others show their help then."""
profile.command(no_args_is_help=True)(script)
GROUPS: Sequence[typer.Typer] = (lease, macro, maps, profile, tmcl, tokens, tune)
"""Subjects with commands of their own, as `stepscope SUBJECT COMMAND`."""
