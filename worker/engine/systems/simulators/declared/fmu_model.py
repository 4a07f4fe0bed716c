"""Reads what an FMU states about itself: version, binary, variables, default experiment. Runs no code of the FMU."""

from __future__ import annotations

import io
import math
import zipfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any

REALS = ("Real", "Float64")
LARGEST = 1e300
"""Tools write the largest number of the type where there is no limit."""


class Unusable(ValueError):
    """The FMU or its descriptor cannot be used; the message names the key and what is expected."""


@dataclass(frozen=True)
class Variable:
    """A variable of the model; `low`, `high` and `start` are None if it states none that is finite."""

    name: str
    type: str
    reference: int
    causality: str
    variability: str
    scalar: bool
    unit: str
    low: float | None
    high: float | None
    start: float | None
    text: str

    @property
    def settable(self) -> bool:
        """Whether it is a number that a campaign may vary: a parameter, or an input, which stays constant."""
        kinds = (self.causality == "parameter" and self.variability in ("fixed", "tunable"), self.causality == "input")
        return any(kinds) and self.type in REALS and self.scalar


@dataclass(frozen=True)
class Model:
    """What modelDescription.xml states; times in seconds."""

    fmi: int
    version: str
    text: str
    identifier: str
    token: str
    start: float
    stop: float | None
    step: float | None
    tolerance: float | None
    categories: tuple[str, ...]
    """Of its log messages."""
    variables: dict[str, Variable]


@lru_cache(maxsize=64)
def model(file: Path, sha256: str) -> Model:
    """The model of an FMU with this digest; raises Unusable."""
    content = file.read_bytes()
    names = _names(file.name, content)
    try:
        import fmpy
        from fmpy.model_description import read_model_description
    except ImportError as error:
        text = f"fmu: an FMU requires the package FMPy ({error}); install it: pip install 'clearance[fmi]'"
        raise Unusable(text) from None
    try:
        stated = read_model_description(io.BytesIO(content))
    except Exception as error:  # FMPy raises Exception itself
        raise Unusable(f"fmu: {file.name}: {' '.join(str(error).split())[:400]}") from None
    if stated.fmiMajorVersion not in (2, 3):
        raise Unusable(f"fmu: {file.name} is an FMU of FMI {stated.fmiVersion}; 2.0 or 3.0 is expected")
    if stated.coSimulation is None:
        raise Unusable(f"fmu: {file.name} is not made for co-simulation; export it for co-simulation")
    _has_binary(file.name, names, stated, fmpy)
    return _model(stated)


def _names(file: str, content: bytes) -> list[str]:
    """The names in the archive, all of which stay inside the folder that it is extracted to."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError) as error:
        raise Unusable(f"fmu: {file} is not an FMU: {error}") from None
    for name in names:
        if name.startswith("/") or "\\" in name or ":" in name or ".." in PurePosixPath(name).parts:
            raise Unusable(f"fmu: {file} holds a file {name!r}, which is outside its folder; such an FMU is refused")
    if "modelDescription.xml" not in names:
        raise Unusable(f"fmu: {file} is not an FMU: it holds no modelDescription.xml")
    return names


def _has_binary(file: str, names: list[str], stated: Any, fmpy: Any) -> None:
    folder = fmpy.platform if stated.fmiMajorVersion == 2 else fmpy.platform_tuple
    binary = f"binaries/{folder}/{stated.coSimulation.modelIdentifier}{fmpy.sharedLibraryExtension}"
    if binary in names:
        return
    platforms = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
    others = f"it is built for {', '.join(platforms)}" if platforms else "it holds no binary"
    raise Unusable(f"fmu: {file} has no {binary}, the binary for this platform; {others}")


def _model(stated: Any) -> Model:
    experiment = stated.defaultExperiment
    return Model(
        fmi=stated.fmiMajorVersion,
        version=stated.fmiVersion,
        text=stated.description or "",
        identifier=stated.coSimulation.modelIdentifier,
        token=stated.guid,
        start=_finite(getattr(experiment, "startTime", None)) or 0.0,
        stop=_finite(getattr(experiment, "stopTime", None)),
        step=_finite(getattr(experiment, "stepSize", None)),
        tolerance=_finite(getattr(experiment, "tolerance", None)),
        categories=tuple(c.name for c in stated.logCategories),
        variables={v.name: _variable(v) for v in stated.modelVariables},
    )


def _variable(stated: Any) -> Variable:
    """The variable with what its declared type adds."""

    def own(attribute: str) -> Any:
        value = getattr(stated, attribute)
        return value if value is not None else getattr(stated.declaredType, attribute, None)

    return Variable(
        name=stated.name,
        type=stated.type,
        reference=stated.valueReference,
        causality=stated.causality,
        variability=stated.variability,
        scalar=not stated.dimensions,
        unit=own("unit") or "",
        low=_finite(own("min")),
        high=_finite(own("max")),
        start=_finite(stated.start),
        text=" ".join((stated.description or "").split()),
    )


def _finite(text: str | None) -> float | None:
    try:
        value = math.nan if text is None else float(text)
    except ValueError:
        return None
    return value if abs(value) < LARGEST else None
