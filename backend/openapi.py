"""The OpenAPI document.

FastAPI derives it from the endpoints. This module adds the schemas that endpoints only reference: problem documents,
the campaign, event payloads.
"""

from __future__ import annotations

import threading

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.responses import JSONResponse, Response
from pydantic import BaseModel
from pydantic.json_schema import JsonSchemaMode, models_json_schema

from backend.access.rules import API, RULES, Rule
from backend.events.watch import NewImprovements
from backend.http.errors import ProblemDocument, declare
from backend.middleware.hosts import HEALTH
from backend.runs.requests import RunSubmit
from backend.sweeps.schemas import SweepSubmit
from campaigns import Campaign
from campaigns.documents import JsonObject

_REF = "#/components/schemas/{model}"
_CAMPAIGN = {"$ref": _REF.format(model="Campaign")}
_MODELS: tuple[tuple[type[BaseModel], JsonSchemaMode], ...] = (
    (ProblemDocument, "serialization"),
    (NewImprovements, "serialization"),
    (Campaign, "serialization"),
    (RunSubmit, "validation"),
    (SweepSubmit, "validation"),
)
_CAMPAIGN_BODY = {
    "type": "object",
    "description": "A campaign to be checked or previewed.",
    "required": ["campaign"],
    "properties": {
        "campaign": {"type": "object", "additionalProperties": True, "description": "A campaign's document."}
    },
}
_HOLDING = (("RunDetail", "campaign"), ("LibraryCampaign", "document"), ("Checked", "document"))
"""Response fields that are a campaign, declared as a plain mapping."""

TAGS = [
    {"name": "service", "description": "Health"},
    {"name": "session", "description": "Who is signed in, and in which browsers"},
    {"name": "users", "description": "Users, roles, invitations, settings"},
    {"name": "tokens", "description": "API tokens"},
    {"name": "audit", "description": "The audit trail"},
    {"name": "catalog", "description": "Components, methods, the library of campaigns"},
    {"name": "drafts", "description": "Drafts of campaigns, as original text"},
    {"name": "runs", "description": "Submitting, listing, watching, cancelling, notes"},
    {"name": "sweeps", "description": "One campaign with several values of a fixed parameter"},
    {"name": "results", "description": "Evaluations, findings, traces"},
    {"name": "exports", "description": "A run as files: JSON, CSV, MAT"},
    {"name": "reports", "description": "The report for a safety case"},
    {"name": "requirements", "description": "Requirements, their matrix with runs, import and export"},
    {"name": "signoffs", "description": "Reviewers' sign-offs of a run's results"},
    {"name": "views", "description": "The 3D views that this visitor has open"},
    {"name": "events", "description": "Live progress"},
    {"name": "webhooks", "description": "Messages to other programs when a run ends"},
]
SECURITY = {
    "session": {"type": "apiKey", "in": "cookie", "name": "clearance_PORT", "description": "Set by signing in."},
    "token": {"type": "http", "scheme": "bearer", "description": "From `clearance token create NAME`."},
}


def install(app: FastAPI) -> None:
    """Serve it at its address. Making it is a second of work: do not ask for it first on the event loop."""
    making = threading.Lock()

    def document() -> JsonObject:
        with making:
            if app.openapi_schema is None:
                app.openapi_schema = _document(app)
        return app.openapi_schema

    def answer() -> Response:  # a plain function, which is run in a thread
        return JSONResponse(app.openapi())

    app.openapi = document  # type: ignore[method-assign]
    app.add_api_route(f"{API}/openapi.json", answer, include_in_schema=False)


def _document(app: FastAPI) -> JsonObject:
    found = get_openapi(
        title=app.title,
        version=app.version,
        summary=app.summary,
        description=app.description,
        routes=app.routes,
        tags=TAGS,
    )
    components = found["components"]
    _, extra = models_json_schema(_MODELS, ref_template=_REF)
    schemas = components["schemas"]
    for name, schema in extra["$defs"].items():
        schemas.setdefault(name, schema)
    schemas["CampaignBody"] = _CAMPAIGN_BODY
    for name, key in _HOLDING:
        nullable = "anyOf" in schemas[name]["properties"][key]
        schemas[name]["properties"][key] = {"anyOf": [_CAMPAIGN, {"type": "null"}]} if nullable else _CAMPAIGN
    for path, operations in found["paths"].items():
        for method, operation in operations.items():
            _declare(operation, method, RULES[method.upper(), path])
    components["schemas"] = dict(sorted(schemas.items()))
    components["securitySchemes"] = SECURITY
    found["security"] = [{name: []} for name in SECURITY]
    for path in HEALTH & found["paths"].keys():
        found["paths"][path]["get"]["security"] = []
    return found


def _declare(operation: JsonObject, method: str, rule: Rule) -> None:
    """Add the problem types that the middleware and the framework can return for any route."""
    kinds = ["bad-request", "unknown-host", "too-long", "invalid-request", "internal", "too-many-requests"]
    kinds += ["busy", "database-away", "database-gone", "damaged"]
    if rule.role is not None:
        kinds.append("not-signed-in")
        kinds += ["role-too-low"] if rule.role != "viewer" else []
        kinds += ["scope-too-narrow"] if rule.scope != "read" else []
        kinds += ["not-yours"] if rule.own and rule.role != "viewer" else []
    if method != "get":
        kinds += ["foreign-origin", "too-large", "no-space"]
    for kind in kinds:
        declare(operation["responses"], kind, str)
    operation["responses"] = dict(sorted(operation["responses"].items()))
