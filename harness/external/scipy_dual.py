"""SciPy: what people try first on the impulses.

`nnls` and `lsq-linear` solve the programme in y as the least-distance problem that it is (Lawson & Hanson, Solving Least
Squares Problems, 1974, chapter 23): with u >= 0 that makes |E u - f| least, E = [At; -b't] and f = (0, ..., 0, 1), r' is u
over the last entry of f - E u. `l-bfgs-b` descends on 1/2 r't (A At) r' + b't r' over r' >= 0.
"""

import numpy as np
import scipy.optimize as optimize
import scipy.sparse as sparse
from driver import Run

run = Run()
a, b = run.unitless()
count, size = a.shape
if run.words == ["l-bfgs-b"]:
    w = (a @ a.T).tocsr()

    def energy(r):
        wr = w @ r
        return 0.5 * r @ wr + b @ r, wr + b

    options = {"gtol": run.tolerance, "ftol": 0.0, "maxiter": run.iterations, "maxfun": 2 * run.iterations}
    run.solving()
    found = optimize.minimize(
        energy, np.zeros(count), jac=True, method="L-BFGS-B", bounds=[(0, None)] * count, options=options
    )
    run.answer(found.x, found.nit, found.message)
else:
    e = sparse.vstack([a.T, sparse.csr_matrix(-b)]).tocsr()
    f = np.zeros(size + 1)
    f[-1] = 1.0
    if run.words == ["nnls"]:
        dense = e.toarray()
        run.solving()
        u, _ = optimize.nnls(dense, f, maxiter=run.iterations)
        # The count of its iterations is not handed out.
        iterations, ending = 1, "solved"
    else:
        run.solving()
        found = optimize.lsq_linear(e, f, bounds=(0, np.inf), tol=run.tolerance, max_iter=run.iterations)
        u, iterations, ending = found.x, found.nit, found.message
    run.answer(u / (f - e @ u)[-1], iterations, ending)
