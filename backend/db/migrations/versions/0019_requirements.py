"""requirements, the files that they were imported from, and the runs whose campaigns state them

Campaigns of earlier versions state no requirement, so runs that exist now have none.
"""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"


def upgrade() -> None:
    op.create_table(
        "requirement_files",
        sa.Column("id", sa.Integer(), autoincrement=True, primary_key=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("kind", sa.String(8), nullable=False),
        sa.Column("digest", sa.String(64), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.Column("imported", sa.Double(), nullable=False),
        sa.Column("imported_by", sa.String(64), nullable=False),
        sa.UniqueConstraint("name"),
    )
    op.create_table(
        "requirements",
        sa.Column("id", sa.String(120), primary_key=True),
        sa.Column("text", sa.Text(), nullable=False),
        sa.Column("attributes", sa.JSON(), nullable=False),
        sa.Column("file_id", sa.Integer(), sa.ForeignKey("requirement_files.id"), nullable=True),
        sa.Column("created", sa.Double(), nullable=False),
        sa.Column("changed", sa.Double(), nullable=False),
        sa.Column("changed_by", sa.String(64), nullable=False),
    )
    op.create_index("ix_requirements_file_id", "requirements", ["file_id"])
    op.create_table(
        "run_requirements",
        sa.Column("requirement", sa.String(120), primary_key=True),
        sa.Column("run_id", sa.Integer(), sa.ForeignKey("runs.id"), primary_key=True),
        sa.Column("text", sa.Text(), nullable=False),
        sa.Column("question", sa.String(64), nullable=False),
    )
    op.create_index("ix_run_requirements_run_id", "run_requirements", ["run_id"])
