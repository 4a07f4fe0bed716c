"""A run as JUnit XML, for the test report of a CI service: a case for the verdict, and one for the criterion, for each
requirement, check and finding compared.

The format has no standard; this is the form that Jenkins, GitLab and GitHub's reporters read. Start reading at `junit`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

from campaigns.results import verdicts
from campaigns.results.regression import FindingChange, Standing
from worker.cli._ended import EndedRun

if TYPE_CHECKING:
    from campaigns.results import Verdict

_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot contain."""


def write(file: Path, ended: EndedRun) -> None:
    """Write the file."""
    file.write_text(junit(ended), encoding="utf-8")


def junit(ended: EndedRun) -> str:
    """The document."""
    suite = Xml.Element("testsuite", name=_clean(ended.campaign), time=f"{ended.seconds:.3f}")
    properties = Xml.SubElement(suite, "properties")
    values = {"run": ended.run, "link": ended.link, "state": ended.state}
    values |= {f"label.{key}": value for key, value in ended.labels.items()}
    for name, value in values.items():
        if value:
            Xml.SubElement(properties, "property", name=name, value=_clean(value))
    _verdict(suite, ended)
    _criterion(suite, ended)
    _requirements(suite, ended)
    _checks(suite, ended)
    regression = ended.regression
    if regression is not None:
        for case in regression.cases:
            _case(suite, ended, case)
    elif not ended.compared:
        case_of = _added(suite, ended, "baseline")
        Xml.SubElement(case_of, "skipped", message=_clean(" ".join(ended.notes)))
    for kind, tag in (("tests", "testcase"), ("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(kind, str(len(suite.findall(f".//{tag}"))))
    suites = Xml.Element("testsuites")
    suites.append(suite)
    Xml.indent(suites)
    return Xml.tostring(suites, encoding="unicode", xml_declaration=True) + "\n"


def _verdict(suite: Xml.Element, ended: EndedRun) -> None:
    case, verdict = _added(suite, ended, "verdict"), ended.verdict
    if verdict is None:
        message = f"no verdict: {ended.state}" + (f": {ended.error}" if ended.error else "")
        Xml.SubElement(case, "error", message=_clean(message), type=ended.state).text = _clean(ended.link)
        return
    if verdict.verdict == "cleared" or _accepted(verdict):
        Xml.SubElement(case, "system-out").text = _clean("\n".join([verdict.reason, *ended.notes]))
        return
    text = [verdict.reason, *ended.notes, *_worst(verdict), ended.link]
    if ended.replay and verdict.worst is not None:
        text.append(f"{ended.replay} {verdict.worst.finding}")
    failure = Xml.SubElement(case, "failure", message=_clean(verdict.sentence), type=str(verdict.verdict))
    failure.text = _clean("\n".join(filter(None, text)))


def _accepted(verdict: Verdict) -> bool:
    """Whether the policy of the campaign accepts its violations."""
    return verdict.regression is not None and verdict.regression.accepted and verdict.verdict == "violated"


def _criterion(suite: Xml.Element, ended: EndedRun) -> None:
    """A violation fails it; inconclusive is neither."""
    verdict = ended.verdict
    if not ended.criterion or verdict is None:
        return
    case = _added(suite, ended, f"criterion {ended.criterion}")
    if verdict.verdict == "cleared":
        Xml.SubElement(case, "system-out").text = _clean(verdict.sentence)
    else:
        _failed(case, verdict, "failure" if verdict.verdict == "violated" else "skipped")


def _requirements(suite: Xml.Element, ended: EndedRun) -> None:
    """Evidence of this run alone: other campaigns may state a requirement, and nobody has signed off yet."""
    for requirement in ended.requirements:
        case = _added(suite, ended, f"requirement {requirement}")
        if ended.verdict is None:
            Xml.SubElement(case, "error", message=_clean(f"no evidence: {ended.state}"), type=ended.state)
        elif ended.verdict.verdict == "cleared":
            text = f"{ended.verdict.sentence}\nEvidence of this run alone; the matrix of requirements has all runs."
            Xml.SubElement(case, "system-out").text = _clean(text)
        else:
            _failed(case, ended.verdict, "failure")


def _checks(suite: Xml.Element, ended: EndedRun) -> None:
    if ended.verdict is None:
        return
    failed = 0 if ended.verdict.evaluations is None else ended.verdict.evaluations.failed
    for check in verdicts.described(ended.verdict.checks, failed):
        case = _added(suite, ended, f"check {check.title}")
        text = f"{check.text}; {check.but}" if check.but else check.text
        if check.standing == "holds":
            Xml.SubElement(case, "system-out").text = _clean(text)
        elif check.standing == "open" or _accepted(ended.verdict):
            Xml.SubElement(case, "skipped", message=_clean(text))
        else:
            Xml.SubElement(case, "failure", message=_clean(text), type=str(check.code))


def _failed(case: Xml.Element, verdict: Verdict, tag: str) -> None:
    """What the policy accepts is no failure of the job, and not met either."""
    accepted = _accepted(verdict)
    message = f"{verdict.sentence}{' Accepted by the policy of the campaign.' if accepted else ''}"
    if accepted or tag == "skipped":
        Xml.SubElement(case, "skipped", message=_clean(message))
    else:
        Xml.SubElement(case, tag, message=_clean(message), type=str(verdict.verdict))


def _worst(verdict: Verdict) -> list[str]:
    return [] if verdict.worst is None else [f"{path} = {value!r}" for path, value in verdict.worst.parameters.items()]


def _case(suite: Xml.Element, ended: EndedRun, change: FindingChange) -> None:
    """The names do not contain the baseline's number, so that a CI service can follow a case from build to build."""
    name = f"{change.before} of the baseline" if change.before else f"new finding {change.now}"
    case = _added(suite, ended, name)
    if change.standing is Standing.NOT_COMPARED and not change.fails:
        Xml.SubElement(case, "skipped", message=_clean(change.text))
    elif change.fails:
        lines = [*(f"{path} = {value!r}" for path, value in change.parameters.items()), ended.link]
        failure = Xml.SubElement(case, "failure", message=_clean(change.text), type=str(change.standing))
        failure.text = _clean("\n".join(filter(None, [change.text, *lines, ended.command(change)])))
    else:
        Xml.SubElement(case, "system-out").text = _clean(change.text)


def _added(suite: Xml.Element, ended: EndedRun, name: str) -> Xml.Element:
    return Xml.SubElement(suite, "testcase", classname=_clean(ended.campaign), name=_clean(name))


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
