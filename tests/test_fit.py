"""Fits: exact derivatives, recovery of what is known, and honesty about what the data do not tell."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import t as student

import mckibben as mk
from mckibben.fitting.free import Free, free_numbers, put_in
from mckibben.fitting.misfit import Misfit, Points
from mckibben.fitting.search import least
from mckibben.fitting.uncertain import members

pytestmark = pytest.mark.fitting

MUSCLE = mk.presets.paper()
FREE = {"braid.angle": "35 deg to 39 deg", "chamber.law.c1": "2 kPa to 40 kPa"}
START = MUSCLE.replace("braid.angle", "36 deg").replace("chamber.law.c1", "15 kPa")
TURNED = MUSCLE.replace("braid.angle", "36 deg")
"""Wrong in the angle alone."""
ANGLE = {"braid.angle": FREE["braid.angle"]}
PRESSURES = (4e4, 1e5)


def curves(muscle: mk.Muscle, noise: float = 0.0, seed: int = 0, **more: Any) -> mk.Data:
    """Two isobaric tests of a muscle, eight points each."""
    found = [mk.run(muscle, mk.Isobaric(length="80 mm to 115 mm", pressure=P, points=8)) for P in PRESSURES]
    force = np.concatenate([curve.force for curve in found])
    force = force + noise * np.random.default_rng(seed).normal(size=len(force))
    table = {"length [m]": np.concatenate([curve.length for curve in found]), "force [N]": force}
    table["pressure [Pa]"] = np.concatenate([curve.pressure for curve in found])
    return mk.read_data(table | more, tests="pressure")


@pytest.fixture(scope="module")
def exact() -> mk.Data:
    return curves(MUSCLE)


@pytest.fixture(scope="module")
def noisy() -> mk.Data:
    return curves(MUSCLE, noise=0.5, seed=1)


def misfit_of(muscle: mk.Muscle, data: mk.Data, names: tuple[str, ...]) -> Misfit:
    """Around a muscle's own numbers, a tenth to either side."""
    known = {name: (float(number), unit) for name, number, unit in _numbers(muscle)}
    free = tuple(
        Free(name, known[name][1], 0.9 * known[name][0], 1.1 * known[name][0], known[name][0]) for name in names
    )
    offsets = (("length", "m", 1e-3), ("pressure", "Pa", 1e4), ("force", "N", 5.0))
    more = tuple(Free(f"offset.{name}", unit, -size, size, 0.1 * size) for name, unit, size in offsets)
    return Misfit(muscle, (*free, *more), Points.of(muscle, (data,), {}), 24)


def _numbers(muscle: mk.Muscle) -> list[tuple[str, float, str]]:
    from mckibben.spec.declared import numbers

    return [(name, float(number), declared.unit) for name, declared, number in numbers(muscle)]


FIBRE = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True, axial_stiffness="150 N")
STRETCHING = MUSCLE.replace("braid.fibre", FIBRE).replace("fittings", mk.Fittings(compliance="0.01 mm/N"))


@pytest.mark.parametrize(
    ("muscle", "names"),
    [
        (MUSCLE, ("braid.radius", "braid.angle", "chamber.law.c1", "chamber.thickness", "braid.fibre.E")),
        (STRETCHING, ("braid.angle", "braid.fibre.axial_stiffness", "fittings.compliance", "braid.length")),
    ],
    ids=["paper", "stretching"],
)
def test_derivatives(muscle: mk.Muscle, names: tuple[str, ...], exact: mk.Data) -> None:
    """Of every force by every number and offset, against central differences of states that are sought anew."""
    misfit = misfit_of(muscle, exact, names)
    x = misfit.start
    slopes, step = misfit(x).slopes, 1e-4
    for k in range(len(x)):
        there, back = (misfit(x + sign * step * (np.arange(len(x)) == k)).force for sign in (1.0, -1.0))
        assert_allclose(slopes[:, k], (there - back) / (2.0 * step), rtol=1e-5, atol=1e-6 * np.abs(slopes[:, k]).max())


def test_forces_are_those_of_a_run(exact: mk.Data) -> None:
    misfit = misfit_of(MUSCLE, exact, ("braid.angle",))
    at = misfit.start.copy()
    at[1:] = 0.5  # no offsets
    assert_allclose(misfit(at).force, exact.force, atol=2e-5 * exact.force.max())


