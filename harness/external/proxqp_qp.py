"""ProxQP: proximal augmented Lagrangian on the programme in y, or in r'."""

import numpy as np
from driver import Run
from proxsuite import proxqp

run = Run()
p, q, g, least = run.programme()
(count, size), backend = g.shape, run.words[0]
if backend == "dense":
    qp, p, g = proxqp.dense.QP(size, 0, count), p.toarray(), g.toarray()
else:
    qp = proxqp.sparse.QP(size, 0, count)
    names = {"matrix-free": "MatrixFree", "sparse-cholesky": "SparseCholesky"}
    qp.settings.sparse_backend = getattr(proxqp.SparseBackend, names[backend])
qp.settings.eps_abs, qp.settings.eps_rel, qp.settings.max_iter = run.tolerance, 0.0, run.iterations
qp.init(p, q, None, None, g, least, np.full(count, np.inf))
run.solving()
qp.solve()
run.answer(qp.results.x if run.is_dual else -qp.results.z, qp.results.info.iter, str(qp.results.info.status).split(".")[-1])
