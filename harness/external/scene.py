"""What a code that makes its own contacts is handed: where the grains of a problem must be, and how far what it makes of them is
from the problem. Numbers only, so that it is tested without any such code."""

import sys

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from driver import assembled


def placed(problem):
    """Positions of the grains (m) at which every contact between two of them has the problem's normal and gap, and the greatest
    distance by which one misses that (m).

    `grains.position` need not be them: in problems of codes that find contacts within the time step it is where the grains are
    at its start, which no rule of ours uses. The differences x_i - x_j = (r_i + r_j + gap) n of all contacts are solved for x in
    least squares, by the Laplacian of the graph of contacts; what they leave open is kept from `grains.position`.
    """
    grains, contacts = problem["grains"], problem["contacts"]
    x, radius = np.array(grains["position"], dtype=float), np.array(grains["radius"])
    pairs = [(k, i, j) for k, (i, j) in enumerate(zip(contacts["candidate"], contacts["antagonist"])) if j is not None]
    if not pairs:
        return x, 0.0
    k, i, j = np.array(pairs).T
    d = (radius[i] + radius[j] + np.array(contacts["gap"])[k])[:, None] * np.array(contacts["normal"])[k]
    rows, signs = np.arange(len(k)), np.ones(len(k))
    b = sparse.csr_matrix(
        (np.concatenate([signs, -signs]), (np.concatenate([rows, rows]), np.concatenate([i, j]))), (len(k), len(x))
    )
    _, group = sparse.csgraph.connected_components(b.T @ b, directed=False)
    # One grain of each group stays, then the group moves as a whole: on average it stays.
    groups, first = np.unique(group, return_index=True)
    fixed = sparse.csr_matrix((np.ones(len(groups)), (groups, first)), (len(groups), len(x)))
    laplacian = (b.T @ b + fixed.T @ fixed).tocsc()
    solve = scipy.sparse.linalg.factorized(laplacian)
    shift = np.zeros_like(x)
    # Twice, since the first leaves round-off.
    for _ in range(2):
        left = d - b @ (x + shift)
        step = np.stack([solve(column) for column in (b.T @ left).T], axis=1)
        mean = np.stack([np.bincount(group, column) for column in step.T], axis=1) / np.bincount(group)[:, None]
        shift += step - mean[group]
    return x + shift, float(np.abs(d - b @ (x + shift)).max())


def in_14_characters(x):
    """A number with as many decimals as a field of 14 characters has room for."""
    return f"{x:14.{max(0, 13 - len(f'{x:.0f}'))}f}"


def rounded(problem, position, density, written=in_14_characters):
    """The problem of discs that are in a file at these positions (m), of these densities (kg/m2), with all numbers as `written`: normals
    between two of them are those of the positions, and offsets those of their gaps there; with a wall both are the problem's, since walls
    are placed by them."""
    shown = np.vectorize(lambda x: float(written(x)), otypes=[float])
    grains, contacts = problem["grains"], problem["contacts"]
    x, radius = shown(position), shown(np.array(grains["radius"]))
    mass = np.pi * radius**2 * shown(density)
    normal, offset = np.array(contacts["normal"]), np.array(contacts["offset"], dtype=float)
    offset = offset.reshape(len(normal), -1)
    for k, (i, j) in enumerate(zip(contacts["candidate"], contacts["antagonist"])):
        if j is not None:
            distance = np.linalg.norm(x[i] - x[j])
            normal[k] = (x[i] - x[j]) / distance
            offset[k, 0] = max(0.0, distance - radius[i] - radius[j]) / problem["time_step"]
    grains = {**grains, "mass": mass, "radius": radius, "free_velocity": shown(np.array(grains["free_velocity"]))}
    if "inertia" in grains:
        grains["inertia"] = 0.5 * mass * radius**2
    contacts = {**contacts, "normal": normal, "offset": offset.ravel()}
    return {**problem, "grains": grains, "contacts": contacts}


def difference(problem, handed):
    """How far a problem with as many contacts is from this one, without units: the distance of the two b, the greatest difference
    of an entry of W, and for each the contact where it is greatest."""
    (a, b, rows), (other, c, _) = assembled(problem), assembled(handed)
    diagonal = np.asarray(a.multiply(a).sum(axis=1)).ravel()
    root = np.repeat(np.sqrt(diagonal[::rows]), rows)
    scaled = sparse.diags(1 / root)
    apart = abs(scaled @ (a @ a.T - other @ other.T) @ scaled).tocoo()
    of_b = (b - c) / root / np.linalg.norm(np.minimum(b / root, 0)[::rows])
    of_w = (float(apart.data.max()), int(apart.row[apart.data.argmax()]) // rows) if apart.nnz else (0.0, 0)
    return {"b": (float(np.linalg.norm(of_b)), int(abs(of_b).argmax()) // rows), "W": of_w}


def refuse(problem, handed, tolerance, code):
    """Ends the program if what a code is handed is another problem, by more than the tolerance that is asked of it."""
    for what, (apart, contact) in difference(problem, handed).items():
        if not apart <= tolerance:
            sys.exit(
                f"{code} is handed another problem: its `{what}` differs by {apart:.1e}, most at contact {contact}, where the "
                f"tolerance is {tolerance:.1e}"
            )
