"""Contact problems of granular media, solved and measured by the methods of gravel, and scenes through time.

    problem = gravel.load("settled-60.json")
    solution = gravel.solve(problem, method="nsgs", tolerance=1e-8, relaxation=1.2)
    simulation = gravel.simulate("my-box.toml", time_steps=400, every=100, contacts=True)

A problem is a dict of arrays, key by key that of its file: `cases/problem-file.md` of gravel has every key, sign and unit.
Units are SI, x points to the right, y upwards; v = n . (V_candidate - V_antagonist) + c is positive where the two sides of a
contact move apart. Whatever the program would print as an error is a `ValueError` with the same words.
"""

from __future__ import annotations

import json
import numbers
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from importlib.metadata import PackageNotFoundError, version
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np

from . import _native, plot

try:
    __version__ = version("gravel")
except PackageNotFoundError:  # a source tree on the path
    __version__ = "unknown"

__all__ = ["Frame", "Simulation", "Solution", "bench", "freeze", "load", "plot", "simulate", "solve", "__version__"]

# What files hold as `null`, since no array of integers can: a wall.
WALL = -1

Problem = dict[str, Any]
Measure = Literal["natural_map", "zeta", "penetration_rate", "quad_dv", "max_dv", "velocity_error"]


@dataclass(frozen=True, eq=False)
class Solution:
    """What a method found, for g grains and c contacts.

    Two are equal if they ended alike after as many iterations, at the same impulses and velocities; seconds do not count.

    status               `converged`, or how else it ended: `iteration-limit`, `stalled`, `diverged`, `false-convergence`,
                         `infeasible`.
    iterations           Iterations of the method.
    impulses             r (N s), in the problem's order of contacts: (c,) along the normals, not negative; with friction (c,
                         2), normal and tangential, along t = [-n_y, n_x]; between spheres (c, 3), along the tangents of Duff
                         et al. (2017).
    velocities           V (m/s, with friction then rad/s) of each grain at the end of the time step, of the shape of
                         `free_velocity`.
    relative_velocities  v (m/s) at each contact, of the shape of `impulses`: positive along the normal where a contact
                         opens.
    residuals            Every measure of the last iterate by its name, such as `natural_map` (-), 0 exactly at a solution;
                         NaN where one is not defined, as `velocity_error` is without `truth`.
    curve                Columns of the curve: `iteration`, `iterating_s` (s), the residuals, counted work. Of each an array,
                         a sample in each row.
    told                 All that `gravel solve --json` prints: settings with their defaults, what they derive, seconds,
                         counted work.
    """

    status: str
    iterations: int
    impulses: np.ndarray
    velocities: np.ndarray
    relative_velocities: np.ndarray
    residuals: dict[str, float]
    curve: dict[str, np.ndarray]
    told: dict[str, Any]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Solution):
            return NotImplemented
        arrays = ("impulses", "velocities", "relative_velocities")
        return (self.status, self.iterations) == (other.status, other.iterations) and all(
            np.array_equal(getattr(self, name), getattr(other, name), equal_nan=True) for name in arrays
        )

    __hash__ = None

    def __repr__(self) -> str:
        map_, (contacts, *_) = self.residuals["natural_map"], self.impulses.shape
        return f"<Solution: {self.status} after {self.iterations} iterations of {self.told['method']}, natural map {map_:.2e}, {contacts} contacts>"

    def _repr_html_(self) -> str:
        rows = {"method": self.told["method"], "status": self.status, "iterations": self.iterations, "contacts": len(self.impulses)}
        return _table({**rows, **{name: f"{value:.3e}" for name, value in self.residuals.items() if not np.isnan(value)}})


