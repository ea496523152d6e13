"""How a fit is kept and shown: files, pictures, the fit file, the command. One small fit serves all."""

from pathlib import Path

import numpy as np
import pytest

import mckibben as mk

pytestmark = pytest.mark.app

FREE = {"braid.angle": "35 deg to 39 deg", "chamber.law.c1": "4 kPa to 20 kPa"}


def bench() -> mk.Data:
    """Two curves of the paper's muscle, of 8 points each, with noise of 0.2 N."""
    parts = []
    for bar in (0.5, 1.0):
        curve = mk.run(mk.presets.paper(), mk.Isobaric(length="80 mm to 112 mm", pressure=f"{bar} bar", points=8))
        parts.append((curve.length, curve.pressure, curve.force))
    length, pressure, force = (np.concatenate(column) for column in zip(*parts, strict=True))
    noise = np.random.default_rng(4).normal(0.0, 0.2, len(force))
    return mk.read_data({"length [m]": length, "pressure [Pa]": pressure, "force [N]": force + noise})


@pytest.fixture(scope="module")
def data() -> mk.Data:
    return bench()


@pytest.fixture(scope="module")
def fit(data: mk.Data) -> mk.Fit:
    return mk.fit(mk.presets.paper(), data, FREE, starts=1)


def test_a_fit_is_loaded_as_it_was_saved(fit: mk.Fit, tmp_path: Path) -> None:
    path = mk.save(fit, tmp_path / "fit.nc")
    found = mk.load(path)
    assert isinstance(found, mk.Fit)
    assert found == fit
    assert hash(found) == hash(fit)
    assert found != fit.data
    for name in fit.data.variables:
        assert found.data[name].values.dtype.kind == fit.data[name].values.dtype.kind
        assert not found.data[name].values.flags.writeable
    assert found.data.attrs == fit.data.attrs
    assert found.table.equals(fit.table)
    test = mk.Isobaric(length="85 mm to 105 mm", pressure="1 bar", points=3)
    np.testing.assert_array_equal(found.predict(test).error, fit.predict(test).error)
    with pytest.raises(mk.SpecError, match="exists"):
        mk.save(fit, path)
    assert mk.save(fit, path, force=True) == path


def test_a_damaged_fit_is_refused(fit: mk.Fit, tmp_path: Path) -> None:
    path = mk.save(fit, tmp_path / "fit.nc")
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    for at in rng.integers(0, len(content), 40).tolist():
        path.write_bytes(content[:at] + bytes([content[at] ^ 0x10]) + content[at + 1 :])
        with pytest.raises(mk.SpecError, match=r"damaged|no NetCDF-4") as told:
            mk.load(path)
        assert "\n" not in str(told.value)
    for size in (0, 100, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(mk.SpecError, match=r"damaged|empty"):
            mk.load(path)


def test_a_result_is_no_fit_nor_the_reverse(fit: mk.Fit, tmp_path: Path) -> None:
    from mckibben.files import fits, netcdf, store

    path = mk.save(fit, tmp_path / "fit.nc")
    for load in (netcdf.load, store.load_result):
        with pytest.raises(mk.SpecError, match="holds a fit, not a result"):
            load(path)
    curve = mk.run(mk.presets.paper(), mk.Isobaric(length="85 mm to 105 mm", pressure="1 bar", points=3))
    other = mk.save(curve, tmp_path / "curve.nc")
    assert mk.load(other) == curve
    with pytest.raises(mk.SpecError, match="holds no fit"):
        fits.load(other)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.drop_vars("predicted"), "holds no predicted"),
        (lambda data: data.assign(force=data["force"].astype(str)), "holds force"),
        (lambda data: data.assign_attrs(given="ends = ["), "not TOML"),
        (lambda data: data.assign_attrs(given="ends = 'none'"), "cannot be built again"),
        (lambda data: data.assign_attrs(level="high"), "does not say its level"),
    ],
)
def test_a_fit_of_another_make_is_refused(fit: mk.Fit, tmp_path: Path, change: object, said: str) -> None:
    other = change(fit.data).assign_attrs(holds="fit")  # type: ignore[operator]
    other.to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(mk.SpecError, match=said) as told:
        mk.load(tmp_path / "other.nc")
    assert "\n" not in str(told.value)