@pytest.fixture(scope="module")
def found(noisy: mk.Data) -> mk.Fit:
    return mk.fit(START, noisy, FREE, starts=4)


def test_what_is_known_comes_back(exact: mk.Data) -> None:
    """To the error of the forces themselves."""
    fit = mk.fit(START, exact, FREE, starts=1)
    assert fit.converged
    assert_allclose(fit.values["braid.angle"], np.radians(37.0), rtol=1e-6)
    assert_allclose(fit.values["chamber.law.c1"], 8500.0, rtol=1e-4)
    assert fit.rms < 1e-4
    assert fit.muscle.braid.angle == fit.values["braid.angle"]
    assert "chamber.law.c2" in fit.muscle.assumed
    assert "chamber.law.c1" not in fit.muscle.assumed


def test_noise(found: mk.Fit) -> None:
    """The size of the noise, errors that cover the truth, and an rms that no other muscle near beats."""
    assert_allclose(found.data.attrs["force_error"], 0.5, rtol=0.4)  # 14 degrees of freedom: 19 % standard error
    for name, truth in (("braid.angle", np.radians(37.0)), ("chamber.law.c1", 8500.0)):
        low, high = found.intervals.loc[name]
        assert low < truth < high
    assert found.undetermined == ()
    assert 0.99 < found.explained < 1.0


def test_errors_are_those_of_the_linear_model(found: mk.Fit, noisy: mk.Data) -> None:
    """Covariance s^2 (J^T J)^-1, with J by central differences in the numbers themselves."""
    names = found.numbers
    misfit = Misfit(found.muscle, free_numbers(found.muscle, FREE, {}), Points.of(MUSCLE, (noisy,), {}), 24)
    x, step = misfit.start, 1e-4
    columns = []
    for k, one in enumerate(misfit.free):
        ends = [x + sign * step * (np.arange(len(x)) == k) for sign in (1.0, -1.0)]
        there, back = (misfit(end).force for end in ends)
        columns.append((there - back) / (one.value(ends[0][k]) - one.value(ends[1][k])))
    J = np.stack(columns, axis=1)
    s2 = np.sum(found.residuals**2) / (len(found.residuals) - len(names))
    assert_allclose(found.data["covariance"].values, s2 * np.linalg.inv(J.T @ J), rtol=2e-3)


def test_profiles(noisy: mk.Data, found: mk.Fit) -> None:
    """At the ends of a profile interval the sum of squares, least for the others, has grown by t^2 s^2."""
    fit = mk.fit(START, noisy, FREE, starts=1, profiles=True)
    assert_allclose(fit.data["value"], found.data["value"], rtol=1e-5)
    s2 = np.sum(fit.residuals**2) / (len(fit.residuals) - 2)
    t2 = student.ppf(0.975, len(fit.residuals) - 2) ** 2
    misfit = Misfit(START, free_numbers(START, FREE, {}), Points.of(START, (noisy,), {}), 24)
    for k, one in enumerate(misfit.free):
        for end in fit.intervals.loc[one.name]:
            other = least(misfit, misfit.start, 1.0, "linear", (k, one.x(float(end))))
            assert_allclose(2.0 * other.cost - np.sum(fit.residuals**2), t2 * s2, rtol=1e-2)
        linear = found.intervals.loc[one.name]
        assert_allclose(fit.intervals.loc[one.name], linear, atol=0.1 * (linear["high"] - linear["low"]))


def test_what_only_counts_as_a_product(noisy: mk.Data) -> None:
    """A thin wall's thickness and modulus: only a combination is determined, and no number is given for either."""
    free = {"chamber.law.c1": "2 kPa to 40 kPa", "chamber.thickness": "0.2 mm to 4 mm"}
    fit = mk.fit(START.replace("braid.angle", "37 deg"), noisy, free, starts=1)
    assert set(fit.undetermined) == set(free)
    assert set(fit.table["value"]) == {"not determined"}
    assert any("combination of chamber.law.c1 and chamber.thickness" in note for note in fit.notes)
    known = mk.fit(
        START.replace("braid.angle", "37 deg"), noisy, free, priors={"chamber.thickness": "1 mm +- 0.01 mm"}, starts=1
    )
    assert known.undetermined == ()
    assert_allclose(known.values["chamber.thickness"], 1e-3, rtol=0.01)
    low, high = known.intervals.loc["chamber.law.c1"]
    assert low < 8500.0 < high


