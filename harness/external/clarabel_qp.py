"""Clarabel: interior point on the programme in y."""

import clarabel
import scipy.sparse as sparse
from driver import Run

run = Run()
a, b = run.unitless()
settings = clarabel.DefaultSettings()
settings.verbose, settings.max_threads, settings.max_iter = False, 1, run.iterations
settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = run.tolerance
count, size = a.shape
solver = clarabel.DefaultSolver(
    sparse.identity(size, format="csc"), [0.0] * size, (-a).tocsc(), b, [clarabel.NonnegativeConeT(count)], settings
)
run.solving()
solution = solver.solve()
run.answer(solution.z, solution.iterations, solution.status)
