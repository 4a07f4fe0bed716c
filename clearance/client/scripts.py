"""What the client does, without doing it: functions that yield effects (send, pause, listen) and receive their results.

The blocking and the asynchronous client run the same scripts, so that retries, waiting and paging exist once. Start
reading at `ask` and `follow`; the effects are performed in `clearance.client.drivers`.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar

from clearance.client import answers, calls
from clearance.client.calls import Call, Given, Named
from clearance.client.effects import Emit, Line, Listen, Pause, Reply, Save, Script, Send, Session
from clearance.client.errors import NotAClearanceServiceError, RunFailedError, UnreachableError, refused

if TYPE_CHECKING:
    from clearance.client.arrays import Evaluations, Findings, Trace

T = TypeVar("T")
P = ParamSpec("P")
PAUSE = 1.0
"""Between two readings of a run while there is no stream of its events [s]."""
FIRST_PAUSE, LONGEST_PAUSE = 0.5, 10.0
"""Before the first and the later repetitions of a request; doubled each time, with jitter [s]."""
SILENCE = 40.0
"""A stream of events that is silent for longer has ended; the service sends a heartbeat every 15 s [s]."""
REPEATED_500 = 2
"""An internal error is asked again so many times; it may be one of a moment, such as a lost database."""
MOST_POINTS = 100_000
"""Rows of a trace."""


def ask(session: Session, call: Call[T]) -> Script[T]:
    """The answer to a request, repeated while the service does not respond, at most for `patience`.

    Every request of `calls` may be repeated: it changes nothing, or has a key, or is the same when done twice.
    """
    reply = yield from _answered(session, Send(call))
    try:
        return call.read(reply.content)
    except ValueError as error:
        raise NotAClearanceServiceError(
            f"{session.address} is not a Clearance service: unexpected response ({type(error).__name__})"
        ) from None


def _answered(session: Session, effect: Send | Save) -> Script[Reply]:
    with session.noticed():
        reply = yield from _repeated(session, effect)
    if reply.status >= 300:
        raise refused(reply.status, reply.phrase, reply.problem, session.address)
    return reply


def _repeated(session: Session, effect: Send | Save) -> Script[Reply]:
    """The last answer, after as many as are not final."""
    until, tries, broken = session.clock() + session.patience, 0, 0
    while True:
        reply: Reply = yield effect
        broken += reply.status == 500
        if not reply.again and not (reply.status == 500 and broken <= REPEATED_500):
            return reply
        usual = min(LONGEST_PAUSE, FIRST_PAUSE * 2**tries) * (0.5 + 0.5 * session.jitter())
        pause = max(usual, reply.retry_after or 0.0)
        if session.clock() + pause > until:
            if reply.status == 500:
                return reply
            raise UnreachableError(f"{session.address} did not respond for {session.patience:g} s: {reply.message}")
        yield Pause(pause)
        tries += 1


def asking(call: Callable[P, Call[T]]) -> Callable[Concatenate[Session, P], Script[T]]:
    """The script that makes one request, with the arguments and the description of its call."""

    def script(session: Session, /, *positional: P.args, **named: P.kwargs) -> Script[T]:
        return (yield from ask(session, call(*positional, **named)))

    functools.update_wrapper(script, call)
    return script


def follow(session: Session, run: Named) -> Script[answers.RunDetail]:
    """The state of a run now, after every change, and at its end.

    Changes are events of the service; while there is no stream of them, the run is read every second. A service that
    restarts is waited for.
    """
    while not (found := (yield from ask(session, calls.run(run)))).ended:
        yield Emit(found)
        if not (yield from _listened(calls.events(run))):
            yield Pause(PAUSE)
    yield Emit(found)
    return found


def _listened(call: Call[Any]) -> Script[bool]:
    """Emit the changes that a stream reports until it ends; whether the run has ended, or is to be read at once."""
    if not (yield Listen(call)):
        return False
    name = ""
    while (line := (yield Line())) is not None:
        if line.startswith(":"):  # a heartbeat: the run is read again, should an event be missing
            return False
        if line.startswith("event:"):
            name = line.removeprefix("event:").strip()
        elif line.startswith("data:") and name == "run":
            try:
                changed = answers.Run.model_validate(json.loads(line.removeprefix("data:")))
            except ValueError:
                return False
            if changed.ended:
                return True
            yield Emit(changed)
    return False


def wait(
    session: Session,
    run: Named,
    *,
    on_change: Callable[[answers.Run], object] | None = None,
    timeout: float | None = None,
) -> Script[answers.RunDetail]:
    """The run once it has ended, in whatever state; on_change: called with it now and after every change.

    timeout [s]: raise `TimeoutError` if it has not ended by then; the run continues.
    """
    until = None if timeout is None else session.clock() + timeout
    script = follow(session, run)
    reply: Any = None
    while True:
        try:
            effect = script.send(reply)
        except StopIteration as ended:
            done: answers.RunDetail = ended.value
            return done
        reply = None
        if until is not None and session.clock() > until:
            raise TimeoutError(f"{calls.name_of(run)} has not ended within {timeout:g} s; it continues")
        if not isinstance(effect, Emit):
            reply = yield effect
        elif on_change is not None:
            on_change(effect.value)


def search(
    session: Session,
    campaign: Given,
    *,
    name: str | None = None,
    tags: Iterable[str] | None = None,
    labels: Mapping[str, str] | None = None,
    baseline: str | None = None,
    priority: int = 0,
    group: str | None = None,
    reuse: bool = False,
    sample_seed: int | None = None,
    key: str | None = None,
) -> Script[answers.RunDetail]:
    """Submit a campaign and wait for its verdict: `submit` and `wait` in one, with the arguments of `submit`.

    Raises `RunFailedError` if it ends without a verdict.
    """
    call = calls.submit(
        campaign, name=name, tags=tags, labels=labels, baseline=baseline, priority=priority, group=group, reuse=reuse,
        sample_seed=sample_seed, key=key,
    )  # fmt: skip
    done = yield from wait(session, (yield from ask(session, call)))
    if done.verdict is None:
        raise RunFailedError(done.id, done.state, done.error or "no reason is recorded")
    return done


def runs(
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
) -> Script[None]:
    """Every run of the list that fulfils the filters, page after page; alternatives of one filter are listed.

    q: words in the name, campaign, tags, owner or number. label: KEY=VALUE. sort: as in the list, such as -created.
    """
    request = functools.partial(
        calls.run_page,
        q=q,
        state=state,
        verdict=verdict,
        tag=tag,
        campaign=campaign,
        owner=owner,
        label=label,
        sort=sort,
    )
    cursor: str | None = None
    while True:
        page = yield from ask(session, request(cursor=cursor, limit=200))
        for item in page.items:
            yield Emit(item)
        cursor = page.next_cursor
        if cursor is None:
            return


def wait_sweep(session: Session, sweep: str) -> Script[answers.Sweep]:
    """A sweep once every run of it has ended."""
    while not (found := (yield from ask(session, calls.read_sweep(sweep)))).ended:
        yield Emit(found)
        yield Pause(PAUSE)
    yield Emit(found)
    return found


def export_sweep(session: Session, sweep: str, file: str | Path) -> Script[Path]:
    """Write a sweep as CSV, one row for each run; returns the file's path."""
    return (yield from download(session, calls.sweep_table(sweep), Path(file)))


