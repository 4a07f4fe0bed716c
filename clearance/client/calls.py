"""Every request that the client makes, as a value: method, path, parameters, body, and the type of the answer.

A test compares each with the OpenAPI document, so that a renamed route or parameter breaks it. Nothing here sends
anything: that is in `clearance.client.scripts` and `clearance.client.drivers`.
"""

from __future__ import annotations

import json
import os
import re
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import TypeAdapter

from clearance.client import answers

T = TypeVar("T")
Named = str | answers.Run
"""A run: its name, R-0001, or an answer about it."""
NamedSweep = str | answers.Sweep
"""A sweep: its name, S-0001, or an answer about it."""
Given = Mapping[str, Any] | str | os.PathLike[str]
"""A campaign: a document, the path of a file, the name of one in the library, or YAML text of several lines."""
Query = Mapping[str, str | int | float | bool | list[str]]
LONGEST = 300.0
"""For a file that the service has to make first, such as a report [s]."""


@dataclass(frozen=True)
class Call(Generic[T]):
    """One request. path: as in the OpenAPI document, with the values of `place` filled in when it is sent."""

    method: str
    path: str
    answer: Any
    """The type of the JSON that is answered; `bytes` for a file."""
    place: Mapping[str, Named | NamedSweep] = field(default_factory=dict)
    query: Query = field(default_factory=dict)
    body: dict[str, object] | None = None
    key: str | None = None
    """The Idempotency-Key: a repeated request with it returns what the first one did."""
    timeout: float | None = None

    @property
    def address(self) -> str:
        """The path with its values, below /api/v1/; names that would leave it are not accepted by the service."""
        from urllib.parse import quote

        values = {name: quote(name_of(value), safe="") for name, value in self.place.items()}
        return self.path.format(**values).lstrip("/")

    @property
    def known(self) -> answers.Run | answers.Sweep | None:
        """The answer by which the run or sweep of the request was given; None if it was given by its name."""
        return next((value for value in self.place.values() if not isinstance(value, str)), None)

    def read(self, content: bytes) -> T:
        """The answer; raises ValueError if it is not of the described type."""
        if self.answer is bytes:
            return content  # type: ignore[return-value]
        found: T = TypeAdapter(self.answer).validate_python(json.loads(content))
        return found


def name_of(run: Named | NamedSweep) -> str:
    """The name of a run or sweep, such as R-0001, from its name or an answer."""
    return run if isinstance(run, str) else run.id


def _of(run: Named, **more: str) -> dict[str, Named | NamedSweep]:
    return {"run": run, **more}


def _set(**arguments: Any) -> dict[str, Any]:
    """The arguments that were given."""
    return {name: value for name, value in arguments.items() if value not in (None, [], {}, "")}


def document(campaign: Given) -> dict[str, object]:
    """A campaign as a body has it: the document, and the original text where there is one; raises `CampaignError`."""
    if isinstance(campaign, Mapping):
        return {"campaign": dict(campaign)}
    from campaigns.asked.load import library, load_text, read_text

    source = str(campaign)
    if isinstance(campaign, str) and "\n" in campaign:
        source, text = "campaign", campaign
    else:
        path = Path(campaign)
        text = read_text(library().get(source, path) if not path.exists() else path)
    return {"campaign": load_text(text, source).document(), "text": text}


def submit(
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
    text: str | None = None,
    key: str | None = None,
) -> Call[answers.Submitted]:
    """Queue a run of a campaign; raises `CampaignError` or `InvalidCampaignError` with its problems.

    campaign: a document, the path of a file, the name of one in the library, or YAML text. baseline: R-0001, or
    label:branch=main. priority: -10 to 10, higher starts first. group: cancels the runs of the same group that have not
    ended, of the same owner; an administrator's call cancels those of all owners. reuse: answer with an earlier run of
    the same campaign and code that has a verdict. sample_seed: of the independent sample of an earlier run of the
    campaign, which is repeated. text: original text of a document, which is stored with its comments. key: a
    repeated submission with the same key returns the same run; by default each call has its own.
    """
    body = document(campaign) | _set(text=text) | _set(name=name, labels=dict(labels or {}))
    body |= {} if tags is None else {"tags": list(tags)}  # none at all are not those of the campaign
    body |= _set(baseline=baseline, group=group, sample_seed=sample_seed) | ({"priority": priority} if priority else {})
    body |= {"reuse": True} if reuse else {}
    return Call("POST", "/runs", answers.Submitted, body=body, key=key or str(uuid.uuid4()))


def run(run: Named) -> Call[answers.RunDetail]:
    """A run with its campaign, stages and verdict as it is now."""
    return Call("GET", "/runs/{run}", answers.RunDetail, _of(run))


def run_page(
    *,
    q: str = "",
    state: Iterable[str] = (),
    verdict: Iterable[str] = (),
    tag: Iterable[str] = (),
    campaign: Iterable[str] = (),
    owner: Iterable[str] = (),
    label: Iterable[str] = (),
    sort: str = "",
    cursor: str | None = None,
    limit: int = 50,
) -> Call[answers.RunPage]:
    """One page of the list of runs."""
    several = {"state": state, "verdict": verdict, "tag": tag, "campaign": campaign, "owner": owner, "label": label}
    lists = {name: _list(values) for name, values in several.items()}
    query = _set(q=q, sort=sort, cursor=cursor, limit=limit, **lists)
    return Call("GET", "/runs", answers.RunPage, query=query)


def _list(values: Iterable[str]) -> list[str]:
    return [values] if isinstance(values, str) else list(values)


