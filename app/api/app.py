"""The HTTP and WebSocket edge as one application, over a bench that its caller has put together."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, AbstractContextManager

from fastapi import FastAPI
from starlette.routing import BaseRoute

from .. import __version__
from ..calc.signals.instrument_csv import FILE_MAX_BYTES
from ..settings import Settings
from .access import routes as access
from .audit import routes as audit
from .calc import routes as calc
from .catalog import routes as catalog
from .closed_loop import routes as closed_loop
from .conditions import routes as conditions
from .console import routes as tmcl
from .devices import emulator_routes as emulator
from .devices import routes as devices
from .health import routes as health
from .history import routes as history
from .http import openapi, problems
from .http.access import Access, new_token
from .http.actor import ActorMiddleware
from .http.auditing import Auditing
from .http.guard import Guard, is_loopback
from .http.lease_gate import LeaseGate
from .http.log_ins import LogIns
from .http.page import WebUi
from .http.policies import Policies
from .http.roles import RoleGate
from .http.stops_first import StopsFirst
from .layouts import routes as layouts
from .lease import routes as lease
from .links import port_routes as ports
from .links import routes as links
from .macros import routes as macros
from .macros import run_routes as macro_runs
from .motion import procedure_routes as procedures
from .motion import routes as axes
from .motion import stop_routes as stop
from .motors import routes as motors
from .positions import routes as extended_position
from .profiles import routes as profiles
from .profiles import script_routes as profile_scripts
from .programs import debug_routes as debugged_programs
from .programs import routes as programs
from .programs import watch_routes as watched_programs
from .recordings import routes as recordings
from .register_maps import routes as register_maps
from .registers import routes as registers
from .router import BASE
from .server_state import ServerState
from .start_up import routes as start_up
from .studies import noticed as noticed_moves
from .studies import routes as studies
from .tables import routes as tables
from .telemetry import routes as telemetry
from .together import routes as together
from .twin import routes as twin
from .twin.proxy import TwinProxy

# In the order in which addresses are matched, one after the other, which is most of what a request costs: a register
# read at the end of the list takes 240 us, at its head 140 us. So what is asked for many times a second comes first.
SUBJECTS = (
    health,
    registers,
    axes,
    stop,
    lease,
    devices,
    extended_position,
    procedures,
    closed_loop,
    start_up,
    links,
    tmcl,
    programs,
    debugged_programs,
    watched_programs,
    tables,
    profiles,
    history,
    emulator,
    calc,
    catalog,
    register_maps,
    motors,
    layouts,
    macros,
    macro_runs,
    ports,
    recordings,
    profile_scripts,
    studies,
    noticed_moves,
    telemetry,
    conditions,
    twin,
    together,
    audit,
    access,
)

Lifespan = Callable[[FastAPI], AbstractAsyncContextManager[None]]


ROUTES: list[BaseRoute] = [*(route for subject in SUBJECTS for route in subject.router.routes), *health.metrics.routes]
"""Shared by all applications of a process."""


def make_app(bench: ServerState, lifespan: Lifespan, urgent: Callable[[], AbstractContextManager[None]]) -> FastAPI:
    """Routes, errors, guard and browser UI over `bench`; `urgent` holds back what is done in the background."""
    app = FastAPI(
        title="stepscope",
        version=__version__,
        lifespan=lifespan,
        docs_url=None,  # both pages load scripts from elsewhere; a bench may have no network, and the CSP forbids it
        redoc_url=None,
        redirect_slashes=False,
    )
    app.state.bench = bench
    app.state.allowed_methods = openapi.allowed_methods(app)
    app.router.routes.extend(ROUTES)
    # The UI answers what no route knows. As a route it would hide the 405 of the API's own addresses.
    app.router.default = TwinProxy(bench.twin, otherwise=WebUi(bench.settings.web_dir, bench.settings.help_dir))
    problems.install(app)
    policies = Policies(app, BASE)
    openapi.customise(app, policies)
    app.add_middleware(bench.vitals.sockets.middleware)
    # Inside of both doors: whose request it is matters once it is in.
    app.add_middleware(LeaseGate, lease=bench.lease, calls=bench.calls, policies=policies)
    app.add_middleware(RoleGate, policies=policies)
    app.add_middleware(Auditing, audit=bench.audit, manager=bench.manager, policies=policies)
    app.add_middleware(ActorMiddleware, name_of=bench.lease.name_of)
    # Behind the token: a stranger holds nothing back.
    app.add_middleware(StopsFirst, urgent=urgent)
    app.state.token = token_of(bench.settings)
    app.add_middleware(
        Access,
        token=app.state.token,
        tokens=bench.tokens,
        sessions=bench.sessions,
        log_ins=LogIns(bench.audit, bench.clock),
        clock=bench.clock,
    )
    # Added last, so it looks first: a foreign page may not even guess.
    app.add_middleware(
        Guard,
        allowed_hosts=bench.settings.allowed_hosts,
        body_limit_bytes=bench.settings.body_limit_bytes,
        local=is_loopback(bench.settings.host),
        file_bytes_max=FILE_MAX_BYTES,
    )
    return app


def token_of(settings: Settings) -> str | None:
    """What clients have to know: as it is set, a new one where a network can reach us, else None."""
    if settings.token is not None:
        return settings.token.get_secret_value().strip()
    return None if is_loopback(settings.host) else new_token()
