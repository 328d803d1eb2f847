"""The package on problems with a known answer, against files and bad input."""

import json
import os
import signal
import subprocess
import sys
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
    assert solution.told["settings"] == {"preconditioner": "none", "precision": "double"}


def test_what_does_not_converge_is_a_solution_that_says_so():
    solution = gravel.solve(FROZEN / "settled-60.json", "nsgs", max_iterations=3)
    assert (solution.status, solution.iterations) == ("iteration-limit", 3)


def test_problem_without_contacts_or_with_open_ones_has_no_impulses():
    problem = column()
    problem["contacts"] = {key: values[:0] for key, values in problem["contacts"].items()}
    solution = gravel.solve(problem, "nsgs")
    assert solution.impulses.shape == (0,)
    np.testing.assert_array_equal(solution.velocities, problem["grains"]["free_velocity"])


def rough_without_contacts():
    problem = gravel.load(FROZEN / "rough-250.json")
    problem["contacts"] = {key: values[:0] for key, values in problem["contacts"].items()}
    return problem


def test_no_contacts_with_friction_have_rows_of_two(tmp_path):
    problem = rough_without_contacts()
    solution = gravel.solve(problem, "nsgs")
    assert solution.impulses.shape == solution.relative_velocities.shape == (0, 2)
    np.testing.assert_array_equal(solution.velocities, problem["grains"]["free_velocity"])
    # A file of them is read with the same shapes and kinds.
    listed = lambda table: {key: values.tolist() for key, values in problem[table].items()}
    file = {**problem, "grains": listed("grains"), "contacts": listed("contacts")}
    (tmp_path / "none.json").write_text(json.dumps(file))
    loaded = gravel.load(tmp_path / "none.json")
    assert set(loaded["contacts"]) == set(problem["contacts"]) - {"start"}
    for key, values in loaded["contacts"].items():
        assert values.shape == problem["contacts"][key].shape and values.dtype.kind == problem["contacts"][key].dtype.kind
    assert loaded["contacts"]["antagonist"].dtype.kind == "i"


def test_solutions_are_equal_where_their_arrays_are():
    one, same, other = (gravel.solve(column(), "nsgs", tolerance=tolerance) for tolerance in (1e-6, 1e-6, 1e-3))
    assert one == same and not one != same
    assert one != other and one != "nsgs"
    assert one in [other, same]
    with pytest.raises(TypeError):
        hash(one)


def test_whatever_becomes_an_array_is_one():
    expected = gravel.solve(column(), "nsgs").impulses

    def impulses(change):
        problem = column()
        for table, keys in (("grains", ("mass", "radius")), ("contacts", ("candidate", "antagonist", "offset"))):
            for key in keys:
                problem[table][key] = change(problem[table][key])
        return gravel.solve(problem, "nsgs").impulses

    wide = impulses(lambda values: values.astype(np.longdouble) if values.dtype.kind == "f" else values.astype(np.int16))
    np.testing.assert_array_equal(wide, expected)
    np.testing.assert_array_equal(impulses(list), expected)  # of NumPy's numbers
    np.testing.assert_array_equal(impulses(lambda values: values.astype(object)), expected)
    pandas = pytest.importorskip("pandas")
    np.testing.assert_array_equal(impulses(pandas.Series), expected)


def test_setting_of_any_kind_of_number_is_one():
    plain = gravel.solve(column(), "nsgs", tolerance=1e-6, relaxation=1.25, max_iterations=1000)
    typed = gravel.solve(
        column(), "nsgs", tolerance=np.longdouble(1e-6), relaxation=np.float32(1.25), max_iterations=1e3, symmetric=np.bool_(False)
    )
    assert plain == typed


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
        (lambda: gravel.solve(changed("grains", "mass", np.array([2.0, 2, np.nan, 2, 2]))), "`grains.mass[2]` is nan: it must be finite"),
        (lambda: gravel.solve(changed("grains", "position", np.array([[0, 0.1]] * 4 + [[0, np.inf]]))), "`grains.position[4][1]` is inf"),
        (lambda: gravel.solve(changed("grains", "mass", [2.0, 2.0, float("nan"), 2.0, 2.0])), "`grains.mass[2]` is nan"),
        (lambda: gravel.solve(changed("grains", "mass", np.full(N, np.longdouble("1e400")))), "`grains.mass[0]` is 1e+400"),
        (lambda: gravel.solve(changed("grains", "mass", np.full(N, 2 + 0j))), "`grains.mass` is an array of complex128"),
        (lambda: gravel.solve(changed("grains", "mass", [2 + 0j] * N)), "`grains.mass[0]` is (2+0j)"),
        (lambda: gravel.solve(changed("contacts", "antagonist", np.array([np.nan, 0, 1, 2, 3]))), "`contacts.antagonist[0]` is nan"),
        (lambda: gravel.solve(changed("contacts", "antagonist", np.array([-2, 0, 1, 2, 3]))), "`contacts.antagonist[0]`"),
        (lambda: gravel.solve(column(), "nsgs", relaxation=np.nan), "`relaxation` is nan: it must be finite"),
        (lambda: gravel.solve(column(), "latin-dd", kappa_l=float("inf")), "`kappa_l` is inf: it must be finite"),
        (lambda: gravel.solve(column(), "nsgs", relaxation=1j), "`relaxation` is 1j"),
        (lambda: gravel.solve(column(), tolerance=float("nan")), "`tolerance` is nan"),
        (lambda: gravel.solve(column(), max_iterations=1.5), "`max_iterations`: invalid type: floating point `1.5`"),
        (lambda: gravel.load("settled-box", scene={"scene.friction": np.nan}), "`scene.friction` is nan"),
        (lambda: gravel.solve(changed("grains", "mass", np.array([2.0, 2, -1, 2, 2]))), "`grains.mass[2]` is -1"),
        (lambda: gravel.solve(changed("contacts", "gap", np.zeros(4))), "`contacts.gap`"),
        (lambda: gravel.solve(changed("contacts", "antagonist", np.full(N, 9))), "`contacts.antagonist[0]` is 9"),
        (lambda: gravel.solve({"name": "mine"}), "missing"),
        (lambda: gravel.solve(FROZEN / "rough-spheres-250.json", "apgd"), "`apgd` minimises an energy: with friction there is none"),
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


