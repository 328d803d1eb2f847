"""Contact problems of granular media, solved and measured by the methods of gravel.

    problem = gravel.load("settled-60.json")
    solution = gravel.solve(problem, method="nsgs", tolerance=1e-8, relaxation=1.2)

A problem is a dict of arrays, key by key that of its file: `cases/problem-file.md` of gravel has every key, sign and unit.
Units are SI, x points to the right, y upwards; v = n . (V_candidate - V_antagonist) + c is positive where the two sides of a
contact move apart. Whatever the program would print as an error is a `ValueError` with the same words.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import _native

__all__ = ["Solution", "load", "solve"]

# What files hold as `null`, since no array of integers can: a wall.
WALL = -1


@dataclass(frozen=True)
class Solution:
    """What a method found. With g grains, c contacts:"""

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

    Returns a `Solution`, whether it converged or not. Ctrl-C ends it after the current iteration.
    """
    text = json.dumps(_listed(problem)) if isinstance(problem, dict) else _native.problem(str(problem), [], None)
    stop = {"on": on, "tolerance": tolerance, "max_iterations": max_iterations}
    request = {"method": method, "settings": settings, "stop": stop, "warm_start": warm_start, "truth": truth}
    told, arrays = _native.solve(text, json.dumps(_listed(request)))
    told = json.loads(told)
    residuals, samples = told.pop("residuals"), told.pop("curve")
    # As many numbers for each contact, and for each grain.
    impulses, velocities, relative = (
        _rows(np.frombuffer(array), told[of]) for array, of in zip(arrays, ("contacts", "grains", "contacts"))
    )
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
    changes = [(key, value if isinstance(value, str) else json.dumps(_listed(value))) for key, value in scene.items()]
    problem = json.loads(_native.problem(str(path), changes, None if time_step is None else str(time_step)))
    for table in ("grains", "contacts"):
        for key, values in problem[table].items():
            problem[table][key] = np.array([WALL if value is None else value for value in values])
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


def _rows(numbers, count):
    """As many numbers for each of `count` items: one row each, unless it is one number."""
    each = len(numbers) // count if count else 1
    return numbers if each == 1 else numbers.reshape(count, each)


def _listed(value, key=None):
    """As JSON has it: lists for arrays, `null` for what is no number and for walls."""
    if isinstance(value, dict):
        return {key: _listed(item, key) for key, item in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_listed(item, key) for item in value]
    if key == "antagonist" and value == WALL or isinstance(value, float) and not np.isfinite(value):
        return None
    return value