def test_the_table_of_a_fit(fit: mk.Fit, tmp_path: Path) -> None:
    import pandas as pd

    path = mk.save(fit, tmp_path / "points.csv")
    table = pd.read_csv(path)
    np.testing.assert_allclose(table["residual [N]"], fit.residuals, rtol=1e-12)
    np.testing.assert_allclose(table["force [N]"], fit.data["force"].values, rtol=1e-14)
    assert list(table["test"]) == list(fit.data["test"].values)
    notes = (tmp_path / "points.csv.txt").read_text(encoding="utf-8")
    assert "braid.angle: " in notes
    assert "[braid]" in notes
    with pytest.raises(mk.SpecError, match="is a table only"):
        mk.load(path)


def test_the_picture_of_a_fit(fit: mk.Fit) -> None:
    figure = mk.plot(fit)
    forces, residuals, strips = figure.axes
    assert forces.get_xlabel() == residuals.get_xlabel() == "Contraction (%)"
    assert [tick.get_text() for tick in strips.get_xticklabels()] == ["0.5 bar", "1 bar"]
    drawn = np.concatenate([np.asarray(line.get_ydata()) for line in residuals.lines if line.get_marker() != "None"])
    np.testing.assert_allclose(np.sort(drawn), np.sort(fit.residuals), rtol=1e-12)
    said = figure.get_suptitle()
    assert f"rms {fit.rms:.3g} N ({fit.percent:.2g} % of the largest force)" in said
    assert f"largest difference {fit.largest:.3g} N" in said
    assert "braid.angle" in figure.get_supxlabel()
    assert "are assumed" in figure.get_supxlabel()
    with pytest.raises(mk.SpecError, match="is for a result"):
        mk.plot(fit, kind="tension")


@pytest.mark.parametrize("tests", [1, 3, 30])
@pytest.mark.parametrize("isometric", [False, True])
def test_pictures_of_many_tests(fit: mk.Fit, tests: int, isometric: bool) -> None:
    rng, count = np.random.default_rng(0), 10 * tests
    names = np.repeat([f"a test with a long name, {k}" for k in range(tests)], 10)
    levels, ramp = np.repeat(np.arange(tests), 10), np.tile(np.arange(10), tests)
    length, pressure = (0.08 + 1e-3 * levels, 1e4 * ramp) if isometric else (0.08 + 3e-3 * ramp, 1e4 * (1 + levels))
    force = 1e-3 * pressure
    columns = {"length": length, "pressure": pressure, "force": force, "predicted": force + rng.normal(size=count)}
    data = fit.data.drop_dims("point").assign({name: ("point", values) for name, values in columns.items()})
    data = data.assign(test=("point", names), branch=("point", np.array(["loading", "unloading"] * (count // 2))))
    data["undetermined"] = ("number", np.array([False, True]))
    figure = mk.plot(type(fit)(fit.muscle, fit.given, data))
    assert figure.axes[0].get_xlabel() == ("Pressure (bar)" if isometric else "Contraction (%)")
    assert len(figure.legends[0].get_texts()) <= 30
    assert "Not determined by these data: chamber.law.c1." in figure.get_supxlabel()


def test_residuals_over_both_where_both_vary(fit: mk.Fit) -> None:
    data = fit.data.assign(pressure=("point", np.linspace(1e4, 1e5, len(fit.residuals))))
    labels = {axes.get_xlabel() for axes in mk.plot(type(fit)(fit.muscle, fit.given, data)).axes}
    assert labels == {"Contraction (%)", "Pressure (bar)"}
