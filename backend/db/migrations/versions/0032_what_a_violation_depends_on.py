"""the question that a campaign asks, without distributions, correlations, and repeated calls or realisations"""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0032"
down_revision = "0031"

_ASKED = ("scenario", "simulator", "uncertain", "criterion")
_UNASKED = {
    "scenario": ("realisations",),
    "simulator": ("repeats", "retries"),
    "criterion": ("requirements", "threshold", "from_centre"),
}
_CAMPAIGNS = sa.table(
    "campaigns", sa.column("digest", sa.String), sa.column("document", sa.JSON), sa.column("question", sa.String)
)


def upgrade() -> None:
    connection = op.get_bind()
    for digest in connection.scalars(sa.select(_CAMPAIGNS.c.digest)).all():
        mine = _CAMPAIGNS.c.digest == digest
        asked = _question(connection.scalar(sa.select(_CAMPAIGNS.c.document).where(mine)) or {})
        connection.execute(sa.update(_CAMPAIGNS).where(mine).values(question=asked))


def _question(document: Mapping[str, Any]) -> str:
    content = {key: _without(document[key], _UNASKED.get(key, ())) for key in _ASKED if document.get(key)}
    uncertain = content.get("uncertain", {})
    content["uncertain"] = {path: _without(one, ("distribution",)) for path, one in uncertain.items()}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _without(part: Mapping[str, Any], names: tuple[str, ...]) -> Mapping[str, Any]:
    return {name: value for name, value in part.items() if name not in names}
