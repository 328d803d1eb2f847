"""What every driver shares: the problem read, the two clocks, the answer written.

Usage of a driver: SCRIPT PROBLEM TOLERANCE ITERATIONS ANSWER [WORD ...]

The problem without units. With M the masses, W_D the diagonal of W = Ht M^-1 H, s^2 = sum max(0, -b)^2 / W_D and

    y = M^1/2 (V - V_free) / s    A = W_D^-1/2 Ht M^-1/2    b' = W_D^-1/2 b / s    r' = W_D^1/2 r / s

the time step is the quadratic programme  min 1/2 |y|^2  subject to  A y + b' >= 0, whose multipliers are r' and whose
solution is y = At r'; and the complementarity problem  0 <= (A At) r' + b'  perpendicular to  r' >= 0. The rows of A have
length 1, |max(0, -b')| = 1, and |r' - max(0, r' - (A At) r' - b')| is gravel's `natural_map`: whatever a code takes its
tolerance for, it is a number without a unit here.
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
        self.set_up = None

    def unitless(self):
        """A (a sparse matrix by rows: contacts x 2 grains) and b' (one number a contact)."""
        grains, contacts = self.problem["grains"], self.problem["contacts"]
        root = np.sqrt(np.array(grains["mass"]))
        normal, candidate = np.array(contacts["normal"]), np.array(contacts["candidate"])
        none = len(root)
        antagonist = np.array([none if j is None else j for j in contacts["antagonist"]])
        count = np.arange(len(candidate))
        touched = np.flatnonzero(antagonist != none)
        grain = np.concatenate([candidate, antagonist[touched]])
        side = np.concatenate([normal, -normal[touched]]) / root[grain][:, None]
        contact = np.concatenate([count, touched])
        entries = (side.ravel(), (np.repeat(contact, 2), np.stack([2 * grain, 2 * grain + 1], axis=1).ravel()))
        a = sparse.csr_matrix(entries, shape=(len(count), 2 * none))
        free = (root[:, None] * np.array(grains["free_velocity"])).ravel()
        b = a @ free + np.array(contacts["offset"])
        self.root = np.sqrt(np.asarray(a.multiply(a).sum(axis=1)).ravel())
        b /= self.root
        self.scale = np.linalg.norm(np.minimum(b, 0))
        return sparse.csr_matrix(sparse.diags(1 / self.root) @ a), b / self.scale

    def solving(self):
        """Ends the set-up: what follows is the time of the solver."""
        self.set_up, self.began = time.perf_counter() - self.began, time.perf_counter()

    def answer(self, impulses, iterations, ending="solved"):
        """Writes r', as r, and ends the program. A multiplier that is negative by the code's tolerance is 0."""
        solving = time.perf_counter() - self.began
        r = np.maximum(np.asarray(impulses, dtype=float), 0) * self.scale / self.root
        answer = {
            "impulse": [float(x) if np.isfinite(x) else None for x in r],
            "iterations": int(iterations),
            "setup_s": self.set_up,
            "solve_s": solving,
            "ending": str(ending),
        }
        with open(self.file, "w") as file:
            json.dump(answer, file)