def test_what_the_data_say_nothing_of() -> None:
    """The fibres' Poisson ratio: the paper's are so thin that it moves no force."""
    fit = mk.fit(
        START, curves(MUSCLE, 0.5), {"braid.angle": FREE["braid.angle"], "braid.fibre.nu": "0.1 to 0.45"}, starts=1
    )
    assert fit.undetermined == ("braid.fibre.nu",)
    assert any("say nothing of braid.fibre.nu" in note for note in fit.notes)


def test_instruments_that_are_off(exact: mk.Data) -> None:
    data = mk.read_data(
        {"length [m]": exact.length, "pressure [Pa]": exact.pressure, "force [N]": exact.force + 3.0}, tests="pressure"
    )
    fit = mk.fit(TURNED, data, ANGLE, offsets={"force": "5 N"}, starts=1)
    assert_allclose(fit.values["braid.angle"], np.radians(37.0), rtol=3e-4)
    assert_allclose(fit.values["offset.force"], 3.0, atol=0.03)


def test_points_far_off_count_less(noisy: mk.Data) -> None:
    force = noisy.force.copy()
    force[3] += 40.0
    table = {"length [m]": noisy.length, "pressure [Pa]": noisy.pressure, "force [N]": force}
    data = mk.read_data(table, tests="pressure")
    errors = []
    for loss in ("linear", "huber", "soft_l1", "cauchy"):
        fit = mk.fit(TURNED, data, ANGLE, loss=loss, force_error="0.5 N", starts=1)
        errors.append(abs(fit.values["braid.angle"] - np.radians(37.0)))
    assert max(errors[1:]) < 0.2 * errors[0]


def test_weights(noisy: mk.Data) -> None:
    """A test of weight 0 is as one left out; a weight of 4 is as each point four times."""
    free = {"braid.angle": FREE["braid.angle"]}
    without = mk.fit(START, noisy, free, weights={"0.4 bar": 0.0}, starts=1)
    alone = mk.fit(START, noisy["1 bar"], free, starts=1)
    assert without.values == alone.values
    weighted = mk.fit(START, noisy, free, weights={"1 bar": 4.0}, starts=1)
    several = mk.fit(START, (noisy, *[noisy["1 bar"]] * 3), free, starts=1)
    assert_allclose(weighted.values["braid.angle"], several.values["braid.angle"], rtol=1e-9)


def test_ranges_with_muscles_that_do_not_reach(exact: mk.Data) -> None:
    """At 55 deg the muscle is full length at 104 mm: the search turns back from there and goes on."""
    fit = mk.fit(TURNED, exact, {"braid.angle": "20 deg to 60 deg"}, starts=8)
    assert_allclose(fit.values["braid.angle"], np.radians(37.0), rtol=1e-6)
    with pytest.raises(mk.SpecError, match=r"points are beyond reach of all 4 muscles tried, such as .* mm at 0.4 bar"):
        mk.fit(TURNED, exact, {"braid.angle": "60 deg to 70 deg"}, starts=4)


def test_one_of_several_numbers_has_a_range() -> None:
    """A field that holds a list: each number of it by its place, read with its unit and checked like the whole."""
    narrow = mk.presets.paper().replace("end_radii", ["11 mm", "12 mm"])
    first, last = free_numbers(narrow, {"end_radii[1]": "9 mm to 12.5 mm", "end_radii[0]": (0.01, 0.012)}, {})
    assert (first.name, first.low, first.high, first.start) == ("end_radii[1]", 0.009, 0.0125, 0.012)
    assert (last.low, last.high, last.start) == (0.01, 0.012, 0.011)
    assert last.text(last.high) == "12 mm"  # in the unit of people, as a field of one number
    changed = put_in(narrow, (first, last), np.array([0.0105, 0.0115]))
    assert changed.end_radii == (0.0115, 0.0105)
    ogden = narrow.replace("chamber.law", mk.Ogden(mu=["20 kPa", "5 kPa"], alpha=[2.0, 4.0]))
    (mu,) = free_numbers(ogden, {"chamber.law.mu[1]": "1 to 10 kPa"}, {})
    assert_allclose((mu.low, mu.high), (1e3, 1e4))
    with pytest.raises(mk.SpecError, match=r"free\.end_radii\[0\] = -1 mm"):
        free_numbers(narrow, {"end_radii[0]": "-1 mm to 12 mm"}, {})