@dataclass(frozen=True, eq=False)
class Frame:
    """A moment of a simulation, for b bodies: the grains, and last a lid or driven segments.

    time_step   Time steps since time began.
    time        Time (s).
    radii       (b,) (m).
    masses      (b,) (kg).
    positions   (b, 2), of spheres (b, 3) (m).
    velocities  (b, 2), of spheres (b, 3) (m/s).
    spins       (b,), anticlockwise, of spheres (b, 3) (rad/s); `None` without friction.
    contacts    Columns of the contacts of the time step that led here, each (c,), as `gravel simulate --contacts` writes
                them: `candidate`, `antagonist` (-1: a wall), `body`, `x_m`, `normal_x`, `gap_m`, `normal_impulse_n_s` (N s)
                and others; the normal points from the antagonist to the candidate. `None` where they were not asked for, and
                before the first time step.
    walls       Walls as they are drawn, each by its corners (k, 3) (m): lines of 2 in 2D, faces of 4 in 3D.
    grains      Number of grains, the first of the bodies.
    """

    time_step: int
    time: float
    radii: np.ndarray
    masses: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray | None
    contacts: dict[str, np.ndarray] | None
    walls: list[np.ndarray]
    grains: int

    def __repr__(self) -> str:
        return f"<Frame: time step {self.time_step}, t = {self.time:.6g} s, {len(self.radii)} bodies>"


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scene through time.

    status  `completed`, `interrupted`, `exploded`, `solver-diverged` or `no-solution`.
    reason  The evidence of the explosion, or how many time steps missed the tolerance; empty where all is well.
    is_met  True if the condition `until` ended it; `None` without one.
    series  Columns with a value per time step, each (n,), as `gravel simulate -o` writes them: `time_s` (s), `contacts`,
            `iterations`, `kinetic_energy_j` (J), `mean_height_m` (m), `floor_impulse_n_s` (N s) and others; NaN where one is
            not defined.
    frames  The first moment, and every `every`-th and the last time step.
    told    Method, settings with their defaults, and `totals` of all time steps: iterations, seconds, counted work, energies
            (J).
    """

    status: str
    reason: str
    is_met: bool | None
    series: dict[str, np.ndarray]
    frames: list[Frame]
    told: dict[str, Any]

    def __repr__(self) -> str:
        end = self.frames[-1]
        return f"<Simulation: {self.status} at time step {end.time_step}, t = {end.time:.6g} s, {len(end.radii)} bodies, {len(self.frames)} frames>"

    def _repr_html_(self) -> str:
        end, totals = self.frames[-1], self.told["totals"]
        rows = {"method": self.told["method"], "status": self.status, "reason": self.reason or "–", "time (s)": f"{end.time:.6g}"}
        counts = {"time steps": totals["time_steps"], "of them missed": totals["missed_time_steps"], "iterations": totals["iterations"]}
        return _table({**rows, **counts, "bodies": len(end.radii), "frames": len(self.frames)})


def _table(rows: Mapping[str, Any]) -> str:
    cells = "".join(f"<tr><th>{escape(str(name))}</th><td>{escape(str(value))}</td></tr>" for name, value in rows.items())
    return f"<table>{cells}</table>"


def solve(
    problem: Problem | str | PathLike[str],
    method: str | None = None,
    *,
    tolerance: float = 1e-6,
    on: Measure = "natural_map",
    max_iterations: int = 100_000,
    warm_start: bool = False,
    truth: bool = False,
    **settings: Any,
) -> Solution:
    """Solves the contact problem of one time step.

    problem         what `load` gives, a dict of the same keys, or the path (in a checkout also the name) of a file or a case
    method          one of `gravel list methods`, without it active-set; `settings` are its settings, such as
                    relaxation=1.2 or subdomains="4x2"
    tolerance, on   it has converged when this measure is at most the tolerance
    warm_start      begin from `contacts["start"]`, the impulses of the time step before (N s)
    truth           seek the solution first, and measure the distance to it: `residuals["velocity_error"]` (-)

    Returns a `Solution`, whether it converged or not. Ctrl-C raises `KeyboardInterrupt` at once; what the method was at ends
    in the background, with its current iteration. A `ValueError` names what has no meaning by its key.
    """
    if not isinstance(problem, (dict, str, PathLike)):
        raise TypeError(f"`problem` is {problem!r}: it is a dict as `load` gives it, or the path or name of a file")
    text = json.dumps(_listed(problem)) if isinstance(problem, dict) else _native.problem(str(problem), [], None)
    stop = _stop(on, tolerance, max_iterations)
    request = {"method": method, "settings": _listed(settings), "stop": stop, "warm_start": warm_start, "truth": truth}
    told, arrays, each = _native.solve(text, json.dumps(_listed(request)))
    told = json.loads(told)
    residuals, samples = told.pop("residuals"), told.pop("curve")
    impulses, velocities, relative = (_rows(np.frombuffer(array), width) for array, width in zip(arrays, each))
    return Solution(
        status=told["status"],
        iterations=told["iterations"],
        impulses=impulses,
        velocities=velocities,
        relative_velocities=relative,
        residuals={key: np.nan if value is None else value for key, value in residuals.items()},
        curve={key: np.array([sample[key] for sample in samples], dtype=float) for key in samples[0]},
        told=told,
    )


def simulate(
    case: str | PathLike[str],
    time_steps: int,
    *,
    method: str | None = None,
    scene: Mapping[str, Any] | None = None,
    tolerance: float = 1e-6,
    on: Measure = "natural_map",
    max_iterations: int = 100_000,
    start: Literal["nothing", "previous", "extrapolated"] = "previous",
    every: int | None = None,
    contacts: bool = False,
    until: Literal["at-rest", "steady"] | None = None,
    over: float | None = None,
    restart: str | PathLike[str] | None = None,
    state: str | PathLike[str] | None = None,
    progress: bool | Callable[[Frame], Any] = False,
    **settings: Any,
) -> Simulation:
    """Marches a case through time.

    case            a case: the path of its file, or in a checkout its name
    time_steps      the number of time steps, with `restart` of further ones
    method          one of `gravel list methods`, without it active-set; `settings` are its settings
    scene           values of the case to replace: scene={"sample.grains": 250, "scene.friction": 0.3}
    tolerance, on, max_iterations
                    each time step is solved until this measure is at most the tolerance (-), or so many iterations are made
    start           initial impulses of each: none, those of the time step before, or those of the last two extrapolated
    every           a frame for every so many time steps, besides the first and the last
    contacts        True adds the contacts with their impulses (N s) to each frame
    until, over     end before, once the packing is at rest or its flow is steady, judged over so many seconds: `cases/simulation-file.md`
    restart, state  the file of a state to resume from, bitwise as if it had not stopped; and one to write the last state to
    progress        True prints a line per frame; a function is called with each

    Returns a `Simulation`, also of a scene that explodes. Ctrl-C raises `KeyboardInterrupt`, once the state has been written if one was
    asked for. A `ValueError` names what has no meaning by its file, key and value.
    """
    for name, count in (("time_steps", time_steps), ("every", every)):
        if count is not None and not (isinstance(count, numbers.Integral) and count > 0):
            raise ValueError(f"`{name}` is {count!r}: it must be a whole number, and positive")
    request = {"method": method, "settings": _listed(settings), "stop": _stop(on, tolerance, max_iterations), "start": start}
    request |= {"until": until, "over": None if over is None else _listed(over, "over")}
    files = [None if file is None else Path(file) for file in (restart, state)]
    march = _native.March(str(case), _changes(scene), json.dumps(_listed(request)), *files)
    for warning in march.warnings():
        warnings.warn(f"{case}: {warning}", stacklevel=2)
    frames, parts, left = [_frame_of(march, None)], [], int(time_steps)
    told: dict[str, Any] = {}
    report = print if progress is True else progress or (lambda frame: None)
    try:
        while left > 0:
            now = min(left, every or left)
            told, series, found = march.advance(now, contacts)
            told = json.loads(told)
            parts.append(_columns(series))
            frames.append(_frame_of(march, _columns(found) if contacts else None))
            report(frames[-1])
            left -= now
            if told["status"] != "completed" or told["is_met"]:
                break
    finally:
        if told.get("status", "completed") == "completed":
            march.save()
    series = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    status, reason, is_met = (told.pop(key) for key in ("status", "reason", "is_met"))
    return Simulation(status=status, reason=reason, is_met=is_met, series=series, frames=frames, told=told)


def freeze(
    case: str | PathLike[str],
    output: str | PathLike[str],
    *,
    time_step: int | str | None = None,
    scene: Mapping[str, Any] | None = None,
) -> Problem:
    """Writes the contact problem of a case at a time step as a file, and returns it as `load` does.

    time_step  counted from 1, or one of the case's moments; without it the one that the case names
    scene      values of the case to replace

    A `ValueError` says what is wrong, as where the file is there.
    """
    _native.freeze(str(case), _changes(scene), None if time_step is None else str(time_step), Path(output))
    return load(output)


def bench(
    plan: str | PathLike[str],
    *,
    quick: bool = False,
    only: Mapping[str, str] | None = None,
    settings: Mapping[str, Any] | None = None,
    jobs: int = 1,
    repeats: int | None = None,
) -> dict[str, Any]:
    """Runs what a plan asks for and its store in the checkout lacks; prints what it does; draws its page; and returns its tables, as `load` does.

    plan      its name in the checkout, or the path of its file
    quick     the quick form of the plan
    only      runs with this problem, method or variant alone: only={"method": "nsgs*"}
    settings  settings of every method that has them, in place of the plan's
    jobs      runs at a time: above 1 seconds are not taken alone
    repeats   runs of each, whose median of seconds counts

    Ctrl-C raises `KeyboardInterrupt`; the runs that had ended are kept, and the same call goes on.
    """
    arguments = [str(plan), "--jobs", str(jobs)] + ["--quick"] * quick
    arguments += [] if repeats is None else ["--repeats", str(repeats)]
    for option, pairs in (("--only", only), ("--set", settings)):
        for key, value in (pairs or {}).items():
            arguments += [option, f"{key}={value if isinstance(value, str) else json.dumps(_listed(value, key))}"]
    return load(_native.bench(arguments))


def load(path: str | PathLike[str], *, scene: Mapping[str, Any] | None = None, time_step: int | str | None = None) -> Any:
    """Reads a problem or stored results.

    A problem, by its path or, in a checkout, its name: a dict of arrays, of numbers a grain or a contact each. Walls are the
    antagonist -1. So is a case at a time step (`time_step`, or one of its moments), with the values that `scene` names replaced:
    load("settled-box", scene={"sample.grains": 250}, time_step=400).

    A folder of results/runs: a dict of data frames, `runs`, `curves` and what else is there by the names of their files, joined
    by the column `run`. A table of these, `.parquet`, or of contacts, `.parquet` or `.csv`: one data frame. Of pandas, or else of polars.
    Settings are columns of their own, such as `settings.relaxation`, empty where a row has none.
    """
    path = Path(path)
    if path.is_dir():
        tables = {file.stem: _frame(file) for file in sorted(path.glob("*.parquet"))}
        if not tables:
            raise ValueError(f"{path}: no study is stored in this folder: it has no tables (.parquet)")
        return tables
    if path.suffix in (".parquet", ".csv"):
        return _frame(path)
    problem = json.loads(_native.problem(str(path), _changes(scene), None if time_step is None else str(time_step)))
    for table in ("grains", "contacts"):
        for key, values in problem[table].items():
            values = [WALL if value is None else value for value in values]
            problem[table][key] = np.array(values, dtype=int if key in ("candidate", "antagonist") else float)
    # Without contacts lists do not tell their width.
    vectors = ("normal", "tangent", "offset", "start") if "friction" in problem["contacts"] else ("normal",)
    for key in vectors:
        if key in problem["contacts"] and problem["contacts"][key].size == 0:
            problem["contacts"][key] = np.empty((0, problem["grains"]["position"].shape[-1]))
    return problem


def _frame(file: Path) -> Any:
    """A table, as a data frame of the library that is there, with its settings as columns."""
    read = "read_csv" if file.suffix == ".csv" else "read_parquet"
    try:
        import pandas
    except ImportError:
        pass
    else:
        return _flat(getattr(pandas, read)(file), lambda column: pandas.Series(column, dtype=object).infer_objects())
    try:
        import polars
    except ImportError:
        raise ImportError(f"{file}: pandas with pyarrow, or polars, reads tables; `pip install pandas pyarrow`") from None
    return _flat(getattr(polars, read)(file), lambda column: polars.Series(column, strict=False))


# Columns of stored tables that hold settings as JSON.
_SETTINGS = ("settings", "problem_settings", "scene_settings")


def _flat(table: Any, column_of: Callable[[list[Any]], Any]) -> Any:
    """The table with a column for each setting in place of their JSON."""
    for name in _SETTINGS:
        if name not in table.columns:
            continue
        rows = [json.loads(text) if text else {} for text in table[name]]
        keys = list(dict.fromkeys(key for row in rows for key in row))
        added = {f"{name}.{key}": column_of([_plain(row.get(key)) for row in rows]) for key in keys}
        if hasattr(table, "assign"):
            table = table.drop(columns=name).assign(**added)
        else:
            table = table.drop(name).with_columns(**added)
    return table


def _plain(value: Any) -> Any:
    """A setting as a cell: lists and tables stay as JSON."""
    return json.dumps(value) if isinstance(value, (dict, list)) else value


def _changes(scene: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    return [(key, value if isinstance(value, str) else json.dumps(_listed(value, key))) for key, value in (scene or {}).items()]


def _stop(on: str, tolerance: float, max_iterations: int) -> dict[str, Any]:
    listed = _listed({"on": on, "tolerance": tolerance, "max_iterations": max_iterations})
    if isinstance(listed["max_iterations"], float) and listed["max_iterations"].is_integer():
        listed["max_iterations"] = int(listed["max_iterations"])  # 1e5
    return listed


def _columns(table: list[tuple[str, Any]]) -> dict[str, np.ndarray]:
    return {
        name: np.array(values, dtype=object) if isinstance(values, list) else np.frombuffer(values[0], dtype=values[1])
        for name, values in table
    }


def _frame_of(march: Any, contacts: dict[str, np.ndarray] | None) -> Frame:
    """The moment that a march is at."""
    arrays, (size, of_spin, grains) = march.bodies()
    radii, masses, positions, velocities, spins = (np.frombuffer(array) for array in arrays)
    (time_step, time), vectors = march.time(), (positions.reshape(-1, size), velocities.reshape(-1, size))
    return Frame(
        time_step, time, radii, masses, *vectors, spins=None if of_spin == 0 else _rows(spins, of_spin), contacts=contacts,
        walls=[np.array(corners) for corners in march.walls()], grains=grains,
    )


def _rows(array: np.ndarray, each: int) -> np.ndarray:
    """A row of `each` numbers for every item, unless it is one number."""
    return array if each == 1 else array.reshape(-1, each)


def _listed(value: Any, key: str = "") -> Any:
    """As JSON has it: lists for arrays, and for whatever becomes one, such as a pandas Series; `null` for walls. `key` says where it
    stands."""
    if value is None or isinstance(value, (str, bool, np.bool_)):
        return bool(value) if isinstance(value, np.bool_) else value
    if isinstance(value, dict):
        return {name: _listed(item, f"{key}.{name}" if key else name) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        listed = [_listed(item, f"{key}[{index}]") for index, item in enumerate(value)]
    elif isinstance(value, numbers.Integral):
        return int(value)
    elif isinstance(value, numbers.Real):
        _check_finite(np.asarray(value), key)
        return float(value)
    elif hasattr(value, "__array__"):
        listed = _list_of(np.asarray(value), key)
    else:
        raise ValueError(f"`{key}` is {value!r}: it must be a number, a text, true or false, or an array of these")
    if key == "contacts.antagonist":
        listed = [None if item == WALL else item for item in listed]
    return listed


def _list_of(array: np.ndarray, key: str) -> Any:
    """An array as lists of what JSON has."""
    if array.dtype.kind == "O":
        return _listed(array.tolist(), key)
    if array.dtype.kind == "f":
        _check_finite(array, key)
        array = array.astype(float)  # whatever its precision
    elif array.dtype.kind not in "biuU":
        raise ValueError(f"`{key}` is an array of {array.dtype}: it must hold real numbers")
    return array.tolist()


def _check_finite(array: np.ndarray, key: str) -> None:
    """Refuses the first number that is none, or is infinite once it has 64 bits."""
    with np.errstate(over="ignore"):
        wrong = np.argwhere(~np.isfinite(array.astype(float)))
    if len(wrong):
        index = tuple(wrong[0])
        place = key + "".join(f"[{k}]" for k in index)
        raise ValueError(f"`{place}` is {array[index]!s}: it must be finite")
