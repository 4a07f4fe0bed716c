"""What the client does: coroutines over a session, which sends, pauses and listens.

The blocking and the asynchronous client run the same scripts (`clearance.client.drivers`), so that retries, waiting and
paging exist once. Start reading at `ask` and `follow`.
"""

from __future__ import annotations

import functools
import inspect
import json
import math
import secrets
from collections.abc import AsyncGenerator, Callable, Coroutine, Iterable
from contextlib import aclosing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar

from clearance.client import answers, calls
from clearance.client.calls import Call, Named, NamedSweep
from clearance.client.errors import NotAClearanceServiceError, ReplacedError, RunFailedError, UnreachableError, refused
from clearance.client.replies import Reply
from clearance.client.session import Session

if TYPE_CHECKING:
    from clearance.client.arrays import Evaluations, Findings, Trace

T = TypeVar("T")
P = ParamSpec("P")
Script = Coroutine[Any, Any, T]
PAUSE = 1.0
"""Between two readings of a run while there is no stream of its events [s]."""
FIRST_PAUSE, LONGEST_PAUSE = 0.5, 10.0
"""Before the first and the later repetitions of a request; doubled each time, with jitter [s]."""
REPEATED_500 = 2
"""An internal error is asked again so many times; it may be one of a moment, such as a lost database."""
MOST_POINTS = 100_000
"""Rows of a trace."""


async def ask(session: Session, call: Call[T]) -> T:
    """The answer to a request, repeated while the service does not respond, at most for `patience`.

    Every request of `calls` may be repeated: it changes nothing, or has a key, or is the same when done twice. Raises
    `ReplacedError` if its run or sweep was given by an answer, and the number is that of another one now.
    """
    reply = await _answered(session, call)
    try:
        answer = call.read(reply.content)
    except ValueError as error:
        raise NotAClearanceServiceError(
            f"{session.address} is not a Clearance service: unexpected response ({type(error).__name__})"
        ) from None
    await _refuse_replaced(session, call.known, answer)
    return answer


async def _refuse_replaced(session: Session, known: answers.Run | answers.Sweep | None, answer: object = None) -> None:
    """Raise `ReplacedError` if the number of what an earlier answer describes is that of another run or sweep now.

    answer: a later answer; if it does not state what it is of, such as a file, the run or sweep is read.
    """
    if known is None:
        return
    later: answers.Run | answers.Sweep
    if isinstance(answer, answers.Run | answers.Sweep) and answer.id == known.id:
        later = answer
    elif isinstance(known, answers.Run):
        later = await ask(session, calls.run(known.id))
    else:
        later = await ask(session, calls.read_sweep(known.id))
    if _identity(later) != _identity(known):
        kind = "run" if isinstance(known, answers.Run) else "sweep"
        raise ReplacedError(
            f"{session.address}: {known.id} is another {kind} now: {_described(later)}, not {_described(known)}. The "
            f"database of the service was probably restored or replaced. Nothing is known of the {kind} that had this "
            "number before; submit it again"
        )


def _identity(of: answers.Run | answers.Sweep) -> tuple[object, ...]:
    """What never changes of a run or sweep, and distinguishes it from another one with its number."""
    return of.created, of.campaign_digest if isinstance(of, answers.Run) else of.path


def _described(of: answers.Run | answers.Sweep) -> str:
    what = f"sha256 {of.campaign_digest[:16]}" if isinstance(of, answers.Run) else f"over {of.path}"
    return f"that of the campaign {of.campaign_name!r} ({what}) created at {of.created.isoformat()}"


async def _answered(session: Session, call: Call[Any], file: Path | None = None) -> Reply:
    with session.noticed():
        reply = await _repeated(session, call, file)
    if reply.status >= 300:
        raise refused(reply.status, reply.phrase, reply.problem, session.address)
    return reply


