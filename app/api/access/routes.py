"""Who may come in: who one is, the way out, and the named tokens."""

from __future__ import annotations

from fastapi import Path, Request, Response

from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ..audit import wording
from ..deps import CurrentBench
from ..http.identity import identity_of
from ..http.problems import problems
from ..http.sessions import cookie_name
from ..policy import policy
from ..router import subject_router
from .schemas import AccessInfo, TokenAdd, TokenInfo, TokenMade

router = subject_router(tags=["access"])


@router.get("/access")
async def get_access(request: Request) -> AccessInfo:
    """Who asks, and what that one may do."""
    who = identity_of(request.scope)
    by_token = "nothing" if who.hash is None else "token"
    return AccessInfo(name=who.name or None, role=who.role, by=by_token if who.session is None else "session")


@router.post("/access/log-out", status_code=204)
@policy(lease="free", role="look", words=wording.done("log out"))
async def log_out(request: Request, bench: CurrentBench) -> Response:
    """End this browser's session and its sockets. Without a session there is nothing to end: no error."""
    session = identity_of(request.scope).session
    response = Response(status_code=204)
    if session is not None:
        bench.sessions.end(session)
        bench.vitals.sockets.end(lambda who: who.session == session)
        response.delete_cookie(cookie_name(request.scope), httponly=True, samesite="strict")
    return response


@router.get("/tokens")
@policy(role="administer")
async def list_tokens(bench: CurrentBench) -> list[TokenInfo]:
    """The named tokens, in the order they were made."""
    return [
        TokenInfo(
            name=token.name,
            role=token.role,
            created_unix_s=token.created_unix_s,
            sessions=bench.sessions.of_token(token.hash),
        )
        for token in bench.tokens.all()
    ]


@router.post("/tokens", status_code=201, responses=problems(UsageError, WrongState, StoreUnavailable))
@policy(lease="free", role="administer", words=wording.named("add token"))
async def add_token(bench: CurrentBench, body: TokenAdd, response: Response) -> TokenMade:
    """Make a named token. The answer tells it, and nothing else ever does."""
    response.headers["cache-control"] = "no-store"
    token = await bench.tokens.add(body.name, body.role)
    return TokenMade(name=body.name, role=body.role, token=token)


@router.delete("/tokens/{name}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(lease="free", role="administer", words=wording.named("revoke token"))
async def revoke_token(
    bench: CurrentBench, name: str = Path(description="of the token", max_length=60, pattern=r"^[^\W\d]")
) -> None:
    """Revoke a named token: its sessions and its sockets end at once."""
    await bench.tokens.revoke(name)
