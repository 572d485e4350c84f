"""A profile of a TMCL module as a program in its own language."""

from __future__ import annotations

from collections.abc import Iterator

from ...devices.core.tmcl_frames import spelled, writing
from ...errors import WrongState
from .plan import Plan, Write, meaning
from .text import ascii_only, lines, one_line


def render(plan: Plan) -> str:
    """The whole program: commands to be sent one by one, or to be downloaded and run. Raises WrongState for a chip."""
    if plan.family.kind != "module":
        raise WrongState(f"a {plan.family.title} speaks no TMCL", "take Python, curl or C")
    return "\n".join(_lines(plan)) + "\n"


def _lines(plan: Plan) -> Iterator[str]:
    for line in _remarks(plan):
        yield f"// {ascii_only(line)}".rstrip()
    for part in plan.parts:
        yield ""
        yield f"// {ascii_only(one_line(part.title))}"
        for write in part.writes:
            command = spelled(writing(0, write.register, write.value))
            yield f"{command:<28} // {ascii_only(_remark(write))}"
    yield ""
    yield "STOP"


def _remarks(plan: Plan) -> Iterator[str]:
    yield f"Profile: {one_line(plan.name)}"
    yield f"{plan.about}"
    yield from lines(plan.note)
    yield from plan.left_out
    yield "The motor has to stand at its target. User variables go to RAM: STGP keeps one."
    yield "STOP ends a program that was downloaded; line by line, it is left out."


def _remark(write: Write) -> str:
    return one_line(f"{write.register.name}: {meaning(write)}")