INSIDE = """
import os, signal, threading, gravel
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    gravel.solve({path!r}, "nsgs-dd", inner_sweeps=4_000_000_000)
except KeyboardInterrupt:
    print("heard")
"""


def test_ctrl_c_is_heard_inside_an_iteration_of_hours():
    script = INSIDE.format(path=str(FROZEN / "settled-250.json"))
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (ran.returncode, ran.stdout) == (0, "heard\n"), ran.stderr


def test_ctrl_c_ends_a_march_to_a_time_step():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        gravel.load(CHECKOUT / "cases" / "column.toml", time_step=10**9)


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


BOX = CHECKOUT / "cases" / "rough-box.toml"
SMALL = {"sample.grains": 30, "scene.box.width_m": 1.0}


def simulated(time_steps, **more):
    return gravel.simulate(BOX, time_steps, method="nsgs", scene=SMALL, tolerance=1e-3, **more)


def test_simulation_has_series_frames_and_contacts_that_carry_the_weight():
    simulation = simulated(60, every=25, contacts=True)
    assert simulation.status == "completed" and simulation.is_met is None
    assert [frame.time_step for frame in simulation.frames] == [0, 25, 50, 60]
    np.testing.assert_array_equal(simulation.series["time_step"], np.arange(1, 61))
    np.testing.assert_allclose(simulation.series["time_s"], 0.005 * np.arange(1, 61))
    assert simulation.told["totals"]["iterations"] == simulation.series["iterations"].sum() > 0
    first, *_, last = simulation.frames
    assert first.contacts is None and last.positions.shape == last.velocities.shape == (30, 2) and last.spins.shape == (30,)
    contacts = last.contacts
    assert set(contacts["body"]) <= {"grain", "floor", "left", "right"} and len(contacts["gap_m"]) > 30
    # M (V - V before) = h M g + the contacts' impulses: over all grains only walls push.
    at_walls = contacts["body"] != "grain"
    assert np.all(contacts["antagonist"][at_walls] == -1)
    floor = contacts["normal_impulse_n_s"][contacts["body"] == "floor"].sum()
    np.testing.assert_allclose(floor, simulation.series["floor_impulse_n_s"][-1])
    both = np.hypot(contacts["normal_impulse_n_s"], contacts["tangential_impulse_n_s"])
    np.testing.assert_allclose(both, np.hypot(contacts["impulse_x_n_s"], contacts["impulse_y_n_s"]), atol=1e-12)
    assert "<table>" in simulation._repr_html_() and "completed" in repr(simulation)


def test_simulation_resumes_bitwise_and_frames_do_not_change_it(tmp_path):
    whole = simulated(40, every=7)
    simulated(17, state=tmp_path / "state.json")
    rest = simulated(23, restart=tmp_path / "state.json")
    np.testing.assert_array_equal(whole.frames[-1].positions, rest.frames[-1].positions)
    np.testing.assert_array_equal(whole.series["kinetic_energy_j"][17:], rest.series["kinetic_energy_j"])
    assert rest.frames[-1].time_step == 40


def test_progress_sees_each_frame_and_a_condition_ends():
    seen = []
    discs = CHECKOUT / "cases" / "two-discs.toml"
    simulation = gravel.simulate(discs, 2000, tolerance=1e-9, until="at-rest", every=10, progress=seen.append)
    assert simulation.is_met and simulation.frames[-1].time_step < 2000
    assert [frame.time_step for frame in seen] == [frame.time_step for frame in simulation.frames[1:]]


