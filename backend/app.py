"""Assembles the application. Start reading at `create`."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager

from anyio import to_thread
from fastapi import APIRouter, FastAPI
from starlette.middleware import Middleware
from starlette.middleware.exceptions import ExceptionMiddleware
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware
from starlette.types import ASGIApp

from backend import openapi
from backend.access import routes
from backend.access.auth import Guard
from backend.access.door import Door
from backend.access.frames import Frames
from backend.access.rates import Bucket, Rates
from backend.access.rules import METRICS, OPEN, RULES
from backend.access.shares import Shares
from backend.batch import endpoints as batch
from backend.cases import endpoints as cases
from backend.cases import service as evaluator
from backend.catalog import endpoints as catalog
from backend.db import space
from backend.db.engine import connect
from backend.drafts import endpoints as drafts
from backend.events import endpoints as events
from backend.events.hub import Hub
from backend.exports import endpoints as exports
from backend.flights import endpoints as flights
from backend.flights.turns import Turns
from backend.health import endpoints as health
from backend.http import errors, pages, queries
from backend.http.capacity import Capacities
from backend.likelihood import endpoints as likelihood
from backend.metrics import endpoints as metrics
from backend.metrics.requests import Measured, Requests
from backend.metrics.service import Metrics
from backend.middleware.accesses import Accesses
from backend.middleware.edge import Edge
from backend.middleware.frame import Frame
from backend.middleware.heads import Heads
from backend.middleware.hosts import Hosts
from backend.middleware.preferences import Preferred
from backend.middleware.proxy import Proxied
from backend.middleware.visits import Visits
from backend.previews import endpoints as previews
from backend.previews.service import Previews
from backend.proposals import endpoints as proposals
from backend.provider import endpoints as provider
from backend.reports import endpoints as reports
from backend.requirements import endpoints as requirements
from backend.results import endpoints as results
from backend.runs import endpoints as runs
from backend.runs.quota import Quota
from backend.scenes import endpoints as scenes
from backend.scenes.control import channel as views
from backend.scenes.control.viewers import Viewers
from backend.scenes.live.live import Live
from backend.scenes.recordings import pages as recordings
from backend.sessions import endpoints as sessions
from backend.sessions import entrance
from backend.sessions.attempts import Attempts
from backend.sessions.failures import Failures
from backend.sessions.lockout import Lockout
from backend.settings import Settings
from backend.signoffs import endpoints as signoffs
from backend.sweeps import endpoints as sweeps
from backend.tokens import endpoints as tokens
from backend.trail import endpoints as trail
from backend.trends import endpoints as trends
from backend.users import endpoints as users
from backend.webhooks import endpoints as webhooks
from backend.webhooks.dispatcher import Dispatcher
from backend.workers import endpoints as workers
from campaigns.version import VERSION

API = "/api/v1"

PACKED = 1
"""Compression level: halves a run's evaluations (1.7 MB) in about the time that reading them takes."""
UNPACKED = (*DEFAULT_EXCLUDED_CONTENT_TYPES, "text/csv", "application/x-matlab-data", "application/x-mcap")
"""Responses that are compressed already, and streams."""


def create(settings: Settings) -> FastAPI:
    """The application on the settings' database, which must be migrated (`backend.db.engine.migrate`)."""
    engine = connect(settings.database_url)
    room = space.Room(space.places(settings.database_url, settings.data), settings.min_free)
    hub, live, door, capacities = Hub(engine, room), Live(), Door(settings.database_url, settings.cookie), Capacities()
    measured = Requests()
    rates, frames = Rates(settings.max_requests_per_minute), Frames()
    hosts = Hosts(settings.host, settings.public_url, settings.allowed_hosts, settings.allow_any_host)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with AsyncExitStack() as ending:  # in reverse order, and each also if another fails
            ending.callback(engine.dispose)
            ending.push_async_callback(door.close)
            for close in (app.state.cases.close, app.state.previews.stop, live.close):
                ending.push_async_callback(to_thread.run_sync, close)
            for finish in (hub.close, app.state.failures.flush, app.state.webhooks.close):
                ending.push_async_callback(finish)
            await app.state.webhooks.start()
            yield

    app = FastAPI(
        title="Clearance",
        version=VERSION,
        summary="Finds the worst case of an obstacle-avoidance system before the world does.",
        description=queries.RULE,
        lifespan=lifespan,
        middleware=[
            Middleware(Proxied, root=settings.root, trusted=settings.trusted),
            *([Middleware(Accesses)] if settings.access_log else []),
            Middleware(Measured, requests=measured),
            Middleware(Frame, encrypted=settings.encrypted),
            Middleware(Visits, each=settings.max_connections_each),
            Middleware(Edge, hosts=hosts),
            Middleware(Heads),
            Middleware(GZipMiddleware, compresslevel=PACKED, exclude_content_types=UNPACKED),
            Middleware(Guard, door=door, most=settings.max_requests_each, rates=rates, frames=frames),
            Middleware(Preferred),
        ],
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=lambda route: route.name,
        separate_input_output_schemas=False,
    )
    app.state.settings, app.state.engine, app.state.hub, app.state.live = settings, engine, hub, live
    app.state.room = room
    app.state.webhooks = Dispatcher(engine, settings.hooks, settings.public_url)
    app.state.previews, app.state.cases = Previews(), evaluator.process()
    app.state.door, app.state.attempts, app.state.capacities = door, Attempts(door), capacities
    app.state.frames, app.state.failures = frames, Failures(door)
    app.state.lockout, app.state.metrics = Lockout(), Metrics(room, measured)
    app.state.provider = provider.of(settings.provider)
    app.state.provider_noted = Bucket(provider.BURST, provider.PERIOD)
    app.state.recordings = recordings.Recordings(engine, capacities.recordings, settings.pages)
    most = (settings.max_active_runs_each, settings.max_evaluations_each, settings.max_bytes_each)
    app.state.quota = Quota(*most)
    app.state.turns, app.state.streams = Turns(), Shares("streams", settings.max_streams_each)
    app.state.viewers = Viewers(settings.max_viewers, settings.max_viewers_each)
    errors.install(app)
    openapi.install(app)
    api = APIRouter(responses=errors.PROBLEMS)
    api.include_router(health.router)  # monitors and load balancers may append names of their own
    features = (workers, sessions, catalog, previews, drafts, runs, results, exports, reports, signoffs, events)
    others = (batch, flights, cases, proposals, trends, sweeps, webhooks, views, users, tokens, trail, requirements)
    for feature in (*features, *others, likelihood):
        api.include_router(feature.router, dependencies=queries.KNOWN)
    app.include_router(api, prefix=API)  # without one FastAPI builds all routes now, and again later
    app.include_router(health.router, include_in_schema=False)  # where health checks look by default
    app.include_router(metrics.router)
    app.include_router(entrance.router)
    app.include_router(provider.router)
    app.include_router(recordings.router)  # before the viewer, whose routes match any suffix
    app.include_router(scenes.router)
    pages.serve(app, settings.pages)
    rules = RULES | ({METRICS: OPEN} if settings.metrics_open else {})
    app.state.rules = routes.Rules(
        app.router.routes, rules
    )  # refuses to start with a route that the table of rules lacks
    alone: ASGIApp = Measured(ExceptionMiddleware(app.router, app.exception_handlers), measured)
    app.state.alone = Accesses(alone) if settings.access_log else alone  # what answers a request of a batch
    return app
