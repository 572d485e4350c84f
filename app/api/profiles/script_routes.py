"""Profiles as scripts, each of which was tried on an emulator before it is answered."""

from __future__ import annotations

from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ...profiles.scripts.errors import ScriptFailed
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from .routes import ProfileId
from .script_schemas import ProfileScript, ScriptLanguage, ScriptOrder
from .views import detail

router = subject_router(prefix="/profiles", tags=["profiles"])


@router.get(
    "/{profile}/script",
    responses=problems(UnknownThing, WrongState, ScriptFailed, UsageError, StoreUnavailable),
)
async def make_script(bench: CurrentBench, profile: ProfileId, language: ScriptLanguage) -> ProfileScript:
    """A kept profile as a script, as POST /profiles/script makes it."""
    document = detail(await bench.profile_store.get(profile)).document
    return ProfileScript.model_validate(await bench.scripts.make(document, language))


@router.post("/script", responses=problems(WrongState, ScriptFailed, UsageError))
@policy(lease="free", audit="silent")
async def make_script_of_document(bench: CurrentBench, body: ScriptOrder) -> ProfileScript:
    """A profile that need not be saved, as a script: Python for our client, curl, C, or TMCL for a PD42-1241.

    It was run on an emulator of the profile's model, which then held the profile. That takes a few seconds; the same
    script is not tried twice. One that fails its trial is an error, which tells the differences.
    """
    return ProfileScript.model_validate(await bench.scripts.make(body.document, body.language))
