"""OSQP: operator splitting (ADMM) on the programme in y, or in r'."""

import numpy as np
import osqp
import scipy.sparse as sparse
from driver import Run

run = Run()
p, q, g, least = run.programme()
solver = osqp.OSQP()
solver.setup(
    sparse.triu(p, format="csc"), q, g, least, np.full(len(least), np.inf),
    eps_abs=run.tolerance, eps_rel=0.0, max_iter=run.iterations, verbose=False,
)
run.solving()
result = solver.solve(raise_error=False)
run.answer(result.x if run.is_dual else -result.y, result.info.iter, result.info.status)
