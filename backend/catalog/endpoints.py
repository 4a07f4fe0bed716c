"""GET /components and the campaign library; POST /campaigns/check."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request

from backend.catalog import service
from backend.catalog.schemas import Checked, LibraryCampaign
from backend.db.engine import ask
from backend.http import bodies
from backend.http.deps import Engine, Reader, account, capacities
from backend.http.errors import problems
from campaigns import Campaign, CampaignError, Catalogue
from campaigns.asked.load import load_document

router = APIRouter(tags=["catalog"])
LibraryName = Annotated[str, Path(description="The identifier of a shipped campaign, such as `unicycle_static`.")]

CHECK_BODY = bodies.of("CampaignBody")


@router.get("/components", responses=problems("no-catalogue"))
def list_components(reader: Reader) -> Catalogue:
    """Components and methods with their parameters, units, limits and texts."""
    return service.required(reader).model_copy(update={"code": None})


@router.get("/campaigns")
def list_campaigns(reader: Reader) -> list[LibraryCampaign]:
    """The campaigns shipped with this installation."""
    return service.library_campaigns(reader)


@router.get("/campaigns/schema")
def campaign_schema() -> dict[str, object]:
    """The JSON Schema of a campaign."""
    return Campaign.model_json_schema()


@router.get("/campaigns/{name}", responses=problems("not-found"))
def get_campaign(name: LibraryName, reader: Reader) -> LibraryCampaign:
    """One of the shipped campaigns."""
    return service.library_campaign(reader, name)


@router.post(
    "/campaigns/check",
    openapi_extra=CHECK_BODY,
    responses=problems("unsupported-media-type", "unreadable", "no-catalogue", "busy"),
)
async def check_campaign(request: Request, engine: Engine) -> Checked:
    """Check a campaign, given as `{"campaign": ...}` or as YAML: its parsed form, or its errors. Stores nothing."""
    campaign = await campaign_of(request)
    return await capacities(request).checks.run(
        account(request), lambda: ask(engine, lambda reader: service.checked(reader, campaign))
    )


async def campaign_of(request: Request) -> Campaign | CampaignError:
    """The campaign of a request's body, or all its errors."""
    yaml, body = bodies.is_yaml(request), await request.body()
    return await capacities(request).bodies.run(account(request), lambda: _campaign(body, yaml))


def _campaign(body: bytes, yaml: bool) -> Campaign | CampaignError:
    try:
        if yaml:
            return bodies.yaml_campaign(body)
        document = bodies.document(body)
        return load_document(document.get("campaign") if isinstance(document, dict) else document, "request")
    except CampaignError as error:
        return error
