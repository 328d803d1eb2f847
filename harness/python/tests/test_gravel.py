"""The package on problems with a known answer, against files and bad input."""

import json
import os
import signal
import threading
from pathlib import Path

import gravel
import numpy as np
import pytest

CHECKOUT = Path(__file__).resolve().parents[3]
FROZEN = CHECKOUT / "cases" / "frozen"
N, H, G, MASS, RADIUS = 5, 0.005, 9.81, 2.0, 0.1


def column():
    """Five discs on each other, on a floor."""
    grains = {
        "mass": np.full(N, MASS),
        "radius": np.full(N, RADIUS),
        "position": np.stack([np.zeros(N), (2 * np.arange(N) + 1) * RADIUS], axis=1),
        "free_velocity": np.tile([0.0, -G * H], (N, 1)),
    }
    contacts = {
        "candidate": np.arange(N),
        "antagonist": np.arange(N) - 1,
        "normal": np.tile([0.0, 1.0], (N, 1)),
        "offset": np.zeros(N),
        "gap": np.zeros(N),
    }
    head = {"format": "gravel/contact-problem/1", "name": "mine", "source": "five discs", "time_step": H}
    return {**head, "grains": grains, "contacts": contacts}


@pytest.mark.parametrize("method", ["active-set", "nsgs", "cg", "latin-dd"])
def test_column_of_discs_carries_its_weight(method):
    solution = gravel.solve(column(), method, tolerance=1e-12)
    assert solution.status == "converged"
    np.testing.assert_allclose(solution.impulses, MASS * G * H * np.arange(N, 0, -1), rtol=1e-10)
    np.testing.assert_allclose(solution.velocities, np.zeros((N, 2)), atol=1e-12)
    np.testing.assert_allclose(solution.relative_velocities, np.zeros(N), atol=1e-12)
    assert solution.residuals["natural_map"] <= 1e-12
    assert np.isnan(solution.residuals["velocity_error"])


def test_velocities_are_those_of_the_equations_with_friction():
    problem = gravel.load(FROZEN / "rough-250.json")
    grains, contacts = problem["grains"], problem["contacts"]
    solution = gravel.solve(problem, "nsgs", tolerance=1e-6)
    r, v = solution.impulses, solution.relative_velocities
    assert r.shape == v.shape == (len(contacts["candidate"]), 2)
    n, i, j = contacts["normal"], contacts["candidate"], contacts["antagonist"]
    t, pair = np.stack([-n[:, 1], n[:, 0]], axis=1), j >= 0
    impulse = n * r[:, :1] + t * r[:, 1:]
    expected = grains["free_velocity"].copy()
    for grain, sign, at in ((i, 1, slice(None)), (j[pair], -1, pair)):
        np.add.at(expected[:, :2], grain, sign * impulse[at] / grains["mass"][grain, None])
        np.add.at(expected[:, 2], grain, -grains["radius"][grain] * r[at, 1] / grains["inertia"][grain])
    np.testing.assert_allclose(solution.velocities, expected, atol=1e-9)
    free = r[:, 0] == 0
    assert np.all(np.abs(r[:, 1]) <= contacts["friction"] * r[:, 0] * (1 + 1e-9))
    assert np.all(v[free, 0] > -1e-6) and 0 < free.sum() < len(r)


def test_same_bits_from_a_path_and_from_arrays():
    path = FROZEN / "settled-60.json"
    of_path, of_arrays = (gravel.solve(problem, "nsgs", relaxation=1.2) for problem in (path, gravel.load(path)))
    assert of_path.iterations == of_arrays.iterations > 0
    assert np.array_equal(of_path.impulses, of_arrays.impulses)
    of_path.impulses[0] = 1.0  # the arrays are the caller's


def test_problem_is_read_as_its_file_has_it():
    for path in sorted(FROZEN.glob("*.json")):
        if path.name.endswith(".solution.json"):
            continue
        problem, file = gravel.load(path), json.loads(path.read_text())
        assert problem["name"] == file["name"]
        for table in ("grains", "contacts"):
            for key, values in problem[table].items():
                expected = [-1 if value is None else value for value in file[table][key]]
                assert np.array_equal(values, expected), f"{path.name}: {table}.{key}"
        assert np.issubdtype(problem["contacts"]["antagonist"].dtype, np.integer)