def test_prediction(found: mk.Fit) -> None:
    """The error of a predicted force is what the covariance leaves, and the truth is within three of them."""
    test = mk.Isobaric(length="85 mm to 110 mm", pressure="0.7 bar", points=4)
    prediction, truth = found.predict(test), mk.run(MUSCLE, test)
    assert (np.abs(prediction.curve.force - truth.force) < 3.0 * prediction.error).all()
    assert_allclose(prediction.high - prediction.low, 4.0 * prediction.error, rtol=1e-6)
    step = {}
    for name in found.numbers:
        size = 1e-3 * found.values[name]
        there, back = (mk.run(found.muscle.replace(name, found.values[name] + s * size), test) for s in (1.0, -1.0))
        step[name] = (there.force - back.force) / (2.0 * size)
    J = np.stack([step[name] for name in found.numbers], axis=1)
    expected = np.sqrt(np.einsum("nk,kl,nl->n", J, found.data["covariance"].values, J))
    assert_allclose(prediction.error, expected, rtol=1e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"free": {}}, "must name at least one number"),
        ({"free": {"braid.angel": "30 deg to 40 deg"}}, 'did you mean "braid.angle"'),
        ({"free": {"braid.fibres": "40 to 60"}}, "whole number"),
        ({"free": {"braid.angle": "37 deg"}}, "must be a range"),
        ({"free": {"braid.angle": "40 deg to 30 deg"}}, "from the smaller bound"),
        ({"free": {"braid.angle": "30 deg to 95 deg"}}, "below 90 deg"),
        ({"free": {"braid.angle": "30 deg to 40 mm"}}, "wrong kind of unit"),
        ({"free": FREE, "priors": {"ends": "1"}}, "is not free"),
        ({"free": FREE, "priors": {"braid.angle": "37 deg"}}, "a mean and its standard deviation"),
        ({"free": FREE, "priors": {"braid.angle": "37 deg +- 0 deg"}}, "above 0"),
        ({"free": FREE, "offsets": {"torque": "1 N"}}, "must be one of length, pressure, force"),
        ({"free": FREE, "offsets": {"force": "-1 N"}}, "above 0"),
        ({"free": FREE, "weights": {"9 bar": 1.0}}, "is no test of these data"),
        ({"free": FREE, "weights": {"1 bar": -1.0}}, "at least 0"),
        ({"free": FREE, "loss": "square"}, "must be one of linear"),
        ({"free": FREE, "force_error": "0 N"}, "above 0 N"),
        ({"free": FREE, "level": 95}, "below 1"),
        ({"free": FREE, "weights": {"1 bar": 0.0, "0.4 bar": 0.0}}, "has 0 points for 2 free numbers"),
    ],
)
def test_bad_input(options: dict[str, Any], message: str, exact: mk.Data) -> None:
    with pytest.raises(mk.SpecError, match=message):
        mk.fit(START, exact, **options)


def test_what_cannot_be_fitted(exact: mk.Data) -> None:
    with pytest.raises(mk.SpecError, match="must be what read_data gave"):
        mk.fit(START, [], FREE)


def test_which_model_the_data_need() -> None:
    """Of stretching fibres: the model that has them predicts tests it has not seen, a rigid one does not."""
    curves_at = [
        mk.run(STRETCHING, mk.Isobaric(length="80 mm to 115 mm", pressure=P, points=6)) for P in (3e4, 6e4, 1e5)
    ]
    table = {
        "length [m]": np.concatenate([curve.length for curve in curves_at]),
        "pressure [Pa]": np.concatenate([curve.pressure for curve in curves_at]),
        "force [N]": np.concatenate([curve.force for curve in curves_at]),
    }
    data = mk.read_data(table, tests="pressure")
    yields = {"fittings.compliance": "0.001 mm/N to 0.1 mm/N"}
    models = {
        "rigid": (STRETCHING.replace("fittings", mk.Fittings(compliance="1e-9 mm/N")), ANGLE),
        "giving way": (STRETCHING, ANGLE | yields),
    }
    found = mk.compare_models(models, data, starts=1)
    assert found.best == "giving way"
    assert found.errors["giving way"] < 1e-3 < found.errors["rigid"]
    assert list(found.table.index) == ["giving way", "rigid"]
    assert len(found.left_out["rigid"]) == len(data)
    with pytest.raises(mk.SpecError, match="at least two models"):
        mk.compare_models({"one": (MUSCLE, ANGLE)}, data)


