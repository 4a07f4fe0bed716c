"""The limits of the evidence: horizon, exclusions, noise, reference point of the distance."""

from __future__ import annotations

from backend.reports import words
from backend.reports.charts import sample
from backend.reports.record import Record
from backend.runs.question import WORDS
from backend.runs.schemas import StageDetail
from campaigns.checked.check import SEED, parts
from campaigns.claims import numbers, spans
from campaigns.claims.say import listed, on_side, say
from campaigns.claims.spans import Spans
from campaigns.runs import StageState

_NO_BOUND = "no bound on the probability of a violation is claimed"
_ENDS = {
    "": "",
    "centre": "Distances are measured to the obstacles’ centres: the threshold must include their size.",
    "surface": "Distances are measured to the obstacles’ surfaces.",
}
"""Sentences by the reference point of a criterion."""


def conditions(record: Record) -> list[str]:
    return [
        text
        for text in (
            _measured(record),
            _horizon(record),
            _excluded(record),
            _failed(record),
            *_noise(record),
            _question_count(record),
        )
        if text
    ]


def validation(record: Record) -> str:
    """What was validated, and what that does not show."""
    if record.validated is None:
        return "Validation is not finished." if _begun(record, "validate") else "Nothing was validated."
    if record.campaign.scenario is not None:
        covers = "Validation covers the numerical integration (step halving, reference integrator)"
        rest = "It does not compare the model with the vehicle."
    else:
        covers = "Validation repeats evaluations with the same simulator"
        rest = "It does not show that the simulator computes correctly."
    return f"{covers}{_around(record)}. {rest}"


def not_validated(record: Record) -> str:
    """Why no validated case is stated, by the state of the stage: it may have begun."""
    begun = _begun(record, "validate")
    if begun is None:
        return "No case was validated: the numbers of this report are not confirmed independently."
    verb = "evaluation of it was" if begun.evaluations == 1 else "evaluations of it were"
    made = f"{numbers.count(begun.evaluations)} {verb} made"
    return f"Validation is not finished: {made}. The numbers of this report are not confirmed independently."


def not_sampled(record: Record) -> Spans:
    """Why no sample is stated, by the state of the stage; the lowest value of what was drawn of it."""
    begun = _begun(record, "certify")
    if begun is None or not begun.evaluations:
        return say(f"No independent random sample was simulated: {_NO_BOUND}")
    verb, which = ("was", "and") if begun.evaluations == 1 else ("were", "the lowest of which")
    drawn = f"{numbers.count(begun.evaluations)} of {numbers.count(begun.planned)} planned draws {verb} simulated"
    lowest: Spans = ()
    if begun.best is not None and record.run.threshold is not None:
        lowest = say(f", {which} has ", on_side(begun.best, record.run.threshold, record.run.unit))
    return say(f"The independent sample is not finished: {drawn}", *lowest, f"; {_NO_BOUND}")


def _begun(record: Record, kind: str) -> StageDetail | None:
    return next((s for s in record.stages if s.kind == kind and s.state != StageState.WAITING), None)


def _around(record: Record) -> str:
    """Of which worst cases the neighbourhood was evaluated, a clause."""
    without = [f.label for f in record.findings if f.validation is None or f.validation.neighbours is None]
    if len(without) == len(record.findings):
        return "; no neighbourhood of a worst case was evaluated"
    but = f" but {spans.words(listed(without))}" if without else ""
    return f", and the neighbourhood of each worst case{but} was evaluated"


def _question_count(record: Record) -> str:
    """How often the question was asked: whoever repeats a run until it is cleared is seen."""
    runs = sum(record.question.values())
    if not runs:
        return "How often its question was asked is not known, because its campaign is of an earlier version."
    if runs < 2 and record.extends:
        return f"It extends {record.extends}, which asks the same question."
    if runs < 2:
        return (
            "No other run of this service asks the same question: the same system, bounds and criterion, at any "
            "threshold."
        )
    each = ", ".join(f"{numbers.count(n)} {WORDS.get(word, word)}" for word, n in record.question.items())
    return (
        f"{numbers.count(runs)} runs of this service ask the same question, the same system, bounds and criterion at "
        f"any threshold, removed ones included: {each}."
    )