def test_case_is_a_problem_with_changes_of_its_scene():
    problem = gravel.load(CHECKOUT / "cases" / "column.toml", scene={"sample.grains": 7})
    assert len(problem["grains"]["mass"]) == 7


def test_curve_falls_to_the_residual_and_truth_is_measured():
    solution = gravel.solve(FROZEN / "settled-60.json", "cg", tolerance=1e-8, truth=True)
    curve = solution.curve
    assert curve["natural_map"][0] == pytest.approx(1.0)  # r = 0
    assert curve["natural_map"][-1] == solution.residuals["natural_map"] <= 1e-8
    assert curve["iteration"][-1] == solution.iterations
    assert 0 < solution.residuals["velocity_error"] < 1e-6
    assert solution.told["settings"] == {"preconditioner": "none"}


def test_what_does_not_converge_is_a_solution_that_says_so():
    solution = gravel.solve(FROZEN / "settled-60.json", "nsgs", max_iterations=3)
    assert (solution.status, solution.iterations) == ("iteration-limit", 3)


def test_problem_without_contacts_or_with_open_ones_has_no_impulses():
    problem = column()
    problem["contacts"] = {key: values[:0] for key, values in problem["contacts"].items()}
    solution = gravel.solve(problem, "nsgs")
    assert solution.impulses.shape == (0,)
    np.testing.assert_array_equal(solution.velocities, problem["grains"]["free_velocity"])


def changed(table, key, value):
    problem = column()
    problem[table][key] = value
    return problem


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: gravel.solve(column(), "nsg"), "unknown method `nsg`; did you mean `nsgs`?"),
        (lambda: gravel.solve(column(), "nsgs", omega=1.2), "unknown field `omega`; did you mean `relaxation`?"),
        (lambda: gravel.solve(column(), tolerance=-1), "`tolerance` is -1"),
        (lambda: gravel.solve(column(), on="error"), "unknown variant `error`"),
        (lambda: gravel.solve(changed("grains", "mass", np.array([2.0, 2, np.nan, 2, 2]))), "`grains.mass[2]`: invalid type: null"),
        (lambda: gravel.solve(changed("grains", "mass", np.array([2.0, 2, -1, 2, 2]))), "`grains.mass[2]` is -1"),
        (lambda: gravel.solve(changed("contacts", "gap", np.zeros(4))), "`contacts.gap`"),
        (lambda: gravel.solve(changed("contacts", "antagonist", np.full(N, 9))), "`contacts.antagonist[0]` is 9"),
        (lambda: gravel.solve({"name": "mine"}), "missing"),
        (lambda: gravel.solve(FROZEN / "rough-spheres-250.json", "convex"), "`convex` has no form for spheres with friction"),
        (lambda: gravel.load("no-such-problem"), "no problem or case `no-such-problem`"),
        (lambda: gravel.load(FROZEN / "settled-60.json", time_step=3), "it has no scene and no other time step"),
        (lambda: gravel.load(FROZEN), "no study is stored in this folder"),
    ],
)
def test_errors_have_the_words_of_the_program(call, words):
    with pytest.raises(ValueError) as error:
        call()
    assert words in str(error.value)


def test_ctrl_c_ends_a_run():
    def press():
        os.kill(os.getpid(), signal.SIGINT)

    # A shell lets what it starts in the background ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        gravel.solve(FROZEN / "settled-991.json", "jacobi", tolerance=0, max_iterations=10**9)


def test_stored_tables_are_data_frames(tmp_path):
    pandas = pytest.importorskip("pandas")
    runs = pandas.DataFrame({"run": [0, 1], "method": ["nsgs", "cg"], "natural_map": [1e-6, 1e-7]})
    runs.to_parquet(tmp_path / "runs.parquet")
    tables = gravel.load(tmp_path)
    assert list(tables) == ["runs"]
    pandas.testing.assert_frame_equal(tables["runs"], runs)
    pandas.testing.assert_frame_equal(gravel.load(tmp_path / "runs.parquet"), runs)


def test_example_of_the_readme_prints_what_it_says(monkeypatch, capsys):
    monkeypatch.chdir(CHECKOUT)
    readme = (CHECKOUT / "harness" / "python" / "README.md").read_text()
    exec(readme.split("```python\n")[1].split("```")[0], {})
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].startswith("converged ") and printed[1] in readme


def test_notebook_runs():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    path = CHECKOUT / "harness" / "python" / "example.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(path.parent)}}).execute()
    shown = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("image/png" in output.get("data", {}) for output in shown)