async def _repeated(session: Session, call: Call[Any], file: Path | None) -> Reply:
    """The last answer, after as many as are not final."""
    until, tries, broken = session.clock() + session.patience, 0, 0
    while True:
        if call.method != "GET" and call.known is not None:  # before every try: the database may change in between
            await _refuse_replaced(replace(session, notify=lambda _: None), call.known)
        left = until - session.clock() if session.patience else math.inf
        reply = await session.send(call, file, left)
        broken += reply.status == 500
        if not reply.again and not (reply.status == 500 and broken <= REPEATED_500):
            return reply
        usual = min(LONGEST_PAUSE, FIRST_PAUSE * 2**tries) * (0.5 + 0.5 * session.jitter())
        pause = max(usual, reply.retry_after or 0.0)
        if session.clock() + pause > until:
            if reply.status == 500:
                return reply
            what = "was not ready" if reply.status else "did not respond"
            raise UnreachableError(f"{session.address} {what} for {session.patience:g} s: {reply.message}")
        await session.pause(pause)
        tries += 1


def asking(call: Callable[P, Call[T]]) -> Callable[Concatenate[Session, P], Script[T]]:
    """The script that makes one request, with the arguments and the description of its call."""

    async def script(session: Session, /, *positional: P.args, **named: P.kwargs) -> T:
        return await ask(session, call(*positional, **named))

    functools.update_wrapper(script, call)
    return script


async def follow(session: Session, run: Named) -> AsyncGenerator[answers.Run]:
    """The state of a run now, after every change, and at its end.

    Changes are events of the service; while there is no stream of them, the run is read every second. A service that
    restarts is waited for; `ReplacedError` if the number is that of another run then.
    """
    while not (found := await ask(session, calls.run(run))).ended:
        yield found
        run, ended = found, False
        async with aclosing(_changes(session, found)) as changes:
            async for changed in changes:
                if ended := changed.ended:
                    break
                yield changed
        if not ended:
            await session.pause(PAUSE)
    yield found


async def _changes(session: Session, run: answers.Run) -> AsyncGenerator[answers.Run]:
    """What a stream of events reports until it ends, or until the run is to be read again."""
    name = ""
    async with aclosing(session.lines(calls.events(run))) as lines:
        async for line in lines:
            if line.startswith(":"):  # a heartbeat: an event may be missing
                return
            if line.startswith("event:"):
                name = line.removeprefix("event:").strip()
            elif line.startswith("data:") and name == "run":
                try:
                    changed = answers.Run.model_validate(json.loads(line.removeprefix("data:")))
                except ValueError:
                    return
                await _refuse_replaced(session, run, changed)
                yield changed


async def wait(
    session: Session,
    run: Named,
    *,
    on_change: Callable[[answers.Run], object] | None = None,
    timeout: float | None = None,
) -> answers.RunDetail:
    """The run once it has ended, in whatever state; on_change: called with it now and after every change.

    timeout [s]: raise `TimeoutError` if it has not ended by then; the run continues.
    """
    if timeout is not None:
        late = f"{calls.name_of(run)} has not ended within {timeout:g} s; it continues"
        session = replace(session, until=session.clock() + timeout, late=late)
    async with aclosing(follow(session, run)) as states:
        async for found in states:
            session.check_time()
            if on_change is not None:
                on_change(found)
    assert isinstance(found, answers.RunDetail)
    return found


def _searching(
    submit: Callable[P, Call[answers.Submitted]],
) -> Callable[Concatenate[Session, P], Script[answers.RunDetail]]:
    async def search(session: Session, /, *positional: P.args, **named: P.kwargs) -> answers.RunDetail:
        """Submit a campaign and wait for its verdict: `submit` and `wait` in one, with the arguments of `submit`.

        Raises `RunFailedError` if it ends without a verdict.
        """
        queued = await ask(session, submit(*positional, **named))
        done = await wait(session, queued)
        if done.verdict is None:
            raise RunFailedError(done.id, done.state, done.error or "no reason is recorded")
        return done

    functools.update_wrapper(search, submit, assigned=())
    stated = inspect.signature(submit).replace(return_annotation="answers.RunDetail")
    setattr(search, "__signature__", stated)  # noqa: B010  a function has no such attribute by its type
    return search


search = _searching(calls.submit)


