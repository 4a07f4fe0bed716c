"""What the audit takes as given, and why: the table of docs/evidence.md; tests forge everything else."""

from __future__ import annotations

from typing import NamedTuple


class Trusted(NamedTuple):
    """Something in a record that the audit does not recompute; paths: patterns of where it is stored."""

    what: str
    why: str
    paths: tuple[str, ...]


TRUSTED = (
    Trusted(
        "Costs and status of evaluations, and the trajectories",
        "nothing is simulated: `clearance replay` evaluates cases again; a sign-off has the evidence digest",
        (r"arrays\.costs", r"arrays\.status", r"arrays\.points", r"files\.trace", r"blocks\."),
    ),
    Trusted(
        "The campaign, if the whole record fits another one",
        "what was asked is not a result: compare its digest with that of your file",
        (r"campaign\.",),
    ),
    Trusted(
        "Which points a search evaluated, which of its members requested them, and when it stopped; by which rule it "
        "and its local searches ended, in the words of its method",
        "searches are not run again, and any method may state rules of its own; only samples, the grid, the nominal "
        "case and the baseline have points that follow",
        (r"\.stop\.", r"\.stop$", r"minima\.#\.(statement|text|values)", r"members",
         r"\.apart\.#\.(member|title|family|index)", r"evaluations$", r"gap\.(?!statement)", r"candidates", r"rounds"),
    ),
    Trusted(
        "Why an evaluation failed or was excluded, and that one succeeded only when its call was tried again",
        "its simulator said so; the table, the list of failures and the counts that follow are compared",
        (r"arrays\.reasons",),
    ),
    Trusted(
        "In a folder: the baseline, whose run is not in it",
        "the database has that run, and there its findings, threshold and campaign are compared",
        (r"campaign\.baseline",),
    ),
    Trusted(
        "In a folder: that a sample's seed was drawn at the launch",
        "only the database has the launch, and there it is compared",
        (r"drawn_at_launch",),
    ),
    Trusted(
        "Basins: which cases are one worst case, whether all were polished, what the allowance of validation left out",
        "they rest on descents and on lines between cases, which are not repeated; the allowance itself is recomputed",
        (r"left_out", r"basin", r"complete", r"since", r"to_near_best",
         r"comparison\.#\.(minima|apart)"),
    ),
    Trusted(
        "Values by half the step, the reference integrator and repeated calls; spot checks; neighbours",
        "they are evaluations, too; tolerances, agreement and counts that follow from them are recomputed",
        (r"half_step\.(cost|reason)", r"integrator\.(cost|reason)", r"again", r"repeats\.(values|reasons)",
         r"incumbents", r"spot_checks\.(compared|largest|median|violating|lowest_reference|at|reasons)",
         r"violations\.confirmed", r"neighbours", r"realisation", r"drawn_realisations", r"measured\.(?!statement)",
         r"untraced"),
    ),
    Trusted(
        "The encounter: closest approach, motion, what lies beyond the horizon, the flight without avoidance",
        "they come from trajectories; the checks that follow from them are recomputed",
        (r"encounter", r"\.closest\."),
    ),
    Trusted(
        "Of an estimate of P(violation) by another engine, whose search does not repeat here: the density of draws, "
        "how many of them are counted (a third of the budget at least), the origins of a mode, the least budget, that "
        "all known violations are too far, and the alarms of violations without a mode and of modes met once",
        "the engine here repeats the search over the stored evaluations, and any density that was fixed before the "
        "draws gives an unbiased estimate; the numbers, the interval, the shares and the other alarms are recomputed",
        (),
    ),
    Trusted(
        "Of a region of attraction: how far the loop returns in simulation, the difference of model and loop, the "
        "model of a component that is not shipped, and why there is no region",
        "they are measured, which the sentence states; the certificate is checked exactly, and with it the model of a "
        "shipped loop, the sections and the fraction are recomputed",
        (r"results\.#\.simulated", r"sections\.#\.simulated", r"results\.#\.difference", r"refused\.why"),
    ),
    Trusted(
        "Boundary of a violation, Morris' and Sobol's indices",
        "they illustrate; no verdict rests on them",
        (r"boundary", r"morris", r"sobol"),
    ),
    Trusted(
        "Versions, machine, times, names, tags, notes, labels, convergence history",
        "they are no claims; what differs here is named by `clearance replay`",
        (r"versions", r"identity\.(machine|evaluating)", r"seconds",
         r"^result\.(labels|continues|given)", r"components", r"best_so_far"),
    ),
    Trusted(
        "In a database: values under names that no version has",
        "nothing reads or shows them; in a folder, where people read result.json, they disagree",
        (r"unknown name",),
    ),
    Trusted(
        "Words of a package for its own simulator",
        "they are not in the record's templates; the audit names what it could not compare",
        (r"package words",),
    ),
    Trusted(
        "Sentences of a record that states other templates than those of this version",
        "they are not made again, which the closing sentence states; numbers and checks are judged",
        (r"versions\.(wording|clearance)",),
    ),
    Trusted(
        "A record in the form of an earlier version",
        "it has no evidence digest; the closing sentence counts what could not be audited",
        (r"earlier version",),
    ),
)  # fmt: skip
