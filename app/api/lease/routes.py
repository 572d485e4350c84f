"""The lease: one session at a time may change anything. Stopping is never refused to anybody.

A session is a browser, with all its tabs, or a client that sends `Stepscope-Session` with a random id that it tells
nobody. Any request with it is a sign of life. A page should give its signs from a worker: browsers slow the timers of
hidden tabs down to one a minute. The last tab that is closed should not give the lease back but leave (`POST
/lease/leave`): the bench is free at once where nothing moves, else the next session takes it, and until then
`on_vanish` will take care of its motors.
"""

from __future__ import annotations

from typing import Annotated

from fastapi import Header

from ...devices.core.actor import actor
from ...errors import UnknownThing, WrongState
from ...lease.errors import BenchNotTaken, BenchTaken
from ..deps import CurrentBench
from ..http.actor import SESSION_HEADER
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import LeaseAsking, LeaseHandOver, LeaseInfo, LeaseKeep, LeaseTake

router = subject_router(prefix="/lease", tags=["lease"])

CALLS_END_WITHIN_S = 5.0
"""How long one who takes the bench waits for calls of others that have begun before [s]."""

Session = Annotated[
    str,
    Header(
        alias=SESSION_HEADER,
        min_length=16,
        max_length=200,
        pattern="^[!-~]+$",
        description="a random id of this browser or client; whoever knows it holds its lease",
    ),
]
MaybeSession = Annotated[str | None, Header(alias=SESSION_HEADER, description="to be told whether the lease is mine")]


@router.get("")
async def get_lease(bench: CurrentBench, session: MaybeSession = None) -> LeaseInfo:
    """Who has the bench, for how long, who asks for it, and what happens to motors when the holder vanishes."""
    return _info(bench, session)


@router.post("", responses=problems(BenchTaken))
@policy(lease="free", audit="silent")
async def take_lease(bench: CurrentBench, session: Session, body: LeaseTake) -> LeaseInfo:
    """Take the free bench, or keep it. Answers when calls that others have begun are over, so that one is alone."""
    had_it = bench.lease.is_holder(session)
    bench.lease.take(session, actor.get().token or body.name, actor.get().address)
    if not had_it:  # else those calls are its own
        await bench.calls.over(CALLS_END_WITHIN_S)
    return _info(bench, session)


@router.put("", responses=problems(BenchTaken, BenchNotTaken))
@policy(lease="free", audit="silent")
async def keep_lease(bench: CurrentBench, session: Session, body: LeaseKeep | None = None) -> LeaseInfo:
    """Say that one is still there, every 5 s; or set what happens when one is not."""
    wanted = body or LeaseKeep()
    bench.lease.set(session, wanted.on_vanish, wanted.vanish_after_s)
    return _info(bench, session)


@router.delete("")
@policy(lease="free", audit="silent")
async def give_lease_back(bench: CurrentBench, session: Session) -> LeaseInfo:
    """Give the bench back, or stop asking for it. Motors are left alone: one who gives it back knows what they do."""
    bench.lease.give_back(session)
    return _info(bench, session)


@router.post("/leave")
@policy(lease="free", audit="silent")
async def leave_lease(bench: CurrentBench, session: Session) -> LeaseInfo:
    """The last page of this session closes, or is loaded anew. Where nothing moves that this server has moved, or
    motors are to go on anyway, the bench is free; else it is kept for a return until its holder would have vanished,
    and any other session may take it.
    """
    await bench.pages.leave(session)
    return _info(bench, session)


@router.post("/ask", responses=problems(WrongState))
@policy(lease="free", audit="silent")
async def ask_for_lease(bench: CurrentBench, session: Session, body: LeaseTake) -> LeaseInfo:
    """Ask the holder for the bench. A question stands for 15 s: repeat it, and see by `mine` whether it was granted."""
    bench.lease.ask(session, actor.get().token or body.name, actor.get().address)
    return _info(bench, session)


@router.post("/hand-over", responses=problems(UnknownThing, BenchTaken, BenchNotTaken))
@policy(lease="free", audit="silent")
async def hand_lease_over(bench: CurrentBench, session: Session, body: LeaseHandOver) -> LeaseInfo:
    """Give the bench to one who asks. What runs goes on: rotations, searches, shuttles, recordings."""
    await bench.calls.over(CALLS_END_WITHIN_S)
    bench.lease.hand_over(session, body.to)
    return _info(bench, session)


def _info(bench: ServerState, session: str | None) -> LeaseInfo:
    lease = bench.lease
    holder = lease.holder
    return LeaseInfo(
        state="free" if holder is None else "taken",
        holder=None if holder is None else holder.name,
        mine=lease.is_holder(session),
        left=lease.left,
        since_s=lease.since_s,
        expires_in_s=lease.expires_in_s,
        asking=[LeaseAsking(id=each.id, name=each.name, since_s=lease.waits_s(each)) for each in lease.asking],
        on_vanish=lease.on_vanish,
        vanish_after_s=lease.vanish_after_s,
    )
