"""What every driver shares: the problem read, the two clocks, the answer written.

Usage of a driver: SCRIPT PROBLEM TOLERANCE ITERATIONS ANSWER [WORD ...]

The problem without units. With M the masses, W_D the diagonal of W = Ht M^-1 H, s^2 = sum max(0, -b)^2 / W_D and

    y = M^1/2 (V - V_free) / s    A = W_D^-1/2 Ht M^-1/2    b' = W_D^-1/2 b / s    r' = W_D^1/2 r / s

the time step is the quadratic programme  min 1/2 |y|^2  subject to  A y + b' >= 0, whose multipliers are r' and whose
solution is y = At r'; and the complementarity problem  0 <= (A At) r' + b'  perpendicular to  r' >= 0. The rows of A have
length 1, |max(0, -b')| = 1, and |r' - max(0, r' - (A At) r' - b')| is gravel's `natural_map`: whatever a code takes its
tolerance for, it is a number without a unit here.

With friction, r, b and V are those of normals and tangents, M has moments of inertia, and there is no programme: what is left
is  v' = (A At) r' + b'  with Coulomb's law between v' and r'. All numbers of a contact are divided by the same, W_D of its
normal, so that the cone |r_t| <= mu r_n is what it was; s is that of the normals.

With the word `units-of-file` W_D and s are 1: W, b and r are then in the units of the file, as someone who gives no thought to
units would hand them over, and so is a tolerance.
"""

import json
import sys
import time

import numpy as np
import scipy.sparse as sparse


class Run:
    """One run: from the files and numbers of the command line to the answer."""

    def __init__(self):
        problem, tolerance, iterations, self.file = sys.argv[1:5]
        self.tolerance, self.iterations, self.words = float(tolerance), int(iterations), sys.argv[5:]
        with open(problem) as file:
            self.problem = json.load(file)
        # The set-up begins once the file is read.
        self.began = time.perf_counter()
        self.set_up = self.took = None

    def unitless(self):
        """A (sparse, by rows: the numbers of each contact x those of the velocity of each grain) and b' (one for each row)."""
        a, b, rows = assembled(self.problem)
        diagonal = np.asarray(a.multiply(a).sum(axis=1)).ravel()
        self.rows, self.root, self.scale = rows, np.ones(len(b)), 1.0
        if "units-of-file" not in self.words:
            self.root = np.repeat(np.sqrt(diagonal[::rows]), rows)
            b /= self.root
            self.scale = np.linalg.norm(np.minimum(b[::rows], 0))
        return sparse.csr_matrix(sparse.diags(1 / self.root) @ a), b / self.scale

    def programme(self):
        """P, q, G and l of  min 1/2 x'P x + q'x  subject to  G x >= l: in y; or, with the word `form-dual`, in r', where G is
        the identity and l is 0."""
        a, b = self.unitless()
        if self.is_dual:
            return (a @ a.T).tocsc(), b, sparse.identity(len(b), format="csc"), np.zeros(len(b))
        return sparse.identity(a.shape[1], format="csc"), np.zeros(a.shape[1]), a.tocsc(), -b

    def in_space(self, rows, order=None):
        """W (sparse, by columns) and b' with so many rows of each contact, in this `order` where it is given, and the places of the problem's
        rows among them. A tangential row that the problem has not is the identity, without a part in the rest."""
        a, b = self.unitless()
        contacts, order = np.arange(len(self.friction)), np.arange(rows) if order is None else np.array(order)
        taken = (rows * contacts[:, None] + order[: self.rows]).ravel()
        shape = (rows * len(contacts), len(taken))
        into = sparse.csr_matrix((np.ones(len(taken)), (taken, np.arange(len(taken)))), shape)
        return (into @ (a @ a.T) @ into.T + sparse.identity(shape[0]) - into @ into.T).tocsc(), into @ b, taken

    @property
    def is_dual(self):
        return "form-dual" in self.words

    @property
    def friction(self):
        """mu of each contact; 0 without friction."""
        contacts = self.problem["contacts"]
        return np.array(contacts.get("friction", np.zeros(len(contacts["candidate"]))))

    def solving(self):
        """Ends the set-up: what follows is the time of the solver."""
        self.set_up, self.began = time.perf_counter() - self.began, time.perf_counter()

    def solved(self):
        """Ends the time of the solver, where its answer is still to be looked for."""
        self.took = time.perf_counter() - self.began

    def answer(self, impulses, iterations, ending="solved"):
        """Writes r', as r. What is outside of the cone by the code's tolerance is taken to its edge: a normal impulse below 0
        to 0, a tangential one that is too long to mu times the normal one."""
        if self.took is None:
            self.solved()
        r = np.array(impulses, dtype=float).reshape(-1, self.rows)
        r[:, 0] = np.maximum(r[:, 0], 0)
        if self.rows > 1:
            length, bound = np.linalg.norm(r[:, 1:], axis=1), self.friction * r[:, 0]
            r[:, 1:] *= (bound / np.where(length > bound, length, np.maximum(bound, 1e-300)))[:, None]
        r = r.ravel() * self.scale / self.root
        answer = {
            "impulse": [float(x) if np.isfinite(x) else None for x in r],
            "iterations": int(iterations),
            "setup_s": self.set_up,
            "solve_s": self.took,
            "ending": str(ending),
        }
        with open(self.file, "w") as file:
            json.dump(answer, file)


