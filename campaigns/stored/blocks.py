"""What is kept of a sample that stores its lowest flights only: blocks of consecutive draws, each counted.

Counts of all, moments, a histogram on a scale that is known before the first flight, the lowest flights by their index,
and a digest of every cost: whoever flies a block again finds whether it is the same. Start reading at `counted`.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from campaigns.cube import Floats
from campaigns.results.base import EXCLUDED, FLAKY, OK, TIMEOUT
from campaigns.results.sample import FAILURES, FIRST, KEPT, Beside

Whole = NDArray[np.int64]

BINS = 1000
"""Of the histogram, besides what is below and above it."""
REASONS, OTHERS = 50, "for other reasons"
"""Why draws were excluded: so many are named, the first ones."""
MOST = 1024
"""The most blocks of a sample without exclusions."""


@dataclass(frozen=True)
class Scale:
    """The bins of the histogram: equally wide, from `low` on."""

    low: float
    width: float

    @staticmethod
    def over(costs: Floats, threshold: float) -> Scale:
        """A scale over known costs, a quarter of their range wider at both ends; about the threshold without any."""
        low, high = (float(costs.min()), float(costs.max())) if len(costs) else (threshold, threshold)
        span = high - low or abs(threshold) or 1.0
        return Scale(low - 0.25 * span, 1.5 * span / BINS)

    @property
    def edges(self) -> Floats:
        """(BINS + 1,)"""
        return np.asarray(self.low + self.width * np.arange(BINS + 1), dtype=np.float64)

    def counts(self, costs: Floats) -> Whole:
        """How many costs are in each bin (BINS + 2,): at or below the first edge, above one and at or below the next,
        above the last."""
        return np.bincount(np.searchsorted(self.edges, costs), minlength=BINS + 2)


class Last(NamedTuple):
    """What a flight must not be above to be kept: cost and index of those that have a cost, index of the others."""

    cost: float = math.inf
    flight: int = 0
    failed: float = math.inf


@dataclass(frozen=True)
class Kept:
    """Flights in the order of their index in the sample: indices and status (k,), points (k, n), costs (k, criteria),
    NaN unless ok."""

    indices: Whole
    points: Floats
    costs: Floats
    status: NDArray[np.uint8]
    reasons: Mapping[int, str]
    """Why one is not ok, by its index."""

    @staticmethod
    def chosen(
        indices: Whole, points: Floats, costs: Floats, status: NDArray[np.uint8], reasons: Mapping[int, str]
    ) -> Kept:
        """What is kept of these flights."""
        ok, lost = np.flatnonzero(status == OK), np.flatnonzero((status != OK) & (status != EXCLUDED))
        lowest = ok[np.lexsort((indices[ok], costs[ok, 0]))[:KEPT]]
        failed = lost[np.argsort(indices[lost])[:FAILURES]]
        rows = np.unique(np.concatenate([lowest, failed, np.flatnonzero((indices < FIRST) & (status != EXCLUDED))]))
        rows = rows[np.argsort(indices[rows])]
        whys = {int(i): reasons[int(i)] for i in indices[rows] if int(i) in reasons}
        return Kept(indices[rows], points[rows], costs[rows], status[rows], whys)

    @property
    def lowest(self) -> Floats:
        """The first costs of the lowest flights, sorted."""
        return np.sort(self.costs[self.status == OK, 0])[:KEPT]

    @property
    def last(self) -> Last:
        """What others must not be above."""
        ok, lost = np.flatnonzero(self.status == OK), self.indices[self.status != OK]
        end = float(lost[FAILURES - 1]) if len(lost) >= FAILURES else math.inf
        if len(ok) < KEPT:
            return Last(failed=end)
        row = ok[np.lexsort((self.indices[ok], self.costs[ok, 0]))[KEPT - 1]]
        return Last(float(self.costs[row, 0]), int(self.indices[row]), end)

    def below(self, last: Last) -> Kept:
        """The flights that can be among the lowest of their sample, its first without a result, or its first draws."""
        value = self.costs[:, 0]
        lower = (value < last.cost) | ((value == last.cost) & (self.indices <= last.flight)) | math.isinf(last.cost)
        rows = np.where(self.status == OK, lower, self.indices <= last.failed) | (self.indices < FIRST)
        inside = set(self.indices[rows].tolist())
        reasons = {i: why for i, why in self.reasons.items() if i in inside}
        return Kept(self.indices[rows], self.points[rows], self.costs[rows], self.status[rows], reasons)

    @staticmethod
    def joined(parts: Sequence[Kept]) -> Kept:
        """What is kept of all of them."""
        reasons = {index: why for part in parts for index, why in part.reasons.items()}
        some = [part for part in parts if len(part.indices)] or parts[:1]  # a part without any has no dimensions
        columns = [(p.indices, p.points, p.costs, p.status) for p in some]
        indices, points, costs, status = map(np.concatenate, zip(*columns, strict=True))
        return Kept.chosen(indices, points, costs, status, reasons)


@dataclass(frozen=True)
class Block:
    """Consecutive draws of a sample from index `first` on, counted; a failed one is a violation."""

    first: int
    draws: int
    failed: int
    timeouts: int
    excluded: int
    violations: int
    total: float
    """The sum of the costs above the low end of the scale."""
    squares: float
    lowest: float | None
    """None if no cost is known."""
    highest: float | None
    bins: Whole
    kept: Kept
    exclusions: Mapping[str, int]
    """Excluded draws by their reason."""
    flaky: int
    """Those that succeeded only when a failed call was tried again."""
    digest: str
    """Of costs and status in the order of the draws, 32 hexadecimal digits."""
    seconds: float
    """Working time of the stage when it was flown [s]."""

    @property
    def evaluated(self) -> int:
        return self.draws - self.excluded

    def without(self, last: Last) -> Block:
        """The block without the flights that its sample does not keep."""
        return replace(self, kept=self.kept.below(last))


def counted(
    first: int,
    points: Floats,
    costs: Floats,
    status: NDArray[np.uint8],
    reasons: Mapping[int, str],
    scale: Scale,
    threshold: float,
    seconds: float = 0.0,
) -> Block:
    """Count the draws from index `first` on: points (m, n), costs (m, criteria), status (m,), the reasons by row."""
    ok = costs[status == OK, 0]
    excluded = int(np.count_nonzero(status == EXCLUDED))
    failed = len(status) - excluded - len(ok)
    above = ok - scale.low
    indices = np.arange(first, first + len(status), dtype=np.int64)
    return Block(
        first=first,
        draws=len(status),
        failed=failed,
        timeouts=int(np.count_nonzero(status == TIMEOUT)),
        excluded=excluded,
        violations=int(np.count_nonzero(ok <= threshold)) + failed,
        total=float(above.sum()),
        squares=float((above * above).sum()),
        lowest=float(ok.min()) if len(ok) else None,
        highest=float(ok.max()) if len(ok) else None,
        bins=scale.counts(ok),
        kept=Kept.chosen(indices, points, costs, status, {first + row: why for row, why in reasons.items()}),
        exclusions=named(Counter(reasons.get(int(row), "") for row in np.flatnonzero(status == EXCLUDED)), REASONS),
        flaky=sum(int(status[row]) == OK and why.startswith(FLAKY) for row, why in reasons.items()),
        digest=digest_of(costs, status),
        seconds=seconds,
    )


def named(counts: Counter[str], most: int) -> Counter[str]:
    """The first reasons, and the others under one name: a simulator's may have numbers in them."""
    first = [*counts][:most] if len(counts) > most else [*counts]
    found = Counter({reason: counts[reason] for reason in first})
    if others := counts.total() - found.total():
        found[OTHERS] += others
    return found


