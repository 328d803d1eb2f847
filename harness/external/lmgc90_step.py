"""LMGC90: a scene with the problem as its first time step, solved by `nlgs` or `cpg`.

Discs are at rest in space with their free velocity, without gravity; a wall is a thin JONCx at its contact. The law is
IQS_CLB, theta is 1: c = max(0, gap)/h, and motion of the wall. A problem with another c between two discs is refused, and so is
an answer in which LMGC90 found contacts that the problem has not, and that press. Discs are placed where their contacts have the
problem's normals and gaps, which `grains.position` need not be (`scene.py`); where no places do, the problem is refused. Scenes pass
through its text files, whose numbers have 14 characters and, as it writes them, 8 digits: they are written again with all that the characters
hold. W and b of the discs in them are compared with the problem's, and refused where they differ by more than the tolerance
that is asked. So is an answer that lacks a contact of the problem.
"""

import math
import os
import pathlib
import re
import sys
import tempfile

import numpy as np
from driver import Run, tangents
from pylmgc90 import chipy, pre
from scene import in_14_characters, placed, refuse, rounded

run = Run()
problem, grains, contacts = run.problem, run.problem["grains"], run.problem["contacts"]
h, mass, radius = problem["time_step"], np.array(grains["mass"]), np.array(grains["radius"])
free = np.array(grains["free_velocity"])
position, missed = placed(problem)
if missed > 1e-9 * radius.min():
    sys.exit(f"`contacts.normal` and `contacts.gap` are of no places of the grains: at the best, one misses them by {missed:.1e} m")
n, gap, mu = np.array(contacts["normal"]), np.array(contacts["gap"]), run.friction
t, offset = tangents(n)[0], np.array(contacts["offset"]).reshape(len(n), -1)
# Its tolerances have no unit: the problem keeps its own.
run.rows, run.root, run.scale = offset.shape[1], 1.0, 1.0
own = np.maximum(gap, 0) / h
for alpha, j in enumerate(contacts["antagonist"]):
    if j is not None and np.any(np.abs(offset[alpha] - [own[alpha], 0][: offset.shape[1]]) > 1e-9 + 1e-6 * own[alpha]):
        sys.exit(f"`contacts.offset[{alpha}]` is not max(0, gap)/h, the only one that LMGC90's law has between two discs")
if "inertia" in grains and np.any(np.abs(np.array(grains["inertia"]) / (0.5 * mass * radius**2) - 1) > 1e-6):
    sys.exit("`grains.inertia` is not that of homogeneous discs, the only ones that the driver builds")
if len(set(mu)) > 1:
    sys.exit("`contacts.friction` differs from contact to contact: the driver has one law")

density = mass / (math.pi * radius**2)
refuse(problem, rounded(problem, position, density), run.tolerance, "LMGC90")

os.chdir(tempfile.mkdtemp(dir=os.path.dirname(os.path.abspath(run.file))))
os.mkdir("DATBOX")
materials, models, bodies = pre.materials(), pre.models(), pre.avatars()
rigid = pre.model(name="rigid", physics="MECAx", element="Rxx2D", dimension=2)
models.addModel(rigid)
for i, of_disc in enumerate(density):
    material = pre.material(name=f"m{i:04x}", materialType="RIGID", density=of_disc)
    materials.addMaterial(material)
    disc = pre.rigidDisk(r=radius[i], center=list(position[i]), model=rigid, material=material, color="GRAIN")
    disc.imposeInitValue(component=list(range(1, free.shape[1] + 1)), value=list(free[i]))
    bodies.addAvatar(disc)
numbers = {}  # of the contacts, by the ranks of the two bodies, from 1
for alpha, (i, j) in enumerate(zip(contacts["candidate"], contacts["antagonist"])):
    if j is None:
        half, thick = 1e-2 * radius[i], 1e-3 * radius[i]
        centre = position[i] - (radius[i] + gap[alpha] + thick) * n[alpha]
        bar = pre.rigidJonc(axe1=half, axe2=thick, center=list(centre), model=rigid, material=material, color="WALLx")
        angle = math.atan2(n[alpha, 1], n[alpha, 0]) - math.pi / 2
        bar.rotate(description="axis", alpha=angle, axis=[0.0, 0.0, 1.0], center=bar.nodes[1].coor)
        moves = -(offset[alpha, 0] - own[alpha]) * n[alpha] - (offset[alpha, 1] * t[alpha] if offset.shape[1] > 1 else 0)
        for component, speed in ((1, moves[0]), (2, moves[1]), (3, 0.0)):
            bar.imposeDrivenDof(component=component, dofty="vlocy", ct=float(speed), rampi=1.0)
        bodies.addAvatar(bar)
        j = len(bodies) - 1
    if numbers.setdefault(frozenset((i + 1, j + 1)), alpha) != alpha:
        sys.exit(f"contact {alpha} is between grains that have one already: LMGC90 makes one of two discs")
