"""PIQP: proximal interior point on the programme in r', or in y."""

import numpy as np
import piqp
from driver import Run

run = Run()
p, q, g, least = run.programme()
solver = piqp.SparseSolver()
solver.settings.eps_abs, solver.settings.eps_rel = run.tolerance, 0.0
solver.settings.check_duality_gap = False
solver.settings.max_iter = run.iterations
solver.setup(p, q, **({"x_l": least} if run.is_dual else {"G": g, "h_l": least}))
run.solving()
ending = solver.solve()
run.answer(solver.result.x if run.is_dual else solver.result.z_l, solver.result.info.iter, ending)