async def runs(
    session: Session,
    q: str = "",
    *,
    state: Iterable[str] = (),
    verdict: Iterable[str] = (),
    tag: Iterable[str] = (),
    campaign: Iterable[str] = (),
    owner: Iterable[str] = (),
    label: Iterable[str] = (),
    sort: str = "",
) -> AsyncGenerator[answers.Run]:
    """Every run of the list that fulfils the filters, page after page; alternatives of one filter are listed.

    q: words in the name, campaign, tags, owner or number. label: KEY=VALUE. sort: as in the list, such as -created.
    """
    chosen = {"state": state, "verdict": verdict, "tag": tag, "campaign": campaign, "owner": owner, "label": label}
    cursor: str | None = None
    while True:
        page = await ask(session, calls.run_page(q=q, sort=sort, cursor=cursor, limit=200, **chosen))
        for item in page.items:
            yield item
        cursor = page.next_cursor
        if cursor is None:
            return


async def follow_sweep(session: Session, sweep: NamedSweep) -> AsyncGenerator[answers.Sweep]:
    """A sweep now, after every second, and at its end."""
    while not (found := await ask(session, calls.read_sweep(sweep))).ended:
        yield found
        sweep = found
        await session.pause(PAUSE)
    yield found


async def wait_sweep(session: Session, sweep: NamedSweep) -> answers.Sweep:
    """A sweep once every run of it has ended."""
    while not (found := await ask(session, calls.read_sweep(sweep))).ended:
        sweep = found
        await session.pause(PAUSE)
    return found


async def export_sweep(session: Session, sweep: NamedSweep, file: str | Path) -> Path:
    """Write a sweep as CSV, one row for each run; returns the file's path."""
    return await download(session, calls.sweep_table(sweep), Path(file))


async def findings(session: Session, run: Named) -> Findings:
    """The distinct worst cases, the lowest first; `to_dataframe()` makes a table of them."""
    from clearance.client.arrays import Findings

    found = await ask(session, calls.findings(run))
    return Findings(found)


async def evaluations(session: Session, run: Named) -> Evaluations:
    """Every evaluation at full precision as arrays, in the order of the stages; `to_dataframe()` makes a table."""
    from clearance.client.arrays import Evaluations

    detail = await ask(session, calls.run(run))
    content = await ask(session, calls.file(detail, "evaluations.csv"))
    return Evaluations.of(content, detail)


async def trace(session: Session, run: Named, name: str = "F1") -> Trace:
    """A trace as arrays by the names of its quantities: nominal, F1, F2, ..."""
    from clearance.client.arrays import Trace

    return Trace.of(await ask(session, calls.trace_data(run, name, MOST_POINTS)))


async def download(session: Session, call: Call[bytes], file: Path) -> Path:
    """Write an answer to a file; an incomplete download leaves no file. Raises OSError if it cannot be written."""
    if call.known is None:
        await _answered(session, call, file)
        return file
    fresh = file.with_name(f".{file.name}.{secrets.token_hex(4)}.new")
    try:
        await _answered(session, call, fresh)
        await _refuse_replaced(session, call.known)
        fresh.replace(file)
    finally:
        fresh.unlink(missing_ok=True)
    return file


async def export(session: Session, run: Named, folder: str | Path, files: Iterable[str] = calls.USUAL) -> list[Path]:
    """Write files of a run into a folder, which is made with the first of them; returns their paths.

    files: campaign.yaml, report.html, report.pdf, and those that `exports` lists: the `file` of each.
    """
    requests = [(name, calls.file(run, name)) for name in files]
    return [await download(session, call, Path(folder) / name) for name, call in requests]


async def picture(session: Session, run: Named, file: str | Path) -> Path:
    """Write the worst case from above as SVG; returns the file's path. `NotFoundError` if no flight is stored."""
    return await download(session, calls.file(run, "worst-case.svg"), Path(file))


async def campaign_text(session: Session, run: Named) -> str:
    """The campaign of a run as it was submitted, with its comments."""
    return (await ask(session, calls.file(run, calls.CAMPAIGN))).decode("utf-8", "replace")


async def report(session: Session, run: Named, file: str | Path) -> Path:
    """Write the safety-case report, as PDF if the file's name ends with .pdf, else as HTML; returns its path."""
    path = Path(file)
    return await download(session, calls.file(run, calls.PDF if path.suffix == ".pdf" else calls.HTML), path)
