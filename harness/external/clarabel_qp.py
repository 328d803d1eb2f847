"""Clarabel: interior point on the programme in y, or in r'."""

import clarabel
import scipy.sparse as sparse
from driver import Run

run = Run()
p, q, g, least = run.programme()
settings = clarabel.DefaultSettings()
settings.verbose, settings.max_threads, settings.max_iter = False, 1, run.iterations
settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = run.tolerance
cones = [clarabel.NonnegativeConeT(len(least))]
solver = clarabel.DefaultSolver(sparse.triu(p, format="csc"), q, (-g).tocsc(), -least, cones, settings)
run.solving()
solution = solver.solve()
run.answer(solution.x if run.is_dual else solution.z, solution.iterations, solution.status)
