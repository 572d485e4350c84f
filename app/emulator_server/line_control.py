"""The control port of an emulated line: what is on it and its cable as REST, beside the wire.

An application of its own, without devices, store or telemetry: whoever tests a client of theirs against
`stepscope emulate` needs faults, not a dashboard.
"""

# Annotations are no strings here: FastAPI reads the types of a family that a function was given.
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from fastapi import APIRouter, Depends, FastAPI, Path, Request
from pydantic import BaseModel

from .. import __version__
from ..api.http import openapi, problems
from ..api.http.guard import Guard
from ..api.http.problems import problems as responses
from ..api.router import operation_id
from ..emulators.core.family import Emulator, EmulatorFamily
from ..emulators.line.faults import LinePatch, LineState
from ..emulators.line.server import LineServer
from ..errors import OutOfRange, UnknownThing, WrongState

BODY_LIMIT_BYTES = 64 * 1024


class Served:
    """A line that another thread serves. `call` runs a function there, between two frames."""

    def __init__(self, server: LineServer) -> None:
        self.line = server.line
        self.call = server.call


class Several(Served):
    """A line, and the emulators of one family on it by the address that they were started with."""

    def __init__(
        self,
        server: LineServer,
        family: EmulatorFamily[Any, Any],
        emulators: Mapping[int, Emulator],
        kind: str = "module",
        addresses: range = range(1, 256),
    ) -> None:
        """`kind` is the word for one of them, `addresses` are those that there can be."""
        super().__init__(server)
        self.family, self.emulators, self.kind, self.addresses = family, emulators, kind, addresses

    def emulator(self, address: int | None) -> Emulator:
        """Raises UnknownThing for an address without one, WrongState for none where there are several."""
        if address is None:
            if len(self.emulators) > 1:
                known = ", ".join(f"/emulator/{known}" for known in self.emulators)
                raise WrongState(f"there are several {self.kind}s on this line", f"ask for one of them: {known}")
            return next(iter(self.emulators.values()))
        if address not in self.emulators:
            raise UnknownThing(self.kind, str(address), [str(known) for known in self.emulators])
        return self.emulators[address]


line_router = APIRouter(tags=["line"])


async def _served(request: Request) -> Served:
    served = request.app.state.controlled
    assert isinstance(served, Served)
    return served


CurrentLine = Annotated[Served, Depends(_served)]
REFUSED = responses(UnknownThing, WrongState, OutOfRange)


# Plain functions, which run in a thread of their own: each waits until the line is between two frames.
@line_router.get("/line")
def get_line(far: CurrentLine) -> LineState:
    """Baud rate, modules and faults of the line itself."""
    return far.call(far.line.state)


@line_router.patch("/line")
def change_line(far: CurrentLine, body: LinePatch) -> LineState:
    """Faults of the cable, which hit every module and questions too; the baud rate of the wire."""
    return far.call(lambda: far.line.patch(body))


# Plain functions, which run in a thread of their own: each waits until the line is between two frames.
def make_control_app(several: Several) -> FastAPI:
    """The control port over a line of emulators, with the guard and the problems of the dashboard's API."""
    router, kind = APIRouter(tags=["emulator"]), several.kind
    at = Path(
        description=f"the address that the {kind} was started with", ge=several.addresses[0], le=several.addresses[-1]
    )
    if TYPE_CHECKING:
        State: TypeAlias = BaseModel
        Patch: TypeAlias = BaseModel
    else:
        State: TypeAlias = several.family.state
        Patch: TypeAlias = several.family.patch

    @router.get("/emulator", responses=REFUSED)
    def get_emulator() -> State:
        """The one emulator on this line, its motors and its faults."""
        return several.call(several.emulator(None).state)

    @router.patch("/emulator", responses=REFUSED)
    def change_emulator(body: Patch) -> State:
        """Cause faults, load the shaft, force switches; what is left out stays."""
        emulator = several.emulator(None)
        return several.call(lambda: emulator.patch(body))

    @router.get("/emulator/{address}", responses=REFUSED)
    def get_emulator_at(address: Annotated[int, at]) -> State:
        """One of several."""
        return several.call(several.emulator(address).state)

    @router.patch("/emulator/{address}", responses=REFUSED)
    def change_emulator_at(address: Annotated[int, at], body: Patch) -> State:
        """The same for one of several."""
        emulator = several.emulator(address)
        return several.call(lambda: emulator.patch(body))

    return control_app(several, router)


def control_app(served: Served, emulators: APIRouter) -> FastAPI:
    """A control port with the routes of what is on the line, and those of the line."""
    app = FastAPI(
        title="stepscope emulator",
        version=__version__,
        generate_unique_id_function=operation_id,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
    )
    app.state.controlled = served
    app.state.allowed_methods = openapi.allowed_methods(app)
    app.include_router(emulators)
    app.include_router(line_router)
    problems.install(app)
    app.add_middleware(Guard, allowed_hosts=(), body_limit_bytes=BODY_LIMIT_BYTES)
    return app
