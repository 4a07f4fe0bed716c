"""The folder for a command's results: whether it can be written, and the results of an earlier run in it."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError, on_disk
from clearance.cli._exports import others_files, same_file
from clearance.local import RESULT

if TYPE_CHECKING:
    from campaigns import Campaign


def writable(out: Path | None) -> None:
    """Make the folder; raises `WrongInputError` if it is not writable."""
    if out is None:
        return
    with on_disk(f"the folder {out} cannot be written"):
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()


def refuse_other_results(out: Path | None, campaign: Campaign, source: Path | None = None) -> None:
    """Raises `WrongInputError` if the folder has results of another campaign, or files that no run wrote and that this
    one would replace. source: the campaign file.

    The baseline is no part of the campaign here: it is that of one launch.
    """
    from campaigns.versions import short

    if out is None:
        return
    if not os.path.lexists(out / RESULT):
        _refuse_others_files(out, campaign, source)
        return
    stated = _digest(out / RESULT)
    if not stated:
        raise WrongInputError(
            f"--out {out}: {RESULT} in it was not written by `clearance run`, and would be replaced; give another "
            "folder, or delete the file",
            RefusalCode.EXISTS,
        )
    if stated != campaign.digest and not _differs_in_baseline(out / "campaign.json", stated, campaign):
        raise WrongInputError(
            f"--out {out}: the folder has the results of another campaign (digest {short(stated)}; that of this one is "
            f"{short(campaign.digest)}), which would be replaced; give another folder, or delete it",
            RefusalCode.OTHER_CAMPAIGN,
        )


def _refuse_others_files(out: Path, campaign: Campaign, source: Path | None) -> None:
    """In a folder without results. What `clearance export` saved there may be replaced."""
    from clearance.cli._code import program_of
    from clearance.local.results import OF_EVERY_RUN, of_others
    from worker.engine.systems.simulators.declared.folder import FILE

    with on_disk(f"the folder {out} cannot be read"):
        names = of_others(out, campaign)
        own = set(others_files(out, names)) | {name for name in names if name not in OF_EVERY_RUN}
        own |= {name for name in names if same_file(out / name, source)}
        if program_of(campaign) is not None and os.path.lexists(out / FILE):
            own.add(FILE)
    if own:
        raise WrongInputError(
            f"--out {out}: {', '.join(sorted(own))} in it would be replaced, and no {RESULT} shows that an earlier run "
            "wrote that; give another folder, or delete what may be replaced",
            RefusalCode.EXISTS,
        )


def remove_earlier_results(out: Path | None, source: Path | None) -> None:
    """Remove the results of an earlier run: a run that fails leaves no verdict in the folder. source: the campaign
    file, which stays."""
    from clearance.local.results import remove_results

    if out is None:
        return
    with on_disk(f"the earlier results in {out} cannot be removed"):
        remove_results(out, source)


def same_folder(out: Path | None, run: str) -> bool:
    """Whether a run that is read, extended or compared with, is the folder itself."""
    from clearance.cli._where import stored_run

    return out is not None and stored_run(run) is None and Path(run).is_dir() and out.is_dir() and out.samefile(run)


def _digest(result: Path) -> str:
    """The digest of the campaign that a result.json states; empty if it is not that of a run."""
    from campaigns.unreadable import UNREADABLE

    try:
        document = json.loads(result.read_text(encoding="utf-8"))
        stated = document["digest"] if "verdict" in document else ""
    except UNREADABLE:
        return ""
    return stated if isinstance(stated, str) and re.fullmatch("[0-9a-f]{64}", stated) else ""


def _differs_in_baseline(file: Path, stated: str, campaign: Campaign) -> bool:
    """Whether the campaign of this digest, stored in a file, is the same but for its baseline, or for the form in which
    an earlier version wrote it."""
    from campaigns import load_file
    from campaigns.documents import digest_of
    from campaigns.unreadable import UNREADABLE

    try:
        earlier, text = load_file(file), file.read_text(encoding="utf-8")
        stored = stated in (earlier.digest, digest_of(json.loads(text)))
    except UNREADABLE:  # a campaign that cannot be used is a ValueError
        return False
    return stored and _without_baseline(earlier) == _without_baseline(campaign)


def _without_baseline(campaign: Campaign) -> str:
    return campaign.model_copy(update={"baseline": None}).digest
