"""What bars "cleared" whatever a run finds: the checks of a verdict that campaign and catalogue decide beforehand.

Known before anything is evaluated, so that no run is begun in vain. Start reading at `foreseen`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from campaigns import rules
from campaigns.asked.spec import Campaign
from campaigns.asked.stages import Search
from campaigns.catalogue import Catalogue, MethodEntry
from campaigns.checked import distances, prediction, turning
from campaigns.checked.check import parameters, seeded, unvaried
from campaigns.claims.say import listed
from campaigns.claims.spans import words
from campaigns.codes import CheckCode

MEAN = (
    "every evaluation is the mean over noise realisations, which can hide a violation in one of them; set combine to "
    "worst"
)


def one_realisation(campaign: Campaign, paths: Sequence[str]) -> str:
    """Why nothing is known of other noise where these seeds are fixed or have few values."""
    fixed = [path for path in paths if path not in campaign.uncertain]
    many = f"uniform over at least {rules.REALISATIONS.value} whole numbers"
    verb, other = ("is", "it") if len(fixed or paths) == 1 else ("are", "them")
    if fixed:
        why = f"{verb} fixed, which selects one realisation of the noise"
        return f"{words(listed(fixed))} {why}; make {other} uncertain, {many}"
    return f"{words(listed(paths))} {verb} not {many}, so that few realisations of the noise decide; widen the bounds"


def undeclared(seeds: Mapping[str, str]) -> str:
    """Why nothing is known of other noise where a function has these seeds, which no campaign can vary."""
    named = words(listed([f"{name} = {value}" for name, value in seeds.items()]))
    each, other = ("is", "it") if len(seeds) == 1 else ("are", "them")
    why = f"{named} {each} the same in every call of the function, which selects one realisation of the noise"
    many = f"uniform over at least {rules.REALISATIONS.value} whole numbers"
    return f"{why}; make {other} a parameter of the search, uncertain, {many}"


class Barred(NamedTuple):
    """A check that cannot hold, and why, a clause with what to do."""

    code: CheckCode
    why: str

    @property
    def statement(self) -> str:
        """A sentence."""
        return f"This campaign cannot be cleared: {self.why.removesuffix('.')}."


def foreseen(campaign: Campaign, catalogue: Catalogue) -> list[Barred]:
    """The checks that cannot hold, in the order of a verdict."""
    found = [*_searches(campaign, catalogue), *_evaluations(campaign, catalogue), *_sample(campaign, catalogue)]
    return sorted(found, key=lambda barred: rules.position(barred.code))


def _searches(campaign: Campaign, catalogue: Catalogue) -> Iterator[Barred]:
    """Methods that are none, too few or too short to agree."""
    known = [(search, entry) for search in campaign.stages.search if (entry := catalogue.method(search.method))]
    if len(known) < len(campaign.stages.search):
        return
    aiming = [(search, entry) for search, entry in known if rules.FAMILIES[entry.kind].least is not None]
    globally = [(search, entry) for search, entry in aiming if rules.FAMILIES[entry.kind].all_agree]
    if not globally:
        yield Barred(CheckCode.AGREEMENT, "no global method searches; add one, such as DIRECT")
        return
    for search, entry in globally:
        least = _least(entry, campaign)
        if search.evaluations < least:
            many = f"{search.evaluations:,} evaluation{'' if search.evaluations == 1 else 's'}"
            why = f"{entry.title} has {many}, and at least {least:,} count as a search of {len(campaign.uncertain)}"
            yield Barred(CheckCode.AGREEMENT, f"{why} uncertain parameter{'' if len(campaign.uncertain) == 1 else 's'}")
    if any(s.evaluations < _least(e, campaign) for s, e in globally):
        return
    counted = [(s, e) for s, e in aiming if s.evaluations >= _least(e, campaign)]
    witnesses = [principles for s, e in counted for principles in _witnesses(s, e)]
    if not any(a.isdisjoint(b) for a, b in combinations(witnesses, rules.METHODS.value)):
        families = frozenset.union(*witnesses)
        one = f"all methods that count as a search are of one family ({', '.join(families)})"
        if len(families) > 1:
            one = f"no two of the methods that count as a search ({', '.join(e.title for _, e in counted)}) search by "
            one += "different principles, of which a method has those of all its members"
        yield Barred(CheckCode.AGREEMENT, f"{one}; add a method of another family, which must confirm the worst case")


def _least(entry: MethodEntry, campaign: Campaign) -> int:
    least = rules.FAMILIES[entry.kind].least
    return len(campaign.uncertain) * (0 if least is None else least.value)


def _witnesses(search: Search, entry: MethodEntry) -> list[frozenset[str]]:
    """The principles of a method with those of its members that share, and of each that is apart; undeclared methods
    count by name."""
    defaults = {name: option.get("default") for name, option in entry.options.get("properties", {}).items()}
    chosen = (by.get(str((defaults | search.options).get(name))) for name, by in entry.families.items())
    own = next((family for family in chosen if family), entry.family or entry.name)
    return [frozenset([own, *entry.together.values()]), *(frozenset([family]) for family in entry.apart.values())]


def _evaluations(campaign: Campaign, catalogue: Catalogue) -> Iterator[Barred]:
    """What an evaluation cannot show."""
    nominal = {path: value for path, (_, value) in parameters(campaign, catalogue).items()}
    if seeds := unvaried(campaign, nominal):
        yield Barred(CheckCode.NOISE, one_realisation(campaign, seeds))
    entry = None if campaign.simulator is None else catalogue.simulator(campaign.simulator.name)
    if entry is not None and entry.seeds:
        yield Barred(CheckCode.NOISE, undeclared(entry.seeds))
    if (simulator := campaign.simulator) is not None:
        if simulator.calls > 1 and simulator.combine != "worst":
            why = f"a {simulator.combine} can hide a violation by one of the calls; set combine to worst"
            yield Barred(CheckCode.CALLS, why)
        return
    bars = {
        CheckCode.SAMPLING: turning.unfollowed(campaign, catalogue),
        CheckCode.DISTANCES: distances.overlooked(campaign, catalogue),
    }
    yield from (Barred(code, words(why)) for code, why in bars.items() if why)
    realised = campaign.given_scenario.realisations
    if not seeds and seeded(campaign, catalogue) and len(realised.seeds) > 1 and realised.combine == "mean":
        yield Barred(CheckCode.NOISE, MEAN)


def _sample(campaign: Campaign, catalogue: Catalogue) -> Iterator[Barred]:
    """A sample that is none or too small, and a bound that is out of reach."""
    certify, least = campaign.stages.certify, rules.SAMPLE.value
    if certify is None:
        none = "no independent sample is drawn, which would show what every search missed"
        yield Barred(CheckCode.SAMPLE, f"{none}; add a certify stage of at least {least}")
    elif certify.samples < least:
        yield Barred(CheckCode.SAMPLE, f"the independent sample has {certify.samples}, fewer than {least}")
    best = prediction.predicted(campaign, catalogue)
    warned = None if best is None else prediction.warning(best, campaign)
    if warned is not None:
        code = CheckCode.PROBABILITY if campaign.target_probability is None else CheckCode.TARGET
        yield Barred(code, warned[0].lower() + warned[1:])
