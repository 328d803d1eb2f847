"""What `scene.py` says of made-up problems, and of one of LMGC90's: test_scene.py PROBLEM"""

import copy
import json
import sys

import numpy as np
from scene import difference, placed, refuse, rounded

H = 0.005


def touching(positions, radius, gap, friction=None):
    """Discs of 2 kg at these places, each upon the one before with a gap, the first on a floor."""
    x, count = np.array(positions), len(positions)
    normal = [[0.0, 1.0]] + [list((b - a) / np.linalg.norm(b - a)) for a, b in zip(x, x[1:])]
    contacts = {
        "candidate": list(range(count)), "antagonist": [None, *range(count - 1)], "normal": normal,
        "offset": [max(0.0, g) / H for g in gap], "gap": gap,
    }
    grains = {
        "mass": [2.0] * count, "radius": [radius] * count, "position": positions,
        "free_velocity": [[0.0, -0.05]] * count,
    }
    if friction is not None:
        grains["inertia"] = [0.5 * 2.0 * radius**2] * count
        grains["free_velocity"] = [[0.0, -0.05, 0.0]] * count
        contacts["friction"] = [friction] * count
        contacts["offset"] = [[c, 0.0] for c in contacts["offset"]]
    return {"time_step": H, "grains": grains, "contacts": contacts}


def density(problem):
    return np.array(problem["grains"]["mass"]) / (np.pi * np.array(problem["grains"]["radius"]) ** 2)


true = [[0.0, 0.5], [0.3, 1.4539392014169457], [0.0, 2.4078784028338914]]
for friction in (None, 0.3):
    problem = touching(true, 0.5, [0.0, 0.0, 0.0], friction)
    assert difference(problem, copy.deepcopy(problem)) == {"b": (0.0, 0), "W": (0.0, 0)}
    x, missed = placed(problem)
    assert missed < 1e-15 and np.abs(x - true).max() < 1e-15
    # Positions of the start of the time step: the places that the contacts tell come back, but for a motion of all together.
    moved = copy.deepcopy(problem)
    moved["grains"]["position"] = [[0.01, 0.52], [0.32, 1.47], [-0.02, 2.45]]
    x, missed = placed(moved)
    assert missed < 1e-15 and np.abs((x - x[0]) - (np.array(true) - true[0])).max() < 1e-14
    # As handed over, with 7 digits: the problem to these, from the right places; another one from the wrong ones.
    apart = difference(problem, rounded(problem, true, density(problem)))
    assert 0 < apart["W"][0] < 1e-6 and apart["b"][0] < 1e-3, apart
    apart = difference(problem, rounded(problem, moved["grains"]["position"], density(problem)))
    assert apart["W"][0] > 1e-2, apart
    # A gap that was closed, at contact 2; a mass, of grain 1, whose contacts are 1 and 2.
    other = copy.deepcopy(problem)
    other["contacts"]["offset"][2] = 0.02 if friction is None else [0.02, 0.0]
    (of_b, contact), of_w = difference(problem, other).values()
    assert contact == 2 and of_b > 0.1 and of_w == (0.0, 0), (of_b, contact, of_w)
    other = copy.deepcopy(problem)
    other["grains"]["mass"][1] = 2.1
    assert difference(problem, other)["W"][1] in (1, 2)
    refuse(problem, copy.deepcopy(problem), 0.0, "code")
    try:
        refuse(problem, other, 1e-3, "code")
        raise AssertionError("it is another problem")
    except SystemExit as said:
        assert "code is handed another problem: its `W` differs by " in str(said) and "at contact " in str(said), said

# Three discs around a hole whose gaps close no triangle: there are no such places.
ring = touching(true, 0.5, [0.0, 0.0, 0.0])
for key, value in (("candidate", 2), ("antagonist", 0), ("normal", [0.0, 1.0]), ("offset", 0.0), ("gap", 0.5)):
    ring["contacts"][key].append(value)
assert placed(ring)[1] > 1e-2

# Where no two discs touch, they are where they are.
alone = touching([[0.0, 0.5]], 0.5, [0.0])
assert placed(alone)[0].tolist() == [[0.0, 0.5]] and placed(alone)[1] == 0.0

# Of LMGC90: its positions are those of the start of the time step.
with open(sys.argv[1]) as file:
    problem = json.load(file)
x, missed = placed(problem)
given = np.array(problem["grains"]["position"])
assert missed < 1e-14 and 1e-6 < np.abs(x - given).max(), (missed, np.abs(x - given).max())


right, wrong = [difference(problem, rounded(problem, there, density(problem), written=repr)) for there in (x, given)]
assert right["b"][0] < 1e-9 and right["W"][0] < 1e-12, right
assert wrong["b"][0] > 1e-3, wrong
print(f"moved by up to {np.abs(x - given).max():.1e} m, to {missed:.1e} m; b differs by {right['b'][0]:.1e}, else by {wrong['b'][0]:.1e}")