def test_frozen_problem_is_that_of_the_case(tmp_path):
    frozen = gravel.freeze(BOX, tmp_path / "mine.json", time_step=3, scene=SMALL)
    loaded = gravel.load(BOX, time_step=3, scene=SMALL)
    assert frozen["name"] == "mine"
    np.testing.assert_array_equal(frozen["contacts"]["normal"], loaded["contacts"]["normal"])


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: simulated(0), "`time_steps` is 0"),
        (lambda: simulated(3, every=-1), "`every` is -1"),
        (lambda: simulated(3, until="asleep"), "`until`: unknown variant `asleep`"),
        (lambda: simulated(3, until="steady", over=-1), "--over -1"),
        (lambda: simulated(3, start="hot"), "`start`"),
        (lambda: simulated(3, restart="nowhere.json"), "nowhere.json"),
        (lambda: simulated(3, omega=1.2), "unknown field `omega`"),
        (lambda: simulated(3, state=BOX), "`state`: "),
        (lambda: simulated(3, state=BOX), "rough-box.toml exists"),
        (lambda: simulated(3, state="nowhere/state.json"), "there is no folder nowhere"),
        (lambda: gravel.simulate("no-such-case", 3), "no-such-case"),
        (lambda: gravel.simulate(BOX, 3, scene={"sample.grain": 3}), "sample.grain"),
        (lambda: gravel.freeze(BOX, BOX), "exists: give another file"),
        (lambda: gravel.bench("no-such-plan"), "no-such-plan"),
    ],
)
def test_errors_of_simulations_name_what_is_wrong(call, words):
    with pytest.raises(ValueError) as error:
        call()
    assert words in str(error.value)


def test_ctrl_c_ends_a_simulation_and_keeps_its_state(tmp_path):
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    # From the second time step on, so that there is a state.
    begin = lambda frame: None if timer.ident else timer.start()
    with pytest.raises(KeyboardInterrupt):
        simulated(10**9, state=tmp_path / "state.json", every=1, progress=begin)
    assert simulated(1, restart=tmp_path / "state.json").frames[0].time_step > 0


def test_settings_of_tables_are_columns(tmp_path):
    pandas = pytest.importorskip("pandas")
    settings = ['{"relaxation": 1.2, "order": "given"}', '{"preconditioner": "none"}']
    pandas.DataFrame({"run": [0, 1], "settings": settings}).to_parquet(tmp_path / "runs.parquet")
    runs = gravel.load(tmp_path)["runs"]
    assert list(runs.columns) == ["run", "settings.relaxation", "settings.order", "settings.preconditioner"]
    assert runs["settings.relaxation"][0] == 1.2 and pandas.isna(runs["settings.relaxation"][1])


def test_study_is_run_and_its_tables_are_read(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    for folder in ("cases/frozen", "harness/plans"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "cases" / "column.toml").write_text((CHECKOUT / "cases" / "column.toml").read_text())
    plan = 'name = "mine"\nwhy = "A test."\ncharts = []\ncases = [{ case = "column" }]\n'
    plan += 'stop = { on = "natural_map", tolerance = 1e-6, max_iterations = 10000 }\nmethods = [{ method = "nsgs" }, { method = "cg" }]\n'
    (tmp_path / "harness" / "plans" / "mine.toml").write_text(plan)
    monkeypatch.chdir(tmp_path)
    tables = gravel.bench("mine", only={"method": "cg"})
    assert list(tables["runs"]["method"]) == ["cg"] and tables["runs"]["settings.preconditioner"][0] == "none"


def test_figures_draw_grains_chains_and_curves():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    problem = gravel.load(FROZEN / "settled-60.json")
    solutions = [gravel.solve(problem, method) for method in ("nsgs", "cg")]
    axes = gravel.plot.packing(problem, solutions[0], colour=problem["grains"]["radius"])
    chains = axes.collections[1].get_segments()
    assert 0 < len(chains) <= len(problem["contacts"]["gap"])
    axes.figure.canvas.draw()
    frame = simulated(5, contacts=True).frames[-1]
    assert len(gravel.plot.packing(frame).collections) == 3  # grains, chains, walls
    axes = gravel.plot.convergence(solutions)
    assert [line.get_ydata()[-1] for line in axes.lines] == [one.curve["natural_map"][-1] for one in solutions]
    axes.figure.canvas.draw()
    with pytest.raises(ValueError, match="no column of a curve"):
        gravel.plot.convergence(solutions, measure="error")
    with pytest.raises(ValueError, match="impulses: the problem has"):
        gravel.plot.packing(problem, np.zeros(3))


def test_package_tells_its_version_and_types():
    assert gravel.__version__ == "0.2.0"
    assert (Path(gravel.__file__).parent / "py.typed").is_file()
    assert "<table>" in gravel.solve(column(), "cg")._repr_html_()
