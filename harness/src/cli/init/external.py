"""Projected Gauss-Seidel on a contact problem of discs without friction, in Python alone.

r <- max(0, r - v/w) contact by contact, with v = n . (V_i - V_j) + c, until no v that is negative, and none of a contact that pushes,
is above `tolerance` times the greatest speed.
"""

import json
import sys
import time

problem, tolerance, iterations, answer = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
with open(problem) as file:
    read = json.load(file)
began = time.perf_counter()
grains, contacts = read["grains"], read["contacts"]
mass, velocity = grains["mass"], [list(v) for v in grains["free_velocity"]]
pairs = list(zip(contacts["candidate"], contacts["antagonist"], contacts["normal"], contacts["offset"]))
w = [1 / mass[i] + (0 if j is None else 1 / mass[j]) for i, j, _, _ in pairs]
r = [0.0] * len(pairs)
scale = max((abs(x) for v in velocity for x in v), default=1.0) or 1.0
set_up = time.perf_counter()
sweeps, residual = 0, float("inf")
while residual > tolerance * scale and sweeps < iterations:
    sweeps, residual = sweeps + 1, 0.0
    for k, (i, j, normal, c) in enumerate(pairs):
        v = c + sum(n * x for n, x in zip(normal, velocity[i]))
        v -= 0 if j is None else sum(n * x for n, x in zip(normal, velocity[j]))
        new = max(0.0, r[k] - v / w[k])
        residual = max(residual, abs(new - r[k]) * w[k])
        for grain, sign in ((i, 1), (j, -1)):
            if grain is not None:
                velocity[grain] = [x + sign * n * (new - r[k]) / mass[grain] for x, n in zip(velocity[grain], normal)]
        r[k] = new
ending = "solved" if residual <= tolerance * scale else "iteration limit"
seconds = {"setup_s": set_up - began, "solve_s": time.perf_counter() - set_up}
with open(answer, "w") as file:
    json.dump({"impulse": r, "iterations": sweeps, "ending": ending, **seconds}, file)
