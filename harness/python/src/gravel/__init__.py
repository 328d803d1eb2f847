"""Contact problems of granular media, solved and measured by the methods of gravel.

    problem = gravel.load("settled-60.json")
    solution = gravel.solve(problem, method="nsgs", tolerance=1e-8, relaxation=1.2)

A problem is a dict of arrays, key by key that of its file: `cases/problem-file.md` of gravel has every key, sign and unit.
Units are SI, x points to the right, y upwards; v = n . (V_candidate - V_antagonist) + c is positive where the two sides of a
contact move apart. Whatever the program would print as an error is a `ValueError` with the same words.
"""

import json
import numbers
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import _native

__all__ = ["Solution", "load", "solve"]

# What files hold as `null`, since no array of integers can: a wall.
WALL = -1


@dataclass(frozen=True, eq=False)
class Solution:
    """What a method found, for g grains and c contacts.

    Two are equal if they ended alike after as many iterations, at the same impulses and velocities; seconds do not count.
    """

    status: str
    """`converged`, or how else it ended: `iteration-limit`, `stalled`, `diverged`, `false-convergence`, `infeasible`."""
    iterations: int
    """Iterations of the method."""
    impulses: np.ndarray
    """r (N s), in the problem's order of contacts: (c,) along the normals, not negative; with friction (c, 2), normal and
    tangential, along t = [-n_y, n_x]; between spheres (c, 3), along the tangents of Duff et al. (2017)."""
    velocities: np.ndarray
    """V (m/s, with friction then rad/s) of each grain at the end of the time step, of the shape of `free_velocity`."""
    relative_velocities: np.ndarray
    """v (m/s) at each contact, of the shape of `impulses`: positive along the normal where a contact opens."""
    residuals: dict
    """Every measure of the last iterate by its name, such as `natural_map` (-), 0 exactly at a solution; NaN where one is not
    defined, as `velocity_error` is without `truth`."""
    curve: dict
    """Columns of the curve: `iteration`, `iterating_s` (s), the residuals, counted work. Of each an array, a sample in each row."""
    told: dict
    """All that `gravel solve --json` prints: settings with their defaults, what they derive, seconds, counted work."""

    def __eq__(self, other):
        if not isinstance(other, Solution):
            return NotImplemented
        arrays = ("impulses", "velocities", "relative_velocities")
        return (self.status, self.iterations) == (other.status, other.iterations) and all(
            np.array_equal(getattr(self, name), getattr(other, name), equal_nan=True) for name in arrays
        )

    __hash__ = None


def solve(
    problem,
    method="active-set",
    *,
    tolerance=1e-6,
    on="natural_map",
    max_iterations=100_000,
    warm_start=False,
    truth=False,
    **settings,
):
    """Solves the contact problem of one time step.

    problem         what `load` gives, a dict of the same keys, or the path (in a checkout also the name) of a file or a case
    method          one of `gravel list methods`; `settings` are its settings, such as relaxation=1.2 or subdomains="4x2"
    tolerance, on   it has converged when this measure is at most the tolerance
    warm_start      begin from `contacts["start"]`, the impulses of the time step before (N s)
    truth           seek the solution first, and measure the distance to it: `residuals["velocity_error"]` (-)

    Returns a `Solution`, whether it converged or not. Ctrl-C raises `KeyboardInterrupt` at once; what the method was at ends
    in the background, with its current iteration.
    """
    text = json.dumps(_listed(problem)) if isinstance(problem, dict) else _native.problem(str(problem), [], None)
    stop = _listed({"on": on, "tolerance": tolerance, "max_iterations": max_iterations})
    if isinstance(stop["max_iterations"], float) and stop["max_iterations"].is_integer():
        stop["max_iterations"] = int(stop["max_iterations"])  # 1e5
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


def load(path, *, scene={}, time_step=None):
    """Reads a problem or stored results.

    A problem, by its path or, in a checkout, its name: a dict of arrays, of numbers a grain or a contact each. Walls are the
    antagonist -1. So is a case at a time step (`time_step`, or one of its moments), with the values that `scene` names replaced:
    load("settled-box", scene={"sample.grains": 250}, time_step=400).

    A folder of results/runs: a dict of data frames, `runs`, `curves` and what else is there by the names of their files, joined
    by the column `run`. A file of these, `.parquet`: one data frame. Of pandas, or else of polars.
    """
    path = Path(path)
    if path.is_dir():
        tables = {file.stem: _frame(file) for file in sorted(path.glob("*.parquet"))}
        if not tables:
            raise ValueError(f"{path}: no study is stored in this folder: it has no tables (.parquet)")
        return tables
    if path.suffix == ".parquet":
        return _frame(path)
    changes = [(key, value if isinstance(value, str) else json.dumps(_listed(value, key))) for key, value in scene.items()]
    problem = json.loads(_native.problem(str(path), changes, None if time_step is None else str(time_step)))
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


def _frame(file):
    """A table of a store, as a data frame of the library that is there."""
    try:
        import pandas
    except ImportError:
        pass
    else:
        return pandas.read_parquet(file)
    try:
        import polars
    except ImportError:
        raise ImportError(f"{file}: pandas with pyarrow, or polars, reads tables; `pip install pandas pyarrow`") from None
    return polars.read_parquet(file)


def _rows(array, each):
    """A row of `each` numbers for every item, unless it is one number."""
    return array if each == 1 else array.reshape(-1, each)


def _listed(value, key=""):
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


def _list_of(array, key):
    """An array as lists of what JSON has."""
    if array.dtype.kind == "O":
        return _listed(array.tolist(), key)
    if array.dtype.kind == "f":
        _check_finite(array, key)
        array = array.astype(float)  # whatever its precision
    elif array.dtype.kind not in "biuU":
        raise ValueError(f"`{key}` is an array of {array.dtype}: it must hold real numbers")
    return array.tolist()


def _check_finite(array, key):
    """Refuses the first number that is none, or is infinite once it has 64 bits."""
    with np.errstate(over="ignore"):
        wrong = np.argwhere(~np.isfinite(array.astype(float)))
    if len(wrong):
        index = tuple(wrong[0])
        place = key + "".join(f"[{k}]" for k in index)
        raise ValueError(f"`{place}` is {array[index]!s}: it must be finite")
