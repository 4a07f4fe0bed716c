"""Imports, changes and exports requirements; the audit trail has every change."""

from __future__ import annotations

import difflib
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from backend.db import audit, numbers
from backend.db.access import Visitor
from backend.db.engine import chunks, now
from backend.db.tables import Requirement, RequirementFile
from backend.http.errors import RefusedError, existing
from backend.http.matches import require_match, tag
from backend.requirements import matrix
from backend.requirements.reqif import Read
from backend.requirements.schemas import FileKind, Imported, RequirementFileOut, RequirementGiven, RequirementRow

MOST = 20_000
"""Requirements that are registered."""
MOST_FILES = 50
NAMED = 20
"""Ids that a row of the audit trail names."""


@dataclass(frozen=True)
class Upload:
    """A file that was read: its name, kind and bytes, its requirements, and how many objects were skipped."""

    name: str
    kind: FileKind
    content: bytes
    found: Sequence[Read]
    skipped: int


def import_file(writer: sa.Connection, upload: Upload, visitor: Visitor) -> Imported:
    """Store a file with its requirements, in place of an earlier one of that name; one transaction.

    409 for ids of another file: two modules that both number from 1 must not become one requirement.
    """
    try:
        return _imported(writer, upload, visitor)
    except sa.exc.IntegrityError:  # another import, at the same time
        raise _conflict("requirements were imported at the same time: try again") from None


def _imported(writer: sa.Connection, upload: Upload, visitor: Visitor) -> Imported:
    name, kind, content, found = upload.name, upload.kind, upload.content, upload.found
    at, digest = now(writer), hashlib.sha256(content).hexdigest()
    stored = {"kind": kind, "digest": digest, "content": content, "imported": at, "imported_by": visitor.user}
    file_id = _stored(writer, name, stored)
    row_locks = sa.select(Requirement.__table__).order_by(Requirement.id).with_for_update()  # an edit waits, or is seen
    before = {row.id: row for row in writer.execute(row_locks)}
    ids = {one.id for one in found}
    _refuse_foreign(writer, file_id, [row for key, row in before.items() if key in ids])
    gone = sorted(key for key, row in before.items() if row.file_id == file_id and key not in ids)
    if len(before.keys() | ids) - len(gone) > MOST:
        raise _conflict(f"there would be more than {MOST:,} requirements: delete some first")
    added, changed = [], []
    for one in found:
        old = before.get(one.id)
        if old is None:
            added.append(_row(one, file_id, at, visitor))
            continue
        values: dict[str, object] = {"attributes": one.attributes, "file_id": file_id}
        if old.text != one.text:
            changed.append(one.id)
            values |= {"text": one.text, "changed": at, "changed_by": visitor.user}
        writer.execute(sa.update(Requirement).where(Requirement.id == one.id).values(**values))
    if added:
        writer.execute(sa.insert(Requirement), added)
    _forget(writer, gone)
    new = [str(row["id"]) for row in added]
    detail = {"sha256": digest, "added": _some(new), "changed": _some(changed), "gone": _some(gone)}
    audit.note(writer, visitor, "requirements.imported", name[:80], detail)
    (file,) = [one for one in files(writer) if one.id == file_id]
    same = len(found) - len(new) - len(changed)
    return Imported(file=file, added=new, changed=changed, unchanged=same, gone=gone, skipped=upload.skipped)


def _refuse_foreign(reader: sa.Connection, file_id: int, there: Sequence[Any]) -> None:
    foreign = sorted((row.id, row.file_id) for row in there if row.file_id not in (None, file_id))
    if foreign:
        other = reader.scalar(sa.select(RequirementFile.name).where(RequirementFile.id == foreign[0][1]))
        raise _conflict(
            f"{len(foreign)} ids are already registered from another file, such as {foreign[0][0]} from {other}: name "
            "an attribute whose values are unique across files, import under that name, or delete that file"
        )


def _stored(writer: sa.Connection, name: str, stored: dict[str, object]) -> int:
    file_id = writer.scalar(sa.select(RequirementFile.id).where(RequirementFile.name == name))
    if file_id is not None:
        writer.execute(sa.update(RequirementFile).where(RequirementFile.id == file_id).values(**stored))
        return int(file_id)
    if (writer.scalar(sa.select(sa.func.count()).select_from(RequirementFile)) or 0) >= MOST_FILES:
        raise _conflict(f"there are already {MOST_FILES} files, which is the limit: delete some first")
    stored = {"name": name, **stored, **numbers.following(writer, RequirementFile)}
    made = sa.insert(RequirementFile).values(**stored).returning(RequirementFile.id)
    return int(writer.execute(made).scalar_one())


def files(reader: sa.Connection) -> list[RequirementFileOut]:
    columns = [getattr(RequirementFile, key) for key in ("id", "name", "kind", "digest", "imported", "imported_by")]
    size = sa.func.length(RequirementFile.content).label("size")
    count = sa.select(sa.func.count()).where(Requirement.file_id == RequirementFile.id).scalar_subquery()
    of = sa.select(*columns, size, count.label("requirements")).order_by(RequirementFile.name)
    return [RequirementFileOut.model_validate(dict(row)) for row in reader.execute(of).mappings()]


def content(reader: sa.Connection, file_id: int) -> tuple[str, FileKind, bytes]:
    """Name, kind and bytes of a file, as it was imported; 404 if there is none."""
    of = sa.select(RequirementFile.name, RequirementFile.kind, RequirementFile.content)
    found = reader.execute(of.where(RequirementFile.id == file_id)).one_or_none()
    row = existing(found, "file of requirements with the number", str(file_id))
    return row.name, row.kind, bytes(row.content)