def cancel(run: Named) -> Call[answers.Run]:
    """Cancel a run; one that has ended is unchanged."""
    return Call("POST", "/runs/{run}/cancel", answers.Run, _of(run))


def retry(run: Named) -> Call[answers.Run]:
    """Queue a failed run again, with its stored evaluations; if none has a value, they are made again."""
    return Call("POST", "/runs/{run}/retry", answers.Run, _of(run), key=str(uuid.uuid4()))


def restart(run: Named) -> Call[answers.Run]:
    """Begin a run again that waits for the code that began it; its evaluations are discarded."""
    return Call("POST", "/runs/{run}/restart", answers.Run, _of(run), key=str(uuid.uuid4()))


def carry_on(run: Named) -> Call[answers.Run]:
    """Continue a run that waits for the code that began it as a new run, with the evaluations that are still valid."""
    return Call("POST", "/runs/{run}/continuation", answers.Run, _of(run), key=str(uuid.uuid4()))


def findings(run: Named) -> Call[list[answers.Finding]]:
    """The distinct worst cases, the lowest first."""
    return Call("GET", "/runs/{run}/findings", list[answers.Finding], _of(run))


def most_likely_violation(run: Named) -> Call[answers.MostLikely]:
    """The most likely of the stored violations, under the stated distributions."""
    return Call("GET", "/runs/{run}/most-likely-violation", answers.MostLikely, _of(run))


def signoffs(run: Named) -> Call[answers.Signoffs]:
    """Who signed off the results, with the standing of each sign-off."""
    return Call("GET", "/runs/{run}/signoffs", answers.Signoffs, _of(run))


def traces(run: Named) -> Call[list[answers.TraceInfo]]:
    """What traces are stored: nominal, F1, F2, ..."""
    return Call("GET", "/runs/{run}/traces", list[answers.TraceInfo], _of(run))


def trace_data(run: Named, name: str, max_points: int) -> Call[answers.TraceData]:
    """One trace; its rows are thinned to `max_points`, at most 100,000."""
    return Call(
        "GET", "/runs/{run}/traces/{name}", answers.TraceData, _of(run, name=name), query={"max_points": max_points}
    )


def exports(run: Named) -> Call[list[answers.ExportFile]]:
    """The files of a run."""
    return Call("GET", "/runs/{run}/exports", list[answers.ExportFile], _of(run))


def events(run: Named) -> Call[bytes]:
    """The stream of a run's changes."""
    return Call("GET", "/events", bytes, query={"run": name_of(run)})


def check(campaign: Given) -> Call[answers.Checked]:
    """Whether the service can run a campaign, and its problems; stores nothing."""
    body = {"campaign": dict(campaign) if isinstance(campaign, Mapping) else document(campaign)["campaign"]}
    return Call("POST", "/campaigns/check", answers.Checked, body=body)


def schema() -> Call[dict[str, object]]:
    """The JSON Schema of a campaign, as this service reads it."""
    return Call("GET", "/campaigns/schema", dict[str, object])


def health() -> Call[answers.Health]:
    """Whether the service responds; needs no token."""
    return Call("GET", "/health", answers.Health)


def sweep(
    campaign: Given,
    path: str,
    values: Iterable[float],
    *,
    name: str | None = None,
    tags: Iterable[str] | None = None,
    labels: Mapping[str, str] | None = None,
    priority: int = 0,
    key: str | None = None,
) -> Call[answers.Sweep]:
    """Queue a run for each value of a fixed parameter; all of them, or none if one is refused."""
    body = {"campaign": document(campaign)["campaign"], "path": path, "values": [float(value) for value in values]}
    body |= _set(name=name, tags=None if tags is None else list(tags), labels=dict(labels or {}))
    body |= {"priority": priority} if priority else {}
    return Call("POST", "/sweeps", answers.Sweep, body=body, key=key or str(uuid.uuid4()))


def read_sweep(sweep: NamedSweep) -> Call[answers.Sweep]:
    """A sweep as it is now."""
    return Call("GET", "/sweeps/{sweep}", answers.Sweep, {"sweep": sweep})


def cancel_sweep(sweep: NamedSweep) -> Call[answers.Sweep]:
    """Cancel every run of a sweep; those that have ended are unchanged."""
    return Call("POST", "/sweeps/{sweep}/cancel", answers.Sweep, {"sweep": sweep})


def sweep_table(sweep: NamedSweep) -> Call[bytes]:
    """The sweep as CSV."""
    return Call("GET", "/sweeps/{sweep}/table.csv", bytes, {"sweep": sweep}, timeout=LONGEST)


CAMPAIGN, HTML, PDF = "campaign.yaml", "report.html", "report.pdf"
ELSEWHERE: Mapping[str, float | None] = {CAMPAIGN: None, HTML: LONGEST, PDF: LONGEST}
"""The files of a run that are not among its exports: the campaign as it was submitted, with its comments, and the
safety-case report; for each how long it may take [s]."""
USUAL = (CAMPAIGN, "run.json", "evaluations.csv", "findings.csv", HTML)
"""The files that every run has."""


def file(run: Named, name: str) -> Call[bytes]:
    """A file of a run: campaign.yaml, report.html, report.pdf or one that its list of exports has."""
    if not re.fullmatch(r"\w[\w-]*(\.[\w-]+)+", name, re.ASCII):
        raise ValueError(f"there is no file {name!r} of a run; there are {', '.join(USUAL)} and others")
    if name in ELSEWHERE:
        return Call("GET", f"/runs/{{run}}/{name}", bytes, _of(run), timeout=ELSEWHERE[name])
    return Call("GET", "/runs/{run}/exports/{file}", bytes, _of(run, file=name), timeout=LONGEST)
