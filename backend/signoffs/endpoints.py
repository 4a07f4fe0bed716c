"""GET and POST /runs/{run}/signoffs, and withdrawal."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, status

from backend.access.auth import CurrentVisitor
from backend.access.once import ONCE, OnceOnly
from backend.http.deps import Engine, Reader
from backend.http.errors import problems
from backend.http.schema import RunName
from backend.runs.service import number
from backend.signoffs import service
from backend.signoffs.schemas import Signoff, SignoffRequest, Signoffs, WithdrawalRequest

router = APIRouter(tags=["signoffs"])

Number = Annotated[int, Path(ge=1, le=2**31 - 1, description="The number of the sign-off.")]


@router.get("/runs/{run}/signoffs", responses=problems("not-found", "purged"))
def list_signoffs(run: RunName, reader: Reader, visitor: CurrentVisitor) -> Signoffs:
    """The sign-offs of a run, the digest that a new one must give, and why the caller may not add one."""
    return service.listed(reader, number(run), visitor)


@router.post(
    "/runs/{run}/signoffs",
    status_code=status.HTTP_201_CREATED,
    responses=problems(
        *("not-found", "no-verdict", "results-changed", "text-changed", "already-signed", "own-run"),
        *("removed", "purged", *ONCE),
    ),
)
def sign_off(run: RunName, review: SignoffRequest, once: OnceOnly, visitor: CurrentVisitor) -> Signoff:
    """Sign off the results of a run; the digest identifies the reviewed results and must match the current ones.

    So must the texts of requirements, if they are given.
    """
    run_id = number(run)
    return once.do(
        Signoff,
        lambda writer: service.sign(writer, run_id, review, visitor),
        lambda signed: f"the sign-off {signed.id} of {run}",
        # It may be withdrawn by now, or the results may have changed.
        lambda reader, signed: service.one(reader, run_id, signed.id),
    )


@router.post("/runs/{run}/signoffs/{signoff}/withdraw", responses=problems("not-found", "withdrawn", "purged"))
def withdraw_signoff(
    run: RunName, signoff: Number, withdrawal: WithdrawalRequest, engine: Engine, visitor: CurrentVisitor
) -> Signoff:
    """Withdraw a sign-off with a reason; it stays on record."""
    return service.withdraw(engine, number(run), signoff, withdrawal.reason, visitor)