def delete_file(engine: sa.Engine, file_id: int, visitor: Visitor) -> None:
    """Delete a file and its requirements; those that runs state stay rows of the matrix. 404 if there is none."""
    with engine.begin() as writer:
        name, _, file_bytes = content(writer, file_id)
        of = sa.select(Requirement.id).where(Requirement.file_id == file_id).order_by(Requirement.id)
        gone = list(writer.scalars(of))
        _forget(writer, gone)
        writer.execute(sa.delete(RequirementFile).where(RequirementFile.id == file_id))
        detail = {"sha256": hashlib.sha256(file_bytes).hexdigest(), "gone": _some(gone)}
        audit.note(writer, visitor, "requirements.deleted", name[:80], detail)


def write(engine: sa.Engine, new: RequirementGiven, visitor: Visitor, match: str | None = None) -> RequirementRow:
    """Add a requirement, or change the text of one that was written here or imported as CSV.

    409 for one of a ReqIF file: it is changed where it was written, and imported again. 412 unless it is the one that
    `match` names.
    """
    try:
        with engine.begin() as writer:
            return _written(writer, new, visitor, match)
    except sa.exc.IntegrityError:  # another writer, at the same time
        raise _conflict(f"{new.id} was registered at the same time: read it again, then repeat the change") from None


def _written(writer: sa.Connection, new: RequirementGiven, visitor: Visitor, match: str | None) -> RequirementRow:
    at, old = now(writer), _under_lock(writer, new.id)
    require_match(match, tag(new.id, None if old is None else old.text), new.id, there=old is not None)
    if old is None:
        if (writer.scalar(sa.select(sa.func.count()).select_from(Requirement)) or 0) >= MOST:
            raise _conflict(f"there are already {MOST:,} requirements, which is the limit: delete some first")
        writer.execute(sa.insert(Requirement).values(**_row(Read(new.id, new.text, {}), None, at, visitor)))
        audit.note(writer, visitor, "requirement.added", new.id[:80], {"id": new.id, **stated_text(new.text)})
    elif old.kind == "reqif":
        raise _conflict(f"{new.id} is from {old.file}: change it in the tool that wrote the file, and import it again")
    elif old.text != new.text:
        values = {"text": new.text, "changed": at, "changed_by": visitor.user}
        writer.execute(sa.update(Requirement).where(Requirement.id == new.id).values(**values))
        detail = {"id": new.id, **changed_text(old.text, new.text)}
        audit.note(writer, visitor, "requirement.changed", new.id[:80], detail)
    return matrix.rows(writer, [new.id], 5)[0]


def delete(engine: sa.Engine, key: str, visitor: Visitor, match: str | None = None) -> None:
    """Delete a requirement that was written here or imported as CSV; one that runs state stays a row. 404, 409, 412."""
    with engine.begin() as writer:
        old = existing(_under_lock(writer, key), "registered requirement", key)
        require_match(match, tag(key, old.text), key)
        if old.kind == "reqif":
            raise _conflict(f"{key} is from {old.file}: delete it there and import the file again, or delete the file")
        _forget(writer, [key])
        audit.note(writer, visitor, "requirement.deleted", key[:80], {"id": key, **stated_text(old.text)})


def _under_lock(writer: sa.Connection, key: str) -> Any:
    """A registered requirement, for which other writers wait until this transaction ends; None if there is none."""
    writer.execute(sa.select(Requirement.id).where(Requirement.id == key).with_for_update())
    of = sa.select(Requirement.text, RequirementFile.kind, RequirementFile.name.label("file"))
    of = of.outerjoin(RequirementFile, RequirementFile.id == Requirement.file_id)
    return writer.execute(of.where(Requirement.id == key)).one_or_none()


def _row(one: Read, file_id: int | None, at: float, visitor: Visitor) -> dict[str, object]:
    values: dict[str, object] = {"id": one.id, "text": one.text, "attributes": one.attributes, "file_id": file_id}
    return values | {"created": at, "changed": at, "changed_by": visitor.user}


def _forget(writer: sa.Connection, ids: Sequence[str]) -> None:
    for some in chunks(ids):
        writer.execute(sa.delete(Requirement).where(Requirement.id.in_(some)))


def _some(ids: Sequence[str]) -> dict[str, object]:
    return {"count": len(ids), "ids": list(ids[:NAMED])}


def _conflict(detail: str) -> RefusedError:
    return RefusedError("requirement-conflict", detail)


LONGEST = 500
"""Characters of an excerpt."""
_CUT = " …"


def stated_text(text: str) -> Mapping[str, object]:
    """What a row states about one text."""
    return {"text": {**_measured(text), "begins": _cut(text)}}


def changed_text(before: str, after: str) -> Mapping[str, object]:
    """What a row states about a change."""
    return {"before": _measured(before), "text": _measured(after), "difference": _difference(before, after)}


def _measured(text: str) -> Mapping[str, object]:
    return {"characters": len(text), "sha256": hashlib.sha256(text.encode()).hexdigest()}


def _difference(before: str, after: str) -> str:
    """The differing lines as a unified difference; the lines begin where the texts first differ if they are long."""
    lines = (before.splitlines() or [""], after.splitlines() or [""])
    if max(len(line) for some in lines for line in some) > LONGEST // 2:
        same = next(
            (i for i, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), min(map(len, (before, after)))
        )
        start = max(0, same - 40)
        half = LONGEST // 2 - 4
        return f"- {_cut(before[start:], half)}\n+ {_cut(after[start:], half)}"
    made = list(difflib.unified_diff(*lines, n=0, lineterm=""))[2:]
    return _cut("\n".join(made))


def _cut(text: str, longest: int = LONGEST) -> str:
    return text if len(text) <= longest else text[: longest - len(_CUT)] + _CUT
