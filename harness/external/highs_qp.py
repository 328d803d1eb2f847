"""HiGHS: active set on the programme in r', the form in which it solves packings; in y it ends with an error on them.

It adds its regularisation to the diagonal of A At: with its own 1e-7, no tolerance brings `natural_map` below 1e-6.
"""

import highspy
import numpy as np
import scipy.sparse as sparse
from driver import Run

run = Run()
a, b = run.unitless()
count = len(b)
lower = sparse.tril(a @ a.T).tocsc()
solver = highspy.Highs()
solver.setOptionValue("output_flag", False)
solver.setOptionValue("threads", 1)
solver.setOptionValue("qp_iteration_limit", run.iterations)
solver.setOptionValue("qp_regularization_value", float(run.words[0]))
for which in ("primal", "dual"):
    solver.setOptionValue(f"{which}_feasibility_tolerance", max(run.tolerance, 1e-10))
model = highspy.HighsModel()
programme = model.lp_
programme.num_col_, programme.num_row_ = count, 0
programme.col_cost_, programme.col_lower_ = b, np.zeros(count)
programme.col_upper_ = np.full(count, highspy.kHighsInf)
programme.a_matrix_.start_ = np.zeros(count + 1, dtype=int)
model.hessian_.dim_ = count
model.hessian_.start_, model.hessian_.index_, model.hessian_.value_ = lower.indptr, lower.indices, lower.data
solver.passModel(model)
run.solving()
solver.run()
ending = solver.modelStatusToString(solver.getModelStatus())
run.answer(solver.getSolution().col_value, max(0, solver.getInfo().qp_iteration_count), ending)
