"""How claims describe a closed loop: components, conditions, settings, terms for evaluations.

Campaign and catalogue are enough for it, so that a stored run is described as it was: `described`.
"""

from __future__ import annotations

from campaigns import Campaign, Catalogue
from campaigns.catalogue import Role
from campaigns.checked import distances, turning
from campaigns.checked.check import seeded
from campaigns.claims.say import count, limit, listed, say
from campaigns.claims.spans import Spans
from campaigns.claims.terms import Condition, Scope, Words
from campaigns.codes import CheckCode
from worker.evidence.scopes.base import Terms

UNSWITCHED = (
    " without declared switches: an abrupt change between the instants of the integration may be missed by all of its "
    "means"
)
"""After the titles of components that read the time and do not declare at which instants they change."""


def described(campaign: Campaign, catalogue: Catalogue, integrator: str) -> Terms:
    """The terms of a campaign's scenario; only criteria on obstacles have a closest approach."""
    criterion = catalogue.component("criterion", campaign.criterion.component)
    near: tuple[Condition, ...] = ("closest approach",) if criterion and criterion.of == "obstacles" else ()
    reasons = {
        CheckCode.SAMPLING: turning.unfollowed(campaign, catalogue),
        CheckCode.DISTANCES: distances.overlooked(campaign, catalogue),
    }
    return Terms(
        _scope(campaign, catalogue),
        Words(
            one="flight",
            agree=f"the step-halving check and {integrator} agree",
            disagrees=f"the step-halving check or {integrator} disagrees",
            every="all integrations",
            again="simulated again at half the step and with the reference integrator",
            reference="the reference integrator",
        ),
        shows=(*near, "motion", "avoidance"),
        bars=tuple((code, reason) for code, reason in reasons.items() if reason),
        declares=distances.declaration(campaign, catalogue),
        own_rule=criterion is not None and criterion.own_rule,
        followed=distances.followed(campaign, catalogue),
        obstacles=tuple(_title(catalogue, "obstacle", each.component) for each in campaign.given_scenario.obstacles),
    )


def _scope(campaign: Campaign, catalogue: Catalogue) -> Scope:
    """Components, conditions, horizon and step."""
    scenario = campaign.given_scenario
    obstacles = len(scenario.obstacles)
    parts: list[tuple[Role, str]] = [
        ("vehicle", scenario.vehicle.component),
        ("controller", scenario.controller.component),
        ("avoider", scenario.avoider.component),
    ]
    titles = ", ".join(_title(catalogue, *part) for part in parts)
    what = f"{titles}, {obstacles} {'obstacle' if obstacles == 1 else 'obstacles'}"
    criterion = catalogue.component("criterion", campaign.criterion.component)
    later = "" if criterion is None or criterion.of == "obstacles" else ", beyond which nothing is known"
    settings = say("horizon ", limit(scenario.horizon, "s"), later, ", step ", limit(scenario.step, "s"))
    unknown = _unswitched(campaign, catalogue)
    if unknown:
        settings = say(settings, "; ", listed(unknown), UNSWITCHED)
    return Scope(
        what=say(what, _conditions(campaign, catalogue)),
        settings=settings,
        version=f"components of clearance {catalogue.version}",
        distances=distances.clause(campaign, catalogue),
    )


def _conditions(campaign: Campaign, catalogue: Catalogue) -> Spans:
    """The clause for the environment, the faults and the noise realisations that the searches simulated."""
    scenario, realised = campaign.given_scenario, campaign.given_scenario.realisations
    titles = [_title(catalogue, "environment", part.component) for part in scenario.environment]
    titles += [_title(catalogue, "fault", part.component) for part in scenario.faults]
    statement = say(", with ", listed(titles)) if titles else ()
    if not seeded(campaign, catalogue):
        return statement
    seeds = listed([str(seed) for seed in realised.seeds])
    if len(realised.seeds) > 1:
        many = count(len(realised.seeds))
        return say(statement, f", {realised.combine} of ", many, " realisations (noise seeds ", seeds, ")")
    return say(statement, ", noise seed ", seeds)


def _unswitched(campaign: Campaign, catalogue: Catalogue) -> list[str]:
    """The titles of faults and environments of which it is not known when they change."""
    scenario = campaign.given_scenario
    environment: list[tuple[Role, str]] = [("environment", part.component) for part in scenario.environment]
    faults: list[tuple[Role, str]] = [("fault", part.component) for part in scenario.faults]
    entries = (catalogue.component(*named) for named in (*environment, *faults))
    return [entry.title for entry in entries if entry is not None and entry.unswitched]


def _title(catalogue: Catalogue, role: Role, name: str) -> str:
    entry = catalogue.component(role, name)
    return name if entry is None else entry.title
