"""The control port of an emulated line: what is on it and its cable as REST, beside the wire.

An application of its own, without devices, store or telemetry: whoever tests a client of theirs against
`stepscope emulate` needs faults, not a dashboard.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Generic, TypeVar

from fastapi import APIRouter, Depends, FastAPI, Request

from .. import __version__
from ..api.http import openapi, problems
from ..api.http.guard import Guard
from ..api.http.problems import problems as responses
from ..emulators.line.faults import LinePatch, LineState
from ..emulators.line.server import LineServer
from ..errors import OutOfRange, UnknownThing, WrongState

BODY_LIMIT_BYTES = 64 * 1024
Far = TypeVar("Far")


class Served:
    """A line that another thread serves. `call` runs a function there, between two frames."""

    def __init__(self, server: LineServer) -> None:
        self.line = server.line
        self.call = server.call


class Several(Served, Generic[Far]):
    """A line, and who is on it by the address that they were started with."""

    kind = "module"

    def __init__(self, server: LineServer, modules: Mapping[int, Far]) -> None:
        super().__init__(server)
        self.modules = modules

    def module(self, address: int | None) -> Far:
        """Raises UnknownThing for an address without a module, WrongState for none where there are several."""
        if address is None:
            if len(self.modules) > 1:
                known = ", ".join(f"/emulator/{known}" for known in self.modules)
                raise WrongState(f"there are several {self.kind}s on this line", f"ask for one of them: {known}")
            return next(iter(self.modules.values()))
        if address not in self.modules:
            raise UnknownThing(self.kind, str(address), [str(known) for known in self.modules])
        return self.modules[address]


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


def control_app(served: Served, emulators: APIRouter, allowed_hosts: tuple[str, ...] = ()) -> FastAPI:
    """A control port with the routes of what is on the line, and those of the line."""
    app = FastAPI(
        title="stepscope emulator",
        version=__version__,
        generate_unique_id_function=openapi.operation_id,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
    )
    app.state.controlled = served
    app.state.allowed_methods = openapi.allowed_methods(app)
    app.include_router(emulators)
    app.include_router(line_router)
    problems.install(app)
    app.add_middleware(Guard, allowed_hosts=allowed_hosts, body_limit_bytes=BODY_LIMIT_BYTES)
    return app
