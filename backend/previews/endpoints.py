"""POST /campaigns/preview: the nominal flight of a campaign; stores nothing."""

from __future__ import annotations

from fastapi import APIRouter, Request

from backend.catalog.endpoints import CHECK_BODY, campaign_of
from backend.http.deps import Engine, account, capacities
from backend.http.errors import problems
from backend.previews import service
from backend.previews.schemas import Preview
from campaigns import CampaignError

router = APIRouter(tags=["catalog"])


@router.post(
    "/campaigns/preview",
    openapi_extra=CHECK_BODY,
    responses=problems(
        "unsupported-media-type",
        "unreadable",
        "invalid-campaign",
        "not-flyable",
        "no-catalogue",
        "busy",
        "preview-busy",
        "preview-overtaken",
        "preview-failed",
    ),
)
async def preview_campaign(request: Request, engine: Engine) -> Preview:
    """Simulate the nominal case of a campaign, given as `{"campaign": ...}` or as YAML; stores nothing.

    A new combination of components is compiled first, which takes many seconds. 422 for a campaign that cannot be run,
    503 if it cannot be simulated.
    """
    campaign = await campaign_of(request)
    if isinstance(campaign, CampaignError):
        raise campaign
    criterion = await capacities(request).checks.run(account(request), lambda: service.checked(engine, campaign))
    answer, seconds = await request.app.state.previews.simulate(account(request), campaign, request.is_disconnected)
    return service.response(campaign, criterion, answer, seconds)
