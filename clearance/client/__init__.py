"""A client for a Clearance service: `Client`, `AsyncClient`, their errors. The guide is docs/client.md.

It imports nothing of the physics, so that a script that only talks to a service starts quickly.
"""

from campaigns.asked.problem import CampaignError
from clearance.client.client import AsyncClient, Client
from clearance.client.errors import (
    ClearanceError,
    ConflictError,
    ForbiddenError,
    InvalidAddressError,
    InvalidCampaignError,
    InvalidRequestError,
    NotAClearanceServiceError,
    NotFoundError,
    NotSignedInError,
    PurgedError,
    RefusedError,
    ReplacedError,
    RunFailedError,
    UnreachableError,
)

__all__ = [
    "AsyncClient",
    "CampaignError",
    "ClearanceError",
    "Client",
    "ConflictError",
    "ForbiddenError",
    "InvalidAddressError",
    "InvalidCampaignError",
    "InvalidRequestError",
    "NotAClearanceServiceError",
    "NotFoundError",
    "NotSignedInError",
    "PurgedError",
    "RefusedError",
    "ReplacedError",
    "RunFailedError",
    "UnreachableError",
]
