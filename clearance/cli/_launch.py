"""What `clearance run` and `clearance submit` take for regression: labels, a baseline, files for a CI job."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

import typer

from campaigns.refusals import RefusalCode
from campaigns.sample_seed import LARGEST
from clearance.cli import JOB_FILES, WrongInputError, on_disk, refusing

if TYPE_CHECKING:
    from clearance.cli._ended import EndedRun

Label: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--label", metavar="KEY=VALUE", show_default=False,
        help="Label of the run, such as branch=main; may be repeated.",
    ),
]  # fmt: skip
Baseline: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="RUN", show_default=False,
        help="Evaluate the findings of this run first and compare: R-0001, or label:branch=main for the newest run "
        "with that label that has findings, of a campaign of the same name and criterion; of `clearance run` also the "
        "folder of an earlier --out.",
    ),
]  # fmt: skip


Saved: TypeAlias = Callable[[str], bool]
"""Whether a command saves a file of this name in the folder of `--out`."""


def never(name: str) -> bool:
    """Of a command that saves no files."""
    return False


def _sample_seed(cleared: str) -> Any:
    """The option of a stated seed; cleared: what is cleared with one."""
    return typer.Option(
        "--sample-seed", metavar="SEED", min=0, max=LARGEST, show_default=False,
        help=f"Repeat the independent sample of an earlier run, which states its seed; {cleared}.",
    )  # fmt: skip


StatedSampleSeed: TypeAlias = Annotated[int | None, _sample_seed("nothing is cleared with a stated seed")]
"""Of `clearance run`, which has no record of what earlier runs drew."""
DrawnSampleSeed: TypeAlias = Annotated[
    int | None,
    _sample_seed(
        "nothing is cleared with a seed that no run of the service with a verdict drew for the same campaign and code"
    ),
]
"""Of `clearance submit`."""


def _begun(option: str, mark: str) -> Callable[[typer.Context, Path | None], Path | None]:
    """What makes the file of a job state that there is no verdict, before the other options are read.

    Whatever ends the command then, no file of an earlier build is taken for its result. A file with other content, such
    as a campaign that was given as FILE by mistake, is refused: one that is replaced is empty or contains `mark`.
    """

    def begun(ctx: typer.Context, file: Path | None) -> Path | None:
        if file is None:
            return None
        _refuse_same({name: ctx.params.get(name) for name in JOB_FILES} | {option: file})
        from campaigns.runs import RunState
        from clearance.cli import _junit, _sarif
        from clearance.cli._ended import EndedRun

        module = {"junit": _junit, "sarif": _sarif}[option]
        with on_disk(f"{file} cannot be written"):
            file.parent.mkdir(parents=True, exist_ok=True)
            if file.exists() and not file.is_file():  # such as /dev/stdout
                return file
            if file.exists() and file.stat().st_size and mark not in file.read_text("utf-8", "replace"):
                raise WrongInputError(
                    f"--{option} {file}: the file was not written by a job; give another name, or delete it"
                )
            module.write(file, EndedRun("", "clearance", RunState.RUNNING, None, UNENDED))
        return file

    return begun


Junit: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--junit", metavar="FILE", help="Write the result as JUnit XML.", dir_okay=False, is_eager=True,
        callback=_begun("junit", "<testsuite"),
    ),
]  # fmt: skip
Summary: TypeAlias = Annotated[
    Path | None, typer.Option("--summary", metavar="FILE", help="Write a summary as Markdown.", dir_okay=False)
]


Sarif: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--sarif", metavar="FILE", help="Write violations and failed checks as SARIF 2.1.0.", dir_okay=False,
        is_eager=True, callback=_begun("sarif", "sarif"),
    ),
]  # fmt: skip
UNENDED = "the command that writes this file has not ended; if it has, its output states why there is no verdict"
"""What a file of a job states until there is a verdict."""


class Launch(NamedTuple):
    """The labels, the baseline, and the files to be written at the end."""

    labels: dict[str, str]
    baseline: str
    junit: Path | None
    summary: Path | None
    sarif: Path | None = None

    @property
    def wanted(self) -> bool:
        """Whether there is a file to write."""
        return (self.junit or self.summary or self.sarif) is not None

    def write(self, ended: EndedRun) -> None:
        """Write the requested files; `WrongInputError` once all were tried, if one cannot be written."""
        from clearance.cli import _junit, _markdown, _sarif

        lost = []
        for file, module in ((self.junit, _junit), (self.summary, _markdown), (self.sarif, _sarif)):
            try:
                if file is not None:
                    module.write(file, ended)
            except OSError as error:
                lost.append(f"{file} cannot be written: {error.strerror}")
        if lost:
            raise WrongInputError("; ".join(lost))

    @staticmethod
    def read(
        label: list[str] | None,
        baseline: str | None,
        junit: Path | None,
        summary: Path | None,
        sarif: Path | None = None,
        out: Path | None = None,
        saved: Saved = never,
    ) -> Launch:
        """The options as given; raises `WrongInputError` for a bad label or a file that cannot be written.

        saved: whether a file of this name may be saved in `out`.
        """
        from campaigns.labels import parsed

        with refusing(ValueError):
            labels = parsed(label or ())
        if baseline is not None and not baseline.strip():  # an unset variable of a CI job would compare with nothing
            raise WrongInputError("--baseline is empty: give a run (R-0001) or label:KEY=VALUE, or leave it out")
        _refuse_same({"junit": junit, "sarif": sarif, "summary": summary}, out, saved)
        _writable(summary)
        return Launch(labels, (baseline or "").strip(), junit, summary, sarif)


def _refuse_same(files: Mapping[str, Path | None], out: Path | None = None, saved: Saved = never) -> None:
    """Raises `WrongInputError` for files of a job that would replace one another, or a file that is saved in `out`.
    files: by their options; devices such as /dev/stdout may be shared."""
    named: dict[Path, str] = {}
    for option, file in files.items():
        if file is None or (file.exists() and not file.is_file()):
            continue
        path = file.resolve()
        if path in named:
            why = f"--{named[path]} and --{option} are one file, {file}: give two names"
            raise WrongInputError(why, RefusalCode.OPTIONS)
        if out is not None and path.parent == out.resolve() and saved(path.name):
            why = f"--{option} {file}: --out {out} saves a file of this name: give another one"
            raise WrongInputError(why, RefusalCode.OPTIONS)
        named[path] = option


def _writable(file: Path | None) -> None:
    """Make the file's folder; raises `WrongInputError` if the file cannot be written. What it contains stays."""
    if file is None:
        return
    there = file.exists()
    with on_disk(f"{file} cannot be written"):
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("ab"):
            pass
        if not there:
            file.unlink()
