"""Figures of packings and of convergence, by Matplotlib, which must be installed. Each takes axes, or makes some, and returns them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from . import Frame, Solution

__all__ = ["convergence", "packing"]

# Seen from the front, spheres are drawn as discs, the farthest first.
_PLANE = (0, 1)


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ImportError("figures need Matplotlib: `pip install matplotlib`") from None
    return plt.subplots()[1]


def packing(
    of: Mapping[str, Any] | Frame,
    solution: Solution | np.ndarray | None = None,
    *,
    ax: Axes | None = None,
    colour: np.ndarray | None = None,
    chains: bool = True,
    cmap: str = "viridis",
) -> Axes:
    """Draws grains, and force chains as lines between their centres whose widths grow with the normal impulses.

    of        a problem, as `load` gives it, or a frame of a simulation
    solution  a `Solution` of that problem, or its impulses (N s); a frame holds those of its own, where it was asked for contacts
    colour    a number for each grain, by which it is coloured
    chains    False draws grains alone

    x points to the right and y upwards (m). Spheres are drawn as seen from the front, along z.
    """
    from matplotlib.collections import EllipseCollection, LineCollection

    axes = _axes(ax)
    if isinstance(of, Mapping):
        grains = of["grains"]
        place, radius = np.asarray(grains["position"], float), np.asarray(grains["radius"], float)
        lines, impulses = _of_problem(of, solution, place, radius)
        walls: Sequence[np.ndarray] = ()
    else:
        place, radius, walls = of.positions[: of.grains], of.radii[: of.grains], of.walls
        lines, impulses = _of_frame(of, place, radius)
    order = np.argsort(place[:, 2], kind="stable") if place.shape[1] > 2 else np.arange(len(place))
    sizes = 2 * radius[order]
    faces = {"facecolors": "0.9"} if colour is None else {"array": np.asarray(colour, float)[order], "cmap": cmap}
    discs = EllipseCollection(
        sizes, sizes, np.zeros(len(order)), units="x", offsets=place[order][:, _PLANE],
        offset_transform=axes.transData, edgecolors="0.5", linewidths=0.5, **faces,
    )
    axes.add_collection(discs)
    if chains and len(lines):
        greatest = impulses.max(initial=0.0)
        pushing = impulses > 1e-3 * greatest
        # The widest line is as wide as a grain of mean size.
        widths = 4.0 * impulses[pushing] / greatest if greatest > 0 else []
        axes.add_collection(LineCollection(lines[pushing], linewidths=widths, colors="C3", capstyle="round"))
    if len(walls):
        axes.add_collection(LineCollection([corners[:, _PLANE] for corners in walls], colors="0.2", linewidths=1.0))
    axes.set_aspect("equal")
    room = radius.max()
    axes.set_xlim((place[:, 0] - radius).min() - room, (place[:, 0] + radius).max() + room)
    axes.set_ylim((place[:, 1] - radius).min() - room, (place[:, 1] + radius).max() + room)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    return axes


def _of_problem(problem: Mapping[str, Any], solution: Any, place: np.ndarray, radius: np.ndarray):
    """Lines (c, 2, 2) between the centres, or to a wall, and normal impulses (c,) of a problem."""
    if solution is None:
        return np.empty((0, 2, 2)), np.empty(0)
    contacts = problem["contacts"]
    i, j = np.asarray(contacts["candidate"], int), np.asarray(contacts["antagonist"], int)
    impulses = np.asarray(getattr(solution, "impulses", solution), float)
    if len(impulses) != len(i):
        raise ValueError(f"`solution` has {len(impulses)} impulses: the problem has {len(i)} contacts")
    normal = np.asarray(contacts["normal"], float)
    reach = radius[i] + np.asarray(contacts["gap"], float)
    return _lines(place, i, j, place[i] - normal * reach[:, None]), impulses.reshape(len(i), -1)[:, 0]


def _of_frame(frame: Frame, place: np.ndarray, radius: np.ndarray):
    """Lines and normal impulses of a frame."""
    if not frame.contacts:
        return np.empty((0, 2, 2)), np.empty(0)
    # Guides of a lid press no grain.
    is_drawn = frame.contacts["body"] != "guide"
    contacts = {name: column[is_drawn] for name, column in frame.contacts.items()}
    normal = np.stack([contacts[f"normal_{axis}"] for axis in "xyz"[: place.shape[1]]], axis=1)
    point = np.stack([contacts[f"{axis}_m"] for axis in "xyz"[: place.shape[1]]], axis=1)
    i, is_grain = contacts["candidate"], contacts["body"] == "grain"
    # As far as the nearest image of the other grain, where the scene is periodic.
    reach = radius[i] + contacts["gap_m"] + radius[np.where(is_grain, contacts["antagonist"], 0)]
    end = np.where(is_grain[:, None], place[i] - normal * reach[:, None], point - normal * contacts["gap_m"][:, None])
    return np.stack([place[i], end], axis=1)[:, :, _PLANE], contacts["normal_impulse_n_s"]


def _lines(place: np.ndarray, i: np.ndarray, j: np.ndarray, at_wall: np.ndarray) -> np.ndarray:
    end = np.where((j >= 0)[:, None], place[j], at_wall)
    return np.stack([place[i], end], axis=1)[:, :, _PLANE]


def convergence(
    solutions: Solution | Sequence[Solution] | Mapping[str, Solution],
    *,
    measure: str = "natural_map",
    against: str = "iteration",
    ax: Axes | None = None,
) -> Axes:
    """Draws a residual of each iterate, on logarithmic axes.

    solutions  one `Solution`, several, or a dict of them by their labels
    measure    a column of their curves, such as `natural_map` or `velocity_error` (-)
    against    another: `iteration`, `iterating_s` (s) or counted work
    """
    axes = _axes(ax)
    if not isinstance(solutions, Mapping):
        listed = list(solutions) if isinstance(solutions, (list, tuple)) else [solutions]
        solutions = {f"{k + 1}: {one.told['method']}" if len(listed) > 1 else one.told["method"]: one for k, one in enumerate(listed)}
    for label, solution in solutions.items():
        for column in (measure, against):
            if column not in solution.curve:
                raise ValueError(f"`{column}` is no column of a curve: {', '.join(solution.curve)}")
        axes.plot(solution.curve[against], solution.curve[measure], label=label, drawstyle="steps-post")
    axes.set_xscale("symlog", linthresh=1) if against == "iteration" else axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("iterations" if against == "iteration" else against)
    axes.set_ylabel(measure.replace("_", " ") + " (–)")
    if len(solutions) > 1:
        axes.legend()
    return axes