def findings(session: Session, run: Named) -> Script[Findings]:
    """The distinct worst cases, the worst first; `to_dataframe()` makes a table of them."""
    from clearance.client.arrays import Findings

    return Findings((yield from ask(session, calls.findings(run))))


def evaluations(session: Session, run: Named) -> Script[Evaluations]:
    """Every evaluation at full precision as arrays, in the order of the stages; `to_dataframe()` makes a table."""
    from clearance.client.arrays import Evaluations

    detail = yield from ask(session, calls.run(run))
    content = yield from ask(session, calls.export_file(run, "evaluations.csv"))
    return Evaluations.of(content, detail)


def trace(session: Session, run: Named, name: str = "F1") -> Script[Trace]:
    """A trace as arrays by the names of its quantities: nominal, F1, F2, ..."""
    from clearance.client.arrays import Trace

    return Trace.of((yield from ask(session, calls.trace_data(run, name, MOST_POINTS))))


def download(session: Session, call: Call[bytes], file: Path) -> Script[Path]:
    """Write an answer to a file; an incomplete download leaves no file. Raises OSError if it cannot be written."""
    yield from _answered(session, Save(call, file))
    return file


def export(session: Session, run: Named, folder: str | Path, files: Iterable[str] = calls.USUAL) -> Script[list[Path]]:
    """Write files of a run into a folder, which is made if there is none; returns their paths.

    files: campaign.yaml, report.html, report.pdf, and those that `exports` lists: the `file` of each.
    """
    requests = [(name, calls.file(run, name)) for name in files]
    Path(folder).mkdir(parents=True, exist_ok=True)
    written = []
    for name, call in requests:
        written.append((yield from download(session, call, Path(folder) / name)))
    return written


def picture(session: Session, run: Named, file: str | Path) -> Script[Path]:
    """Write the worst case from above as SVG; returns the file's path. `NotFoundError` if no flight is stored."""
    return (yield from download(session, calls.export_file(run, "worst-case.svg"), Path(file)))


def campaign_text(session: Session, run: Named) -> Script[str]:
    """The campaign of a run as it was submitted, with its comments."""
    return (yield from ask(session, calls.campaign_file(run))).decode("utf-8", "replace")


def report(session: Session, run: Named, file: str | Path) -> Script[Path]:
    """Write the safety-case report, as PDF if the file's name ends with .pdf, else as HTML; returns its path."""
    path = Path(file)
    call = calls.report_pdf(run) if path.suffix == ".pdf" else calls.report_html(run)
    path.parent.mkdir(parents=True, exist_ok=True)
    return (yield from download(session, call, path))
