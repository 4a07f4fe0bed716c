"""The text format of Prometheus, version 0.0.4: a type and a help line for each metric, then its samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"


@dataclass(frozen=True)
class Sample:
    """One line: a name, a number and labels."""

    name: str
    value: float
    labels: Mapping[str, str] = field(default_factory=dict)

    def line(self) -> str:
        labels = ",".join(f'{name}="{_escaped(value)}"' for name, value in self.labels.items())
        return f"{self.name}{f'{{{labels}}}' if labels else ''} {self.value:.12g}"


@dataclass(frozen=True)
class Metric:
    """A metric with its samples."""

    name: str
    kind: Literal["gauge", "histogram"]
    help: str
    samples: Iterable[Sample]

    def text(self) -> str:
        head = f"# HELP {self.name} {self.help}\n# TYPE {self.name} {self.kind}\n"
        return head + "".join(f"{sample.line()}\n" for sample in self.samples)


def gauge(name: str, text: str, value: float | None) -> Metric:
    """A metric with one sample; without any if the value is not known."""
    return Metric(name, "gauge", text, [] if value is None else [Sample(name, value)])


def gauges(name: str, text: str, label: str, values: Mapping[str, float]) -> Metric:
    """A metric with one sample for each value of a label."""
    return Metric(name, "gauge", text, [Sample(name, value, {label: key}) for key, value in values.items()])


def _escaped(value: str) -> str:
    return value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
