"""Scenes: run, measure what accuracy costs, choose."""
from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional, TypeVar, Union

import numpy as np

from ._app import PathLike, call, error
from ._text import scene_text, value_text

Scene = Union[str, "os.PathLike[str]", Mapping[str, Any]]
Settings = Optional[Mapping[str, Any]]
_Result = TypeVar("_Result")


class Table(dict):  # type: ignore[type-arg]
    """Labels and values printed by the app; numbers as numbers, several as an array. `str` gives the text as printed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text
        for line in text.splitlines():
            if pair := re.match(r"\s*(\S.*)\s{2,}(\S.*)$", line):
                self[" ".join(pair[1].split())] = _value(pair[2])

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Run:
    """Result of poinsot.run. Arrays are indexed by output, then by body."""

    t: np.ndarray  #: (outputs,) times
    q: np.ndarray  #: (outputs, bodies, 4) attitudes, scalar first
    y: np.ndarray  #: (outputs, bodies, 3) angular momenta, body frame
    kinetic: np.ndarray  #: (outputs, bodies)
    potential: np.ndarray  #: (outputs, bodies)
    energy: np.ndarray  #: (outputs, bodies) the sum of both
    body: np.ndarray  #: (bodies,) their numbers in the scene, from 0
    summary: Table  #: the run's summary: summary["method"], print(summary)
    folder: Optional[Path] = None  #: where its files are, if `out` was given

    def __repr__(self) -> str:
        return f"<poinsot run: {len(self.t)} outputs of {len(self.body)} bodies>"


@dataclass(frozen=True)
class Cost:
    """Result of poinsot.cost."""

    points: np.ndarray  #: a row for each method, splitting and step: points["h"], points["momentum_median"], points["ns_per_time"]
    text: str = field(repr=False)  #: the app's own table
    folder: Optional[Path] = None  #: where the files are, if `out` was given

    @property
    def error(self) -> np.ndarray:
        """Median error of each point: the larger of attitude (radians) and relative momentum."""
        larger: np.ndarray = np.maximum(self.points["angle_median"], self.points["momentum_median"])
        return larger

    def cheapest(self, tolerance: float) -> Optional[np.void]:
        """The row that meets a tolerance in the shortest time; None if there is none."""
        rows = self.points[(self.points["good"] == 1) & (self.error <= tolerance) & (self.points["ns_per_time"] > 0)]
        return rows[rows["ns_per_time"].argmin()] if len(rows) else None

    def __str__(self) -> str:
        return self.text


class Choice(Table):
    """Result of poinsot.choose: choice["method"], choice["splitting"], choice["step h"], choice["error"], ..."""

    scene: str  #: the scene with the choice filled in, for poinsot.run


def run(scene: Scene, *, out: Optional[PathLike] = None, set: Settings = None, threads: Optional[int] = None,
        pictures: bool = False) -> Run:
    """Run a scene.

    Parameters
    ----------
    scene : str, path or dict
        The name of a shipped scene, a file, the text of a namelist, or a dict of its groups:
        ``{"scene": {"t_end": 40, "h": 0.01}, "bodies": {"moments": [1, 2, 2.5], "y": [0, 1, 1]}, "output": {"every": 0.1}}``.
        A repeated group is a list of dicts. docs/scenes.md explains every key. In a text or a dict, give absolute paths of
        files.
    out : path, optional
        Keep the run's files here; without it they are removed after reading.
    set : dict, optional
        Settings that override the scene's own: ``{"scene.h": 0.05, "bodies(2).y": [0, 0, 1]}``.
    threads : int, optional
        Number of threads.
    pictures : bool
        Draw pictures with gnuplot, into `out`.

    Returns
    -------
    Run
        With .t, .q, .y, .energy at the outputs of the scene (none without a group &output), and .summary.

    Raises
    ------
    poinsot.Error
        With the app's message. If the run is complete but its error exceeds the scene's tolerance, it is in .result.
    """
    with _folders(scene, out) as (name, here, results):
        arguments = ["run", name, "--out", str(results), "--quiet", *_settings(set)]
        if threads is not None:
            arguments += ["--threads", str(threads)]
        if not pictures:
            arguments.append("--no-pictures")
        code, _, errors = call(arguments, here)
        if code not in (0, 4):
            raise error(code, errors)
        result = _read_run(results, results if out is not None else None)
        return _judged(code, errors, result)


def cost(scene: Scene, *, out: Optional[PathLike] = None, set: Settings = None, budget: str = "20s",
         methods: Optional[Iterable[str]] = None, splittings: Optional[Iterable[str]] = None,
         tol: Optional[Iterable[float]] = None, states: Optional[int] = None, pictures: bool = False) -> Cost:
    """Measure what accuracy costs in time on a scene: every method in every splitting over a range of step sizes.

    Parameters
    ----------
    scene, out, set, pictures
        As in `run`.
    budget : str
        Limit for the whole study: "20s", "2m".
    methods, splittings : strings
        Only these.
    tol : numbers
        Tolerances of the app's table.
    states : int
        Number of initial states: the scene's own and similar ones.
    """
    with _folders(scene, out) as (name, here, results):
        arguments = ["cost", name, "--out", str(results), "--quiet", "--budget", budget, *_settings(set)]
        for option, value in (("methods", methods), ("splittings", splittings), ("tol", tol)):
            if value is not None:
                arguments += ["--" + option, _listed(value)]
        if states is not None:
            arguments += ["--states", str(states)]
        if not pictures:
            arguments.append("--no-pictures")
        code, _, errors = call(arguments, here)
        if code:
            raise error(code, errors)
        points = np.genfromtxt(results/"cost.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        return Cost(np.atleast_1d(points), (results/"cost.txt").read_text(), results if out is not None else None)


def choose(scene: Scene, tol: Optional[float] = None, *, set: Settings = None, budget: str = "20s",
           methods: Optional[Iterable[str]] = None, splittings: Optional[Iterable[str]] = None) -> Choice:
    """Find the cheapest method, splitting and step size that meet a tolerance at the end of a scene, on this machine.

    Parameters
    ----------
    scene, set
        As in `run`.
    tol : float
        For the attitude in radians and the relative momentum; without it, the scene's own.
    budget : str
        Limit of processor time: "20s", "2m".
    methods, splittings : strings
        Only these.

    Raises
    ------
    poinsot.Error
        If nothing meets the tolerance; the nearest candidate, if any, is then in .result.
    """
    with _folders(scene, None) as (name, here, results):
        chosen = Path(results, "chosen.nml")
        arguments = ["choose", name, "--out", str(chosen), "--budget", budget, *_settings(set)]
        if tol is not None:
            arguments += ["--tol", repr(float(tol))]
        for option, value in (("methods", methods), ("splittings", splittings)):
            if value is not None:
                arguments += ["--" + option, _listed(value)]
        code, output, errors = call(arguments, here)
        if code not in (0, 3, 4):
            raise error(code, errors)
        choice = Choice("\n".join(line for line in output.splitlines() if not line.startswith("written to")))
        choice.scene = chosen.read_text() if chosen.exists() else ""
        return _judged(code, errors or output, choice)


def _judged(code: int, errors: str, result: _Result) -> _Result:
    """The result, or an exception that has it."""
    if code:
        failure = error(code, errors)
        failure.result = result
        raise failure
    return result


@contextmanager
def _folders(scene: Scene, out: Optional[PathLike]) -> Iterator[tuple[str, Optional[str], Path]]:
    """What the app is to call the scene, the folder to call it in, and where it is to write."""
    with tempfile.TemporaryDirectory(prefix="poinsot-") as folder:
        results = Path(folder, "out") if out is None else Path(out).absolute()
        text = scene_text(scene) if isinstance(scene, Mapping) else os.fspath(scene)
        here = None
        if isinstance(scene, Mapping) or (isinstance(scene, str) and re.search(r"^\s*&", scene, re.MULTILINE)):
            name = "scene"
            while Path(folder, name).exists():
                name += "-"
            Path(folder, name).write_text(text)
            text, here = name, folder
        results.mkdir(parents=True, exist_ok=True)
        yield text, here, results


def _settings(settings: Settings) -> list[str]:
    """Settings as the command line has them: texts without quotes."""
    arguments: list[str] = []
    for key, value in (settings or {}).items():
        arguments += ["--set", f"{key}={value if isinstance(value, str) else value_text(value).replace(', ', ',')}"]
    return arguments


def _listed(values: Union[str, float, Iterable[Any]]) -> str:
    if isinstance(values, (str, float, int)):
        return str(values)
    return ",".join(str(v) for v in values)


def _value(text: str) -> Any:
    """A number, several of them as an array, or the text itself."""
    for kind in (int, float, lambda several: np.array([float(x) for x in several.split(", ")])):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _read_run(results: Path, folder: Optional[Path]) -> Run:
    """Trajectory and summary. Its rows go by output, then by body, and every output has the same bodies."""
    file = results/"trajectory.csv"
    rows = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2) if file.exists() else np.empty((0, 12))
    bodies = int(np.count_nonzero(rows[:, 0] == rows[0, 0])) if len(rows) else 0
    table = rows.reshape(-1, max(bodies, 1), 12)
    return Run(t=table[:, 0, 0].copy(), q=table[:, :, 2:6].copy(), y=table[:, :, 6:9].copy(), kinetic=table[:, :, 9].copy(),
               potential=table[:, :, 10].copy(), energy=table[:, :, 11].copy(),
               body=(table[0, :, 1] - 1).astype(int) if len(rows) else np.empty(0, int),
               summary=Table((results/"summary.txt").read_text()), folder=folder)
