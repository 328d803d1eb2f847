"""ProxQP: proximal augmented Lagrangian on the programme in y."""

import numpy as np
import scipy.sparse as sparse
from driver import Run
from proxsuite import proxqp

run = Run()
a, b = run.unitless()
count, size = a.shape
identity, matrix = sparse.identity(size, format="csc"), a.tocsc()
if run.words == ["dense"]:
    qp, identity, matrix = proxqp.dense.QP(size, 0, count), identity.toarray(), matrix.toarray()
else:
    qp = proxqp.sparse.QP(size, 0, count)
    names = {"matrix-free": "MatrixFree", "sparse-cholesky": "SparseCholesky"}
    qp.settings.sparse_backend = getattr(proxqp.SparseBackend, names[run.words[0]])
qp.settings.eps_abs, qp.settings.eps_rel, qp.settings.max_iter = run.tolerance, 0.0, run.iterations
qp.init(identity, np.zeros(size), None, None, matrix, -b, np.full(count, np.inf))
run.solving()
qp.solve()
run.answer(-qp.results.z, qp.results.info.iter, str(qp.results.info.status).split(".")[-1])
