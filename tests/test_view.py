"""Pictures: what is drawn is what the result holds, axes say their units, gaps and assumptions show."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

import mckibben as mk
from mckibben.paper import figures as paper
from mckibben.paper import reproduce as making
from mckibben.paper import sketches
from mckibben.paper.measured import measured_points, read_measured
from mckibben.results.result import Result
from mckibben.spec import SpecError
from mckibben.view import curves, shape3d, style
from mckibben.view.projection import View
from mckibben.view.tube import FACETS, Tube

pytestmark = pytest.mark.view

NOTE = "assumed: the paper does not print them"


@pytest.fixture(scope="session")
def results() -> dict[str, Result]:
    """One muscle, its main tests, coarse: the pictures need no more."""
    muscle, coarse = mk.presets.paper(), 1e-4
    protocol = mk.Protocol(steps=[
        mk.Step(length="to 115 mm", pressure=0.0, points=3),
        mk.Step(length="hold", pressure="0 to 1 bar", points=3),
        mk.Step(pressure="1 bar", force="to 0 N", points=5),
    ])  # fmt: skip
    tests = {
        "a": mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=6),
        "b": mk.Isometric(length="55 mm", pressure="0 to 1 bar", points=6),
        "c": protocol,
        "free": mk.FreeContraction(pressure="0.01 to 1 bar", points=6),
        "isobaric": mk.Isobaric(pressure="1 bar", length="115 mm to 60 mm", points=6),
    }
    return {name: mk.run(muscle, test, tolerance=coarse) for name, test in tests.items()}


def broken(result: Result, lost: slice, unstable: int) -> Result:
    """The result as if some states had not been reached and one were unstable."""
    data = result.data.copy(deep=True)
    for name, variable in data.data_vars.items():
        if variable.dtype.kind == "f":
            values = variable.values.copy()
            values[lost] = np.nan
            data[name] = (variable.dims, values, variable.attrs)
    verdict = [str(word) for word in data["verdict"].values]
    verdict[lost] = ["no equilibrium"] * len(verdict[lost])
    verdict[unstable] = "unstable"
    data["verdict"] = ("step", np.array(verdict))
    data["reason"] = ("step", np.array(["the fibres are straight"] * len(verdict)))
    return Result(result.muscle, result.test, data)


def drawn(figure: Figure, axes: int = 0, line: int = 0) -> tuple[np.ndarray, np.ndarray]:
    found = figure.axes[axes].lines[line]
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def labels(figure: Figure) -> list[str]:
    return [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel()) if text]


@pytest.mark.parametrize(
    ("name", "x", "y", "xlabel", "ylabel"),
    [
        ("a", "pressure", "force", "Pressure (bar)", "Force (N)"),
        ("isobaric", "contraction", "force", "Contraction (%)", "Force (N)"),
        ("free", "pressure", "contraction", "Pressure (bar)", "Contraction (%)"),
    ],
)
def test_a_plot_draws_the_numbers_of_the_result(
    results: dict[str, Result], name: str, x: str, y: str, xlabel: str, ylabel: str
) -> None:
    result, scale = results[name], {"pressure": 1e-5, "force": 1.0, "contraction": 100.0}
    figure = curves.plot(result)
    xs, ys = drawn(figure)
    np.testing.assert_allclose(xs, scale[x] * getattr(result, x), rtol=1e-12)
    np.testing.assert_allclose(ys, scale[y] * getattr(result, y), rtol=1e-12)
    assert figure.axes[0].get_xlabel() == xlabel
    assert figure.axes[0].get_ylabel() == ylabel
    assert NOTE in figure.get_supxlabel().replace("\n", " ")


def test_a_protocol_shows_force_length_and_pressure_state_by_state(results: dict[str, Result]) -> None:
    figure = curves.plot(results["c"])
    for k, (values, scale) in enumerate(((results["c"].force, 1.0), (results["c"].length, 1e3))):
        np.testing.assert_allclose(drawn(figure, k)[1], scale * values, rtol=1e-12)
    assert {"Force (N)", "Length (mm)", "Pressure (bar)", "State"} <= set(labels(figure))
    assert [text.get_text() for text in figure.axes[0].texts] == ["step 1", "step 2", "step 3"]


def test_what_was_not_reached_is_a_gap_and_what_is_not_stable_is_marked(results: dict[str, Result]) -> None:
    result = broken(results["a"], slice(4, None), 2)
    figure = curves.plot(result)
    assert np.isnan(drawn(figure)[1][4:]).all()
    np.testing.assert_allclose(drawn(figure, line=1), [[0.4], [result.force[2]]])
    assert "unstable" in [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    said = figure.get_supxlabel().replace("\n", " ")
    assert "2 of 6 states have no values" in said
    assert "the fibres are straight" in said


def test_a_result_without_any_state_is_no_error(results: dict[str, Result], tmp_path: Path) -> None:
    nothing = broken(results["a"], slice(0, None), 0)
    for draw in (curves.plot, curves.profiles, curves.tension, curves.energy, curves.shares):
        style.save(draw(nothing), tmp_path / draw.__name__, ("png",))
    assert curves.chosen(nothing, None) == []


def test_curves_along_the_muscle(results: dict[str, Result]) -> None:
    result = results["a"]
    figure = curves.profiles(result, steps=[0, -1])
    for k, (name, scale) in enumerate((("r", 1e3), ("theta", 180.0 / np.pi))):
        x, y = drawn(figure, k, 1)
        np.testing.assert_allclose(x, 1e3 * result.data["z"].values[-1], rtol=1e-12)
        np.testing.assert_allclose(y, scale * result.data[name].values[-1], rtol=1e-12)
    assert labels(figure) == ["Radius r (mm)", "Axial position z (mm)", "Braid angle θ (deg)"]
    np.testing.assert_array_equal(drawn(curves.tension(result), line=-1)[1], result.data["fibre_tension"].values[-1])


def test_energies_and_shares(results: dict[str, Result]) -> None:
    result = results["a"]
    figure = curves.energy(result)
    np.testing.assert_allclose(drawn(figure, line=0)[1], 1e3 * result.data["energy_chamber"].values)
    np.testing.assert_allclose(drawn(figure, line=4)[1], 1e3 * result.data["energy"].values)
    assert labels(figure) == ["Pressure (bar)", "Energy (mJ)"]
    mesh, chamber = (drawn(curves.shares(result), line=k)[1] for k in (0, 1))
    np.testing.assert_allclose(mesh + chamber, 100.0)


def test_fig4_compares_with_the_formula_and_draws_no_measurement_unless_given(
    results: dict[str, Result], tmp_path: Path
) -> None:
    cases = results | {"d": results["c"]}
    plain = paper.fig4(cases, results["free"])
    np.testing.assert_allclose(drawn(plain, 0, 0)[1], results["a"].force)
    np.testing.assert_allclose(drawn(plain, 0, 1)[1][-1], 95.70, atol=0.02)
    np.testing.assert_allclose(drawn(plain, 2, 0)[1], results["free"].length / 0.115 - 1.0, rtol=1e-6)
    words = [text.get_text() for axes in plain.axes for text in axes.get_legend().get_texts()]
    assert not [word for word in words if "measured" in word]

    file = tmp_path / "lab.csv"
    file.write_text("pressure,value\n0.0,3.0\n1.0,90.0\n", encoding="utf-8")
    points = measured_points({"a": read_measured(file, "a", "115 mm")}, cases, results["free"])
    given = paper.fig4(cases, results["free"], points)
    assert "measured" in [text.get_text() for text in given.axes[0].get_legend().get_texts()]
    np.testing.assert_array_equal(drawn(given, 0, -1), [[0.0, 1.0], [3.0, 90.0]])
    note = given.get_supxlabel().replace("\n", " ")
    worst = results["a"].force[-1] - 90.0
    assert (
        f"a) model less measured (lab.csv): rms {np.hypot(worst, results['a'].force[0] - 3.0) / 2**0.5:.3g} N" in note
    )
    assert f"largest difference {worst:.3g} N ({worst / 0.9:.2g} %) at 1 bar" in note


def test_measured_changes_of_length_are_compared_in_fig4(results: dict[str, Result], tmp_path: Path) -> None:
    """As change of length over the length before, in the old form, or as lengths with units: the same points."""
    free, L = results["free"], 0.115
    old, new = tmp_path / "old.csv", tmp_path / "new.csv"
    values = free.length / L - 1.0 + 0.01
    rows = [f"{1e-5 * P},{x}" for P, x in zip(free.pressure, values, strict=True)]
    old.write_text("\n".join(["pressure,value", *rows]), encoding="utf-8")
    rows = [f"{1e-3 * P};{1e3 * L * (1.0 + x)}" for P, x in zip(free.pressure, values, strict=True)]
    new.write_text("\n".join(["pressure [kPa];length [mm]", *rows]), encoding="utf-8")
    for file in (old, new):
        found = measured_points({"c": read_measured(file, "c", "115 mm")}, {"c": results["c"]}, free)["c"]
        np.testing.assert_allclose(found.value, values, rtol=1e-9)
        np.testing.assert_allclose(found.comparison.differences, -0.01, rtol=1e-9)
        assert found.comparison.outside == 0


@pytest.mark.parametrize(
    "text", ["", "pressure,value\n", "a,b\n1,2\n", "pressure,value\n1,many\n", "pressure,value\n1,nan\n"]
)
def test_a_bad_file_of_measurements_is_named(tmp_path: Path, text: str) -> None:
    file = tmp_path / "lab.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError, match=re.escape("measured.a: lab.csv")):
        read_measured(file, "a", "115 mm")
    with pytest.raises(SpecError, match="cannot be read"):
        read_measured(tmp_path / "none.csv", "a", "115 mm")


def test_every_figure_of_the_paper_is_written_whole(results: dict[str, Result], tmp_path: Path) -> None:
    muscle = mk.presets.paper()
    figures = {
        "fig1": paper.fig1(muscle), "fig2": paper.fig2(muscle), "fig3": paper.fig3(muscle),
        "fig5": paper.fig5(results["a"]), "fig6": paper.fig6(results["b"]),
        "textbook": paper.textbook([results["isobaric"]]),
        "convergence": paper.convergence({"line": ([6, 12, 24], [1e-2, 1e-5, 1e-10])}, muscle),
    }  # fmt: skip
    for name, figure in figures.items():
        paths = style.save(figure, tmp_path / name)
        assert [path.name for path in paths] == [f"{name}.pdf", f"{name}.png"]
        assert paths[0].read_bytes().startswith(b"%PDF")
        assert paths[1].read_bytes().startswith(b"\x89PNG")
        assert min(path.stat().st_size for path in paths) > 5000
        if name not in ("fig1", "fig3"):  # these two show nothing that is assumed
            assert NOTE in figure.get_supxlabel().replace("\n", " ")
    assert not list(tmp_path.glob(".*"))
    bars = [axes.get_ylabel() for axes in figures["fig5"].axes if "density" in axes.get_ylabel()]
    assert len(bars) == 3
    assert all("mJ per mm" in label for label in bars)


def test_only_what_faces_the_viewer_is_drawn(results: dict[str, Result]) -> None:
    tube, view = Tube.of(results["a"], -1), View("horizontal", 0.0)
    axes = style.new_figure().add_subplot()
    shape3d.draw_muscle(axes, tube, view, values=results["a"].data["density_chamber"].values[-1], fittings=False)
    (faces,) = (found for found in axes.collections if isinstance(found, PolyCollection))
    (fibres,) = (found for found in axes.collections if isinstance(found, LineCollection))
    assert len(faces.get_paths()) == 2 * FACETS * shape3d.FACETS  # half of those around
    x = np.concatenate([path.vertices for path in fibres.get_paths()])
    np.testing.assert_allclose([x[:, 0].min(), x[:, 0].max()], [0.0, 115.0], atol=1e-6)
    assert np.abs(x[:, 1]).max() <= 12.5 + 1e-9


def test_fibres_on_the_drawn_surface_keep_their_length(results: dict[str, Result]) -> None:
    tube = Tube.of(results["b"], -1)
    v, phi = tube.fibre(0.3, -1, count=4001)
    points = tube.point(v, phi)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    np.testing.assert_allclose(length, 0.085 / np.sin(np.radians(37.0)), rtol=2e-3)


def test_normals_and_projection_are_orthonormal() -> None:
    tube = Tube.cylinder(mk.presets.paper())
    phi = np.linspace(0.0, 6.0, 7)
    np.testing.assert_allclose(np.linalg.norm(tube.normal(0.03, phi), axis=-1), 1.0)
    for axis in ("horizontal", "vertical"):
        screen, depth = View(axis, 25.0, 40.0).project(np.eye(3))
        frame: Any = np.column_stack([screen, depth])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(frame) > 0.0


def test_labels_and_notes() -> None:
    assert style.axis_label("force", "N") == "Force (N)"
    assert style.axis_label("radius r", "m") == "Radius r (mm)"
    assert style.axis_label("stiffness", "N m^2") == "Stiffness (N mm²)"
    assert style.axis_label("share", "1") == "Share"
    figure = style.new_figure()
    style.assumption_note(figure, mk.presets.reference())
    assert figure.get_supxlabel() == ""
    style.assumption_note(figure, mk.presets.paper())
    assert "Fibre count, fibre and chamber values" in figure.get_supxlabel()


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(SpecError, match="cannot be written"):
        style.save(style.new_figure(), tmp_path / "file" / "x")


def test_reproduce_refuses_before_it_runs(tmp_path: Path) -> None:
    (tmp_path / "textbook.pdf").write_text("old", encoding="utf-8")
    with pytest.raises(SpecError, match=r"out_dir.*force"):
        making.reproduce(tmp_path)
    with pytest.raises(SpecError, match="measured"):
        making.reproduce(tmp_path / "new", measured={"e": "x.csv"})
    assert not (tmp_path / "new").exists()


def test_the_sketches_mark_the_magic_angle() -> None:
    assert abs(sketches.MAGIC - 35.2644) < 1e-4