def assembled(problem):
    """Of a problem, in the units of its file: Ht M^-1/2 (sparse, by rows: the numbers of each contact x those of the velocity of
    each grain), b (one for each row), and how many rows a contact has."""
    grains, contacts = problem["grains"], problem["contacts"]
    normal, candidate = np.array(contacts["normal"]), np.array(contacts["candidate"])
    antagonist = np.array([-1 if j is None else j for j in contacts["antagonist"]])
    (count, space), rough = normal.shape, "friction" in contacts
    axes = np.stack([normal, *tangents(normal)], axis=1) if rough else normal[:, None]
    root = np.repeat(np.sqrt(np.array(grains["mass"]))[:, None], space, axis=1)
    if rough:
        # n x t, of the spins that a tangent feels: one number in the plane, three in space.
        spin = turned(normal, axes) if space == 2 else np.cross(normal[:, None], axes)
        inertia = np.sqrt(np.array(grains["inertia"]))
        root = np.hstack([root, np.repeat(inertia[:, None], spin.shape[2], axis=1)])
    radius, (rows, width) = np.array(grains["radius"]), (axes.shape[1], root.shape[1])
    values, places = [], []
    for sign, grain in ((1, candidate), (-1, antagonist)):
        there = np.flatnonzero(grain >= 0)
        grain = grain[there]
        side = sign * axes[there]
        if rough:
            side = np.concatenate([side, -radius[grain, None, None] * spin[there]], axis=2)
        values.append((side / root[grain][:, None]).ravel())
        row = np.broadcast_to((rows * there)[:, None, None] + np.arange(rows)[:, None], side.shape)
        column = np.broadcast_to((width * grain)[:, None, None] + np.arange(width), side.shape)
        places.append([row.ravel(), column.ravel()])
    shape = (rows * count, width * len(root))
    a = sparse.csr_matrix((np.concatenate(values), np.concatenate(places, axis=1)), shape=shape)
    b = a @ (root * np.array(grains["free_velocity"])).ravel() + np.array(contacts["offset"]).ravel()
    return a, b, rows


def turned(n, axes):
    """n x t of the plane, for each unit normal and each of its axes."""
    return (n[:, None, 0] * axes[:, :, 1] - n[:, None, 1] * axes[:, :, 0])[:, :, None]


def tangents(n):
    """Of each unit normal: the normal turned anticlockwise; in space those of gravel's problem files, Duff et al. (2017)."""
    if n.shape[1] == 2:
        return [np.stack([-n[:, 1], n[:, 0]], axis=1)]
    x, y, z = n.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return [
        np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=1),
        np.stack([b, sign + y * y * a, -y], axis=1),
    ]
