"""Siconos: the complementarity problem in r', or contacts in the plane (`fc2d`) and in space (`fc3d`), with friction or one of 0."""

import warnings

import numpy as np
import siconos.numerics as numerics
from driver import Run

# Siconos turns the 32 bits of SciPy's indices into 64 by itself.
warnings.simplefilter("ignore")

# Name: the constant of Siconos, how W is stored.
SOLVERS = {
    "lcp-pgs": ("LCP_PGS", "csc"),
    "lcp-lemke": ("LCP_LEMKE", "dense"),
    "lcp-latin": ("LCP_LATIN", "dense"),
    "lcp-newton-min": ("LCP_NEWTON_MIN_FBLSA", "dense"),
    "lcp-newton-fb": ("LCP_NEWTON_FB_FBLSA", "dense"),
    "lcp-avi": ("LCP_AVI_CAOFERRIS", "dense"),
    "fc2d-cpg": ("FRICTION_2D_CPG", "dense"),
    "fc2d-lemke": ("FRICTION_2D_LEMKE", "dense"),
    "fc2d-nsgs": ("FRICTION_2D_NSGS", "dense"),
    "fc3d-nsgs": ("FRICTION_3D_NSGS", "csc"),
    "fc3d-nsn-ac": ("FRICTION_3D_NSN_AC", "csc"),
    "fc3d-prox": ("FRICTION_3D_PROX", "csc"),
    "fc3d-admm": ("FRICTION_3D_ADMM", "csc"),
}

run = Run()
kind, (name, storage) = run.words[0].split("-")[0], SOLVERS[run.words[0]]
rows = {"lcp": 1, "fc2d": 2, "fc3d": 3}[kind]
w, b, taken = run.in_space(rows)
w = w.toarray() if storage == "dense" else w
options = numerics.SolverOptions(getattr(numerics, "SICONOS_" + name))
options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = run.iterations
options.dparam[numerics.SICONOS_DPARAM_TOL] = run.tolerance
r, v = np.zeros(len(b)), np.zeros(len(b))
if kind == "lcp":
    problem, solve = numerics.LCP(w, b), numerics.linearComplementarity_driver
else:
    problem = numerics.FrictionContactProblem(rows, w, b, run.friction)
    solve = numerics.fc2d_driver if kind == "fc2d" else numerics.fc3d_driver
run.solving()
info = solve(problem, r, v, options)
run.answer(r[taken], options.iparam[numerics.SICONOS_IPARAM_ITER_DONE], f"info {info}")