def digest_of(costs: Floats, status: NDArray[np.uint8]) -> str:
    """The digest of the bits of all costs that are known, and of every status."""
    known = np.where((status == OK)[:, None], costs, 0.0).astype("<f8")
    return hashlib.sha256(known.tobytes() + status.astype(np.uint8).tobytes()).hexdigest()[:32]


def size(samples: int) -> int:
    """Draws of a block: a power of two, so that blocks of a sample are at most `MOST`."""
    return 1 << max(0, -(-samples // MOST) - 1).bit_length()


@dataclass(frozen=True)
class Counted:
    """A sample as its blocks show it, in the order of their draws."""

    blocks: tuple[Block, ...]
    scale: Scale

    @staticmethod
    def of(blocks: Sequence[Block], scale: Scale) -> Counted:
        """Raises `ValueError` where draws are missing or counted twice."""
        ordered, next_draw = tuple(sorted(blocks, key=lambda block: block.first)), 0
        for block in ordered:
            if block.first != next_draw:
                raise ValueError(f"the block of draw {next_draw} is expected, given that of draw {block.first}")
            next_draw += block.draws
        return Counted(ordered, scale)

    @property
    def draws(self) -> int:
        return sum(block.draws for block in self.blocks)

    @property
    def evaluated(self) -> int:
        return sum(block.evaluated for block in self.blocks)

    @property
    def failed(self) -> int:
        return sum(block.failed for block in self.blocks)

    @property
    def excluded(self) -> int:
        return sum(block.excluded for block in self.blocks)

    @property
    def violations(self) -> int:
        return sum(block.violations for block in self.blocks)

    @property
    def exclusions(self) -> Counter[str]:
        return named(sum((Counter(block.exclusions) for block in self.blocks), Counter()), REASONS)

    @cached_property
    def kept(self) -> Kept:
        return Kept.joined([block.kept for block in self.blocks])

    def beside(self, threshold: float) -> Beside:
        """What is not kept."""
        kept, costs = self.kept, self.kept.costs[self.kept.status == OK, 0]
        states = zip(kept.indices.tolist(), kept.status.tolist(), strict=True)
        again = sum(state == OK and kept.reasons.get(i, "").startswith(FLAKY) for i, state in states)
        lost = len(kept.status) - len(costs)
        return Beside(
            evaluations=self.draws - len(kept.status),
            failed=self.failed - lost,
            timeouts=sum(block.timeouts for block in self.blocks) - int(np.count_nonzero(kept.status == TIMEOUT)),
            excluded=self.excluded,
            violating=self.violations - self.failed - int(np.count_nonzero(costs <= threshold)),
            flaky=sum(block.flaky for block in self.blocks) - again,
            exclusions=dict(self.exclusions),
        )

    @property
    def lowest(self) -> float | None:
        return min((block.lowest for block in self.blocks if block.lowest is not None), default=None)

    @property
    def highest(self) -> float | None:
        return max((block.highest for block in self.blocks if block.highest is not None), default=None)

    @property
    def bins(self) -> Whole:
        return np.asarray(np.sum([block.bins for block in self.blocks], axis=0), dtype=np.int64)

    @property
    def moments(self) -> tuple[float, float] | None:
        """Mean and standard deviation of the costs; None for fewer than two."""
        known = self.evaluated - self.failed
        if known < 2:
            return None
        mean = sum(block.total for block in self.blocks) / known
        spread = sum(block.squares for block in self.blocks) - known * mean * mean
        return self.scale.low + mean, math.sqrt(max(0.0, spread) / (known - 1))


def packed(block: Block) -> bytes:
    """A block as it is stored."""
    filled = np.flatnonzero(block.bins)
    kept = block.kept
    document = {
        **{name: getattr(block, name) for name in _PLAIN},
        "bins": [filled.tolist(), block.bins[filled].tolist()],
        "exclusions": dict(block.exclusions),
        "kept": [_text(kept.indices), _text(kept.points), _text(kept.costs), _text(kept.status)],
        "reasons": {str(index): why for index, why in kept.reasons.items()},
    }
    return zlib.compress(json.dumps(document).encode())


def unpacked(stored: bytes) -> Block:
    """The block that was stored."""
    document = json.loads(zlib.decompress(stored))
    bins: Whole = np.zeros(BINS + 2, dtype=np.int64)
    bins[document["bins"][0]] = document["bins"][1]
    indices, points, costs, status = document["kept"]
    count = len(_array(indices, np.int64))
    return Block(
        **{name: document[name] for name in _PLAIN},
        bins=bins,
        exclusions=document["exclusions"],
        kept=Kept(
            _array(indices, np.int64),
            _array(points, np.float64).reshape(count, -1) if count else np.empty((0, 1)),
            _array(costs, np.float64).reshape(count, -1) if count else np.empty((0, 1)),
            _array(status, np.uint8),
            {int(index): why for index, why in document["reasons"].items()},
        ),
    )


_PLAIN = (
    *("first", "draws", "failed", "timeouts", "excluded", "violations", "total", "squares", "lowest", "highest"),
    *("flaky", "digest", "seconds"),
)


def _text(values: NDArray[Any]) -> str:
    """The bits, little-endian."""
    return base64.b64encode(values.astype(values.dtype.newbyteorder("<")).tobytes()).decode()


def _array(text: str, kind: Any) -> NDArray[Any]:
    return np.frombuffer(base64.b64decode(text), dtype=np.dtype(kind).newbyteorder("<")).astype(kind)