laws, tables = pre.tact_behavs(), pre.see_tables()
law = pre.tact_behav(name="iqsc0", law="IQS_CLB", fric=float(mu[0]))
laws.addBehav(law)
for antagonist, colour in (("DISKx", "GRAIN"), ("JONCx", "WALLx")):
    tables.addSeeTable(
        pre.see_table(
            CorpsCandidat="RBDY2", candidat="DISKx", colorCandidat="GRAIN", CorpsAntagoniste="RBDY2",
            antagoniste=antagonist, colorAntagoniste=colour, behav=law, alert=max(0.0, gap.max()) + 1e-4 * radius.min(),
        )
    )
pre.writeDatbox(2, materials, models, bodies, laws, tables, gravy=[0.0, 0.0, 0.0], post=pre.postpro_commands())
numbers_of = {
    "BULK_BEHAV.DAT": ("Umas=", density),
    "BODIES.DAT": ("coo[12]=|byrd=", [x for i, body in enumerate(bodies) for x in [*body.nodes[1].coor[:2], *radius[i : i + 1]]]),
    "DOF.INI": (r"V\([123]\)=", [x for of_body in free for x in [*of_body, 0.0][:3]] + [0.0] * 3 * (len(bodies) - len(free))),
}
for name, (key, values) in numbers_of.items():
    file, values = pathlib.Path("DATBOX", name), iter(values)
    file.write_text(re.sub(f"({key}).{{14}}", lambda found: found[1] + in_14_characters(next(values)), file.read_text()))
    if next(values, None) is not None:
        sys.exit(f"pylmgc90 writes {name} in a form that the driver does not know")

chipy.Initialize()
chipy.checkDirectories()
chipy.utilities_DisableLogMes()
chipy.SetDimension(2, 1)
chipy.TimeEvolution_SetTimeStep(h)
chipy.Integrator_InitTheta(1.0)
chipy.ReadBehaviours()
if chipy.tact_behav_GetNbTactBehav() == 0:
    # One version leaves TACT_BEHAV.DAT unread, and knows laws only by those that are there when it is asked.
    chipy.tact_behav_ReadBehaviours()
    chipy.ReadBehaviours()
# The rest of its ReadDatbox, without the copies of what was read.
for read in (
    chipy.ReadBodies, chipy.LoadBehaviours, chipy.ReadIniDof, chipy.ReadDrivenDof, chipy.LoadTactors, chipy.ReadIniVlocRloc,
):
    read()
chipy.ComputeMass()
chipy.IncrementStep()
chipy.ComputeFext()
chipy.ComputeBulk()
chipy.ComputeFreeVelocity()
chipy.SelectProxTactors()
chipy.RecupRloc()
run.solving()
# Convergence is looked at every so many iterations.
every = min(50, run.iterations)
if run.words == ["cpg"]:
    chipy.cpg_ExSolver("Quad ", run.tolerance, every, run.iterations // every)
else:
    chipy.nlgs_ExSolver("Stored_Delassus_Loops         ", "Quad ", run.tolerance, 1.0, every, run.iterations // every)
run.solved()
chipy.StockRloc()
r = np.zeros((len(n), run.rows))
missing = set(numbers)
for found in chipy.getInteractions():
    bodies_of = frozenset((int(found["icdbdy"]), int(found["ianbdy"])))
    # Forces in its own frame, on its candidate: the disc where there is a wall.
    force = found["uc"] @ found["rl"] * h
    missing.discard(bodies_of)
    if bodies_of in numbers:
        alpha = numbers[bodies_of]
        force = force if found["icdbdy"] == contacts["candidate"][alpha] + 1 else -force
        r[alpha] = [force @ n[alpha], force @ t[alpha]][: run.rows]
    elif np.any(force != 0):
        sys.exit(f"bodies {sorted(bodies_of)} press, between which the problem has no contact")
if missing:
    sys.exit(f"LMGC90 found no contact where the problem has contact {min(numbers[bodies_of] for bodies_of in missing)}")
# The count of its iterations is not handed out.
run.answer(r.ravel(), 1)
