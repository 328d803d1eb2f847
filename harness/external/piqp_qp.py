"""PIQP: proximal interior point on the programme in y."""

import numpy as np
import piqp
import scipy.sparse as sparse
from driver import Run

run = Run()
a, b = run.unitless()
count, size = a.shape
solver = piqp.SparseSolver()
solver.settings.eps_abs, solver.settings.eps_rel = run.tolerance, 0.0
solver.settings.check_duality_gap = False
solver.settings.max_iter = run.iterations
identity = sparse.identity(size, format="csc")
solver.setup(identity, np.zeros(size), G=a.tocsc(), h_l=-b)
run.solving()
ending = solver.solve()
run.answer(solver.result.z_l, solver.result.info.iter, ending)