def test_an_angle_from_the_axis(exact: mk.Data) -> None:
    """Ranges and answers are in the muscle's own words; the muscle found is the same."""
    braid = mk.Braid(
        radius="12.5 mm", length="85 mm", angle="54 deg", angle_from="axis", fibres=56, fibre=MUSCLE.braid.fibre
    )
    fit = mk.fit(MUSCLE.replace("braid", braid), exact, {"braid.angle": "51 deg to 55 deg"}, starts=4)
    assert_allclose(fit.values["braid.angle"], np.radians(53.0), rtol=1e-6)
    assert_allclose(fit.muscle.braid.angle, np.radians(37.0), rtol=1e-6)
    assert fit.predict(mk.Isobaric(length="100 mm", pressure="1 bar")).error.max() < 0.01


def test_a_number_that_is_zero_is_where_it_starts() -> None:
    """Inside its range, zero is a start like any other; outside, the middle is taken."""
    free = free_numbers(MUSCLE, {"chamber.law.c2": "0 kPa to 10 kPa", "chamber.law.c1": "20 kPa to 40 kPa"}, {})
    assert [one.start for one in free] == [0.0, 3e4]


def test_a_start_without_states_ends_no_search(exact: mk.Data) -> None:
    """As along a profile that meets full extension."""
    free = free_numbers(TURNED, {"braid.angle": "20 deg to 60 deg", "chamber.law.c1": "2 kPa to 40 kPa"}, {})
    misfit = Misfit(TURNED, free, Points.of(TURNED, (exact,), {}), 24)
    lost = least(misfit, np.array([0.99, 0.5]), 1.0, "linear")
    assert not lost.converged
    assert lost.cost == np.inf
    assert "beyond reach" in lost.message


