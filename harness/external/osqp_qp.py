"""OSQP: operator splitting (ADMM) on the programme in y."""

import numpy as np
import osqp
import scipy.sparse as sparse
from driver import Run

run = Run()
a, b = run.unitless()
count, size = a.shape
solver = osqp.OSQP()
identity = sparse.identity(size, format="csc")
solver.setup(
    identity, np.zeros(size), a.tocsc(), -b, np.full(count, np.inf),
    eps_abs=run.tolerance, eps_rel=0.0, max_iter=run.iterations, verbose=False,
)
run.solving()
result = solver.solve(raise_error=False)
run.answer(-result.y, result.info.iter, result.info.status)
