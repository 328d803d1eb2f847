"""Pinocchio: point contacts in space with Coulomb's law or its convex relaxation, by ADMM or projected Gauss-Seidel on a given W.

A contact's rows are in Pinocchio's order, both tangents before the normal.
"""

import concurrent.futures
import threading

import pinocchio
from driver import Run

run = Run()
w, b, taken = run.in_space(3, order=[2, 0, 1])
models, datas, free = pinocchio.StdVec_ConstraintModel(), pinocchio.StdVec_ConstraintData(), pinocchio.Model()
for of_contact in run.friction:
    contact = pinocchio.PointContactConstraintModel(free)
    contact.setFriction(of_contact)
    contact = pinocchio.ConstraintModel(contact)
    models.append(contact)
    datas.append(contact.createData())
if run.words[0] == "admm":
    solver, settings, result = pinocchio.ADMMConstraintSolver(), pinocchio.ADMMSolverSettings(), pinocchio.ADMMSolverResult()
    # Its default decomposes the whole of W for one eigenvalue, which takes minutes.
    settings.lanczos_size = 10
    w = pinocchio.DelassusOperatorSparse(w)
else:
    solver, settings, result = pinocchio.PGSConstraintSolver(), pinocchio.PGSSolverSettings(), pinocchio.PGSSolverResult()
    w = pinocchio.DelassusOperatorDense(w.toarray())
settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = run.tolerance
settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
settings.max_iterations = run.iterations
settings.solve_ncp = run.words[1] == "coulomb"
run.solving()
# Its Gauss-Seidel copies W to the stack, which 8 MB end at a thousand rows.
threading.stack_size(2**26 + 8 * len(b) ** 2 // 4096 * 4096)
with concurrent.futures.ThreadPoolExecutor(1) as thread:
    thread.submit(solver.solve, w, b, models, datas, settings, result).result()
run.solved()
run.answer(result.retrieveConstraintImpulses()[taken], result.iterations, "converged" if result.converged else "iteration limit")