def _measured(record: Record) -> str:
    """The description of the criterion, which states the reference point of the distance."""
    criterion = record.campaign.criterion
    if record.campaign.simulator is not None:
        return _result(record, record.campaign.simulator.name)
    entry = record.catalogue.component("criterion", criterion.component) if record.catalogue else None
    if entry is None:
        return (
            f"Criterion {criterion.component} has no stored description. Whether distances are measured to the "
            "obstacles’ centres or to their surfaces is unknown."
        )
    first = words.flowed(entry.text.strip().partition("\n\n")[0]).removeprefix(f"{entry.title}: ").rstrip(".")
    text = f"What the criterion measures ({entry.title}): {first or 'it has no description'}."
    ends = _ENDS[record.run.criteria[0].measured_to] if record.run.criteria else ""
    shown = None if record.validated is None else record.validated.encounter
    if shown is not None and shown.mismeasured is not None:
        ends = "It does not compute the distance to the obstacles that its component declares."
    return f"{text} {ends}".strip()


def _result(record: Record, simulator: str) -> str:
    entry = record.catalogue.simulator(simulator) if record.catalogue else None
    result = None if entry is None else entry.result(record.campaign.criterion.result)
    if entry is None or result is None:
        return f"Result {record.campaign.criterion.result} of {simulator}: its description is unknown."
    text = f": {result.text.rstrip('.')}" if result.text else ""
    return (
        f"The deciding result is {result.title} of {entry.title}{text}. This report examines neither what the "
        "simulator models nor whether an encounter takes place in it."
    )


def _horizon(record: Record) -> str:
    if record.campaign.scenario is None:
        return ""
    ends = f"Every evaluation ends at the horizon of {numbers.plain(record.campaign.scenario.horizon)} s."
    shown = None if record.validated is None else record.validated.encounter
    if shown is None or shown.beyond is None:
        return f"{ends} What comes after it is not examined."
    left = shown.beyond.not_continued
    of = " of the nominal case, the findings and the sample only" if left is None else ""  # of an earlier version
    rest = f"; at most {numbers.count(left)} further evaluations are not simulated on" if left else ""
    flights = f"{numbers.count(shown.beyond.flights)} flight{'' if shown.beyond.flights == 1 else 's'}"
    return f"{ends} What comes after it is examined for {flights}{of}, as section 9 states{rest}."


def _excluded(record: Record) -> str:
    run = record.run
    if not run.excluded_evaluations:
        return ""
    stated = sample(record)
    drawn = 0 if stated is None else stated.excluded
    draws = f", {numbers.count(drawn)} of them draws of the sample" if drawn else ""
    verb = "evaluation was" if run.excluded_evaluations == 1 else "evaluations were"
    lost = f"{numbers.count(run.excluded_evaluations)} {verb} excluded"
    if record.campaign.simulator is not None:
        rest = "No claim is made about such cases; a probability holds for the others only."
        return f"{lost} by the simulator{draws}. {rest} The verdict states its reasons."
    entry = record.catalogue.component("criterion", record.campaign.criterion.component) if record.catalogue else None
    if entry is not None and entry.own_rule:
        return (
            f"{lost}{draws} by the criterion's own rule. No claim is made about such starts; a probability holds for "
            "the other starts only."
        )
    return (
        f"{lost}{draws}: they start at or below the criterion. "
        "No claim is made about such starts; a probability holds for the other starts only."
    )


def _failed(record: Record) -> str:
    failed = record.run.failed_evaluations
    if not failed:
        return ""
    verb = "evaluation" if failed == 1 else "evaluations"
    return (
        f"{numbers.count(failed)} {verb} failed: their outcome is unknown. Worst value and "
        "margin are those of the evaluations that have a value."
    )


def _noise(record: Record) -> list[str]:
    if record.campaign.scenario is None or not _random(record):
        return []
    realisations = record.campaign.scenario.realisations
    seeds = ", ".join(str(seed) for seed in realisations.seeds)
    if len(realisations.seeds) == 1:
        searched = f"Searches simulated one noise realisation, that of seed {seeds}. Another realisation may be worse."
    else:
        searched = (
            f"Searches simulated the noise realisations of the seeds {seeds} and used the {realisations.combine} of "
            "them. Another realisation may be worse."
        )
    stated = sample(record)
    if stated is not None and stated.noise == "drawn":
        drawn = "The sample drew a new noise realisation for every simulation."
    elif stated is not None:
        drawn = "The sample simulated the same realisations: its statement holds for these only."
    else:
        drawn = ""
    return [f"{searched} {drawn}".strip()]


def _random(record: Record) -> bool:
    """Whether a component of the scenario takes a seed."""
    if record.catalogue is None:
        return bool(record.campaign.given_scenario.faults)
    entries = [
        record.catalogue.component(role, part.component)
        for _, _, role, part in parts(record.campaign)
        if role in ("environment", "fault")
    ]
    return any(parameter.name == SEED for entry in entries if entry for parameter in entry.parameters)