def test_contractions_are_of_the_whole_rest_length() -> None:
    """With a dead length, of both; and a rest length that is itself free makes no length of a contraction."""
    muscle = MUSCLE.replace("fittings", mk.Fittings(dead_length="10 mm"))
    curve = mk.run(muscle, mk.Isobaric(length="90 mm to 105 mm", pressure="1 bar", points=4))
    table = {"contraction": curve.contraction, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
    data = mk.read_data(table)
    assert_allclose(data.lengths(muscle), curve.length, rtol=1e-12)
    fit = mk.fit(muscle.replace("braid.angle", "36 deg"), data, ANGLE, starts=1)
    assert_allclose(fit.values["braid.angle"], np.radians(37.0), rtol=1e-6)
    for name, span in (("braid.length", "80 mm to 90 mm"), ("fittings.dead_length", "5 mm to 15 mm")):
        with pytest.raises(mk.SpecError, match="refer to the rest length"):
            mk.fit(muscle, data, {name: span})


def test_models_are_compared_with_weights(exact: mk.Data) -> None:
    """A weight is of no use to a fold that leaves its test out."""
    table = {"length [m]": exact.length, "pressure [Pa]": exact.pressure, "force [N]": exact.force}
    data = mk.read_data(table | {"test": np.repeat(["a", "b", "c", "d"], len(exact) // 4)}, tests="test")
    models = {"as made": (TURNED, ANGLE), "too wide": (TURNED.replace("braid.radius", "13 mm"), ANGLE)}
    found = mk.compare_models(models, data, weights={"a": 2.0}, starts=1)
    assert found.best == "as made"
    assert_allclose(found.fits["as made"].forces(data), data.force, atol=1e-3)


def test_free_contractions_alone() -> None:
    """No force is measured but none: residuals have no per cent of it, and the fit is as good."""
    curve = mk.run(MUSCLE, mk.FreeContraction(pressure="0.4 to 1 bar", points=4))
    table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": np.zeros(4)}
    fit = mk.fit(TURNED, mk.read_data(table), ANGLE, starts=1)
    assert_allclose(fit.values["braid.angle"], np.radians(37.0), rtol=1e-6)
    assert np.isnan([fit.percent, fit.explained]).all()
    assert "%" not in repr(fit)
    assert mk.plot(fit).axes


def test_profiles_of_one_number_under_another_loss(noisy: mk.Data) -> None:
    """At the ends the loss, not the sum of squares, has grown by t^2 times the variance."""
    fit = mk.fit(TURNED, noisy, ANGLE, loss="huber", force_error="0.2 N", starts=1, profiles=True)
    free = free_numbers(TURNED, ANGLE, {})
    misfit = Misfit(TURNED, free, Points.of(TURNED, (noisy,), {}), 24)
    best = least(misfit, misfit.start, 0.2, "huber").cost
    for end in fit.intervals.loc["braid.angle"]:
        other = least(misfit, misfit.start, 0.2, "huber", (0, free[0].x(float(end)))).cost
        assert_allclose(2.0 * (other - best), student.ppf(0.975, len(noisy) - 1) ** 2, rtol=1e-2)


def test_directions_of_many_numbers() -> None:
    """Of twenty equal parts none is large, and all belong."""
    assert members(np.full(20, 20**-0.5)).all()
    assert members(np.array([0.9, 0.4, 0.17])).tolist() == [True, True, False]


LONG = MUSCLE.replace("braid.length", "120 mm")
"""Another length of the same make."""


@pytest.fixture(scope="module")
def two() -> tuple[list[mk.Muscle], list[mk.Data]]:
    """Two lengths of one make on fittings that give way: a short one loses more force by them."""
    made = [muscle.replace("fittings", mk.Fittings(compliance="0.02 mm/N")) for muscle in (MUSCLE, LONG)]
    data = []
    for muscle in made:
        held = mk.Isobaric(contraction="-0.3 to 0", pressure=1e5, points=8)
        curve = mk.run(muscle, held)
        table = {"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force}
        data.append(mk.read_data(table, tests="pressure"))
    return made, data


BOTH = {"fittings.compliance": "0.001 mm/N to 0.1 mm/N", "braid.angle": FREE["braid.angle"]}


def test_several_muscles_share_what_is_free(two: tuple[list[mk.Muscle], list[mk.Data]]) -> None:
    made, data = two
    begin = [one.replace("fittings.compliance", "0.005 mm/N").replace("braid.angle", "36 deg") for one in made]
    found = mk.fit(begin, data, BOTH, starts=1)
    assert_allclose([found.values[name] for name in BOTH], [2e-5, np.radians(37.0)], rtol=1e-6)
    assert len(found.muscles) == 2
    assert [float(one.braid.length) for one in found.muscles] == [0.085, 0.12]
    assert list(found.data["of"].values) == [0] * 8 + [1] * 8
    assert_allclose(found.forces(data), np.concatenate([one.force for one in data]), atol=1e-4)
    assert set(found.data["test"].values.tolist()) == {"muscle 1: 1 bar", "muscle 2: 1 bar"}
    # the second alone predicts its own test, and holds its own points
    second = found.one(1)
    assert (len(second.residuals), second.further) == (8, ())
    held = mk.Isobaric(contraction="-0.3 to 0", pressure=1e5, points=8)
    assert_allclose(second.predict(held).curve.force, data[1].force, atol=1e-4)
    assert_allclose(second.rest_lengths, 0.12)


def test_a_length_that_was_not_fitted_judges_a_model(two: tuple[list[mk.Muscle], list[mk.Data]]) -> None:
    """Rigid fittings fit one length and miss the other; three lengths, each left out in turn."""
    made, data = two
    models = {
        "give way": (made, {"fittings.compliance": BOTH["fittings.compliance"]}),
        "rigid": ([one.replace("fittings", None) for one in made], {"chamber.law.c1": "0.5 kPa to 40 kPa"}),
    }
    found = mk.compare_models(models, data, starts=1)
    assert found.best == "give way"
    assert found.errors["give way"] < 1e-3
    assert found.errors["rigid"] > 1.0


@pytest.mark.parametrize(
    ("muscles", "message"),
    [
        ([MUSCLE], "are 1 for 2 sets of data"),
        ([MUSCLE, LONG, LONG], "are 3 for 2 sets of data"),
        ([], "must be a muscle, or one for each of the data"),
        ([MUSCLE, LONG.replace("chamber", None)], "free.chamber.law.c1: is no number of this muscle"),
    ],
)
def test_muscles_that_do_not_go_together(muscles: Any, message: str, exact: mk.Data) -> None:
    with pytest.raises(mk.SpecError, match=message):
        mk.fit(muscles, [exact, exact], FREE)
