"""MuJoCo: its convex relaxation of contacts with friction, softened by the least that it allows, solved by Newton's method, conjugate
gradients or projected Gauss-Seidel.

A model is built whose contacts are those of the problem, each an explicit pair of geoms; then the rows of its Jacobian and the velocities
that contacts are to reach are overwritten by the problem's, so that what is solved differs from the problem by MuJoCo's laws alone: a
contact that slides opens, and every contact yields, by the impedance 0.9999 at most.
"""

import sys

import mujoco
import numpy as np
from driver import Run, assembled

# Impedances (smallest, largest) and the width, the midpoint and the power of the way between them, which does not matter then.
RIGID = 'solimp="0.9999 0.9999 1 0.5 2"'

run = Run()
problem, grains, contacts, mu = run.problem, run.problem["grains"], run.problem["contacts"], run.friction
h, mass, radius = problem["time_step"], grains["mass"], grains["radius"]
position, normal = np.array(grains["position"]), np.array(contacts["normal"])
space, dimension = position.shape[1], 3 if "friction" in contacts else 1
inertia = grains.get("inertia", [0.4 * m * r**2 for m, r in zip(mass, radius)])
joints = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")[:space])
if dimension > 1:
    joints += "".join(f'<joint type="hinge" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")[-1 if space == 2 else 0 :])


def words(x):
    """Three coordinates, as MuJoCo reads them."""
    return " ".join(repr(float(y)) for y in [*x, 0.0][:3])


bodies = "".join(
    f'<body pos="{words(x)}">{joints}<inertial pos="0 0 0" mass="{m!r}" diaginertia="{i!r} {i!r} {i!r}"/>'
    f'<geom name="g{k}" type="sphere" size="{r!r}" contype="0" conaffinity="0"/></body>'
    for k, (x, m, i, r) in enumerate(zip(position, mass, inertia, radius))
)
pairs, of_pair = "", {}
for alpha, (i, j) in enumerate(zip(contacts["candidate"], contacts["antagonist"])):
    if j is None:
        j = f"w{alpha}"
        there = position[i] - (radius[i] + contacts["gap"][alpha]) * normal[alpha]
        bodies += f'<geom name="{j}" type="plane" size="1 1 1" pos="{words(there)}" zaxis="{words(normal[alpha])}" contype="0" conaffinity="0"/>'
    else:
        j = f"g{j}"
    if of_pair.setdefault(frozenset((f"g{i}", j)), alpha) != alpha:
        sys.exit(f"contact {alpha} is between grains that have one already: MuJoCo makes one of two spheres")
    along = max(float(mu[alpha]), mujoco.mjMINMU)
    pairs += f'<pair geom1="{j}" geom2="g{i}" condim="{dimension}" friction="{along!r} {along!r}" margin="1e6" {RIGID}/>'
model = mujoco.MjModel.from_xml_string(
    f"""<mujoco><option timestep="{h!r}" gravity="0 0 0" cone="elliptic" solver="{dict(newton="Newton", cg="CG", pgs="PGS")[run.words[0]]}" jacobian="{run.words[1]}" iterations="{run.iterations}"
    tolerance="{run.tolerance!r}"><flag warmstart="disable" island="disable"/></option><size memory="2G"/><worldbody>{bodies}</worldbody>
    <contact>{pairs}</contact></mujoco>"""
)
data = mujoco.MjData(model)
mujoco.mj_fwdPosition(model, data)
a, b, run.rows = assembled(problem)
run.root = run.scale = 1.0
if data.ncon != len(normal) or data.nefc != dimension * data.ncon:
    sys.exit(f"MuJoCo makes {data.ncon} contacts of the problem's {len(normal)}")
# The problem's row of each of MuJoCo's; none for the second tangent in the plane.
row_of = np.full(data.nefc, -1)
for contact in data.contact:
    alpha = of_pair[frozenset(model.geom(g).name for g in (contact.geom1, contact.geom2))]
    row_of[contact.efc_address + np.arange(run.rows)] = run.rows * alpha + np.arange(run.rows)
motion = np.array([mass] * space + [inertia] * (model.nv // len(mass) - space)).T.ravel()
rows = a.multiply(np.sqrt(motion)).tocsr()
if mujoco.mj_isSparse(model):
    places, columns = np.repeat(np.arange(data.nefc), data.efc_J_rownnz), data.efc_J_colind
else:
    places, columns = (place.ravel() for place in np.indices((data.nefc, model.nv)))
is_of = row_of[places] >= 0
values = np.zeros(len(columns))
values[is_of] = np.asarray(rows[row_of[places[is_of]], columns[is_of]]).ravel()
if np.count_nonzero(values) != rows.count_nonzero():
    sys.exit("MuJoCo's contacts do not move the grains that the problem's move")
data.efc_J[:] = values
mujoco.mj_projectConstraint(model, data)
mujoco.mj_fwdVelocity(model, data)
mujoco.mj_fwdActuation(model, data)
mujoco.mj_fwdAcceleration(model, data)
data.efc_aref[:] = np.where(row_of >= 0, -b[row_of] / h, 0.0)
run.solving()
mujoco.mj_fwdConstraint(model, data)
run.solved()
r = np.zeros(len(b))
r[row_of[row_of >= 0]] = h * data.efc_force[row_of >= 0]
run.answer(r, data.solver_niter[0], "iteration limit" if data.solver_niter[0] >= run.iterations else "solved")
