"""`Rubber`: its stiffness, what it refuses, how an estimate is marked, and the new laws through every call."""

import contextlib
import json
import math
import tomllib

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import mckibben as mk
from mckibben import spec
from mckibben.app.cli import app
from mckibben.model.chamber import energy_density
from mckibben.model.parameters import parameters
from mckibben.spec.rubber import stiffness_of_shore
from mckibben.spec.text import Case, from_mapping, to_toml

pytestmark = pytest.mark.spec

PROPERTY = settings(max_examples=100, deadline=None, derandomize=True, database=None)
PAPER = mk.presets.paper()
HARD = "chamber.law.shore"
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)


def with_law(law: object) -> mk.Muscle:
    return PAPER.replace("chamber.law", law)


def test_shore_by_gents_relation() -> None:
    """0.0981 (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa, by hand: 27.929/24.448 at 30 A."""
    assert stiffness_of_shore(30.0) == pytest.approx(1.14237e6, rel=1e-5)
    moduli = [stiffness_of_shore(float(shore)) for shore in range(20, 81)]
    assert moduli == sorted(moduli)
    ruess = [1e6 * 10.0 ** (0.0235 * shore - 0.6403) for shore in range(20, 81)]
    ratio = dict(zip(range(20, 81), (other / gent for other, gent in zip(ruess, moduli, strict=True)), strict=True))
    # what the docstring says of the two
    assert all(abs(ratio[shore] - 1.0) < 0.1 for shore in range(20, 36))
    assert (round(ratio[50], 1), round(ratio[80], 1)) == (1.4, 1.9)


@PROPERTY
@given(st.floats(1e2, 1e12))
def test_rubber_is_neo_hookean_to_the_last_bit(E: float) -> None:
    mine, other = mk.Rubber(E=E), mk.NeoHookean(c1=E / 6.0)
    assert (mine.c1, mine.shear_modulus) == (other.c1, other.shear_modulus)
    assert mine.shear_modulus == pytest.approx(E / 3.0, rel=3e-16)


def test_the_energy_of_rubber_is_neo_hookean_to_the_last_bit() -> None:
    for law in (mk.Rubber(E="1.1 MPa"), mk.Rubber(shore=47)):
        mine, other = (parameters(with_law(given)).law for given in (law, mk.NeoHookean(c1=law.youngs_modulus / 6.0)))
        assert type(mine) is type(other)
        for hoop in (0.7, 1.3):
            assert float(energy_density(hoop, 1.2, 1.0 / (1.2 * hoop), mine)) == float(
                energy_density(hoop, 1.2, 1.0 / (1.2 * hoop), other)
            )


@pytest.mark.parametrize("said", ["30A", "30 A", "30a", "A30", "A 30", "A-30", "Shore A 30", "30 Shore A", "30", 30])
def test_ways_to_say_a_hardness(said: object) -> None:
    law = mk.Rubber(shore=said)
    assert law == mk.Rubber(shore=30.0)
    assert law.E is None
    assert repr(law) == "Rubber(shore=30.0)  # E = 1.14 MPa, estimated by Gent 1958"
    assert eval(repr(law), {"Rubber": mk.Rubber}) == law


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ({}, "chamber.law", 'neither E nor shore is given; give E = "1 MPa" or shore = "30A"'),
        ({"E": "1 MPa", "shore": "30A"}, "chamber.law", "both E and shore are given; give one of them"),
        ({"E": "-1 MPa"}, "chamber.law.E", "must be above 0 MPa"),
        ({"E": 0}, "chamber.law.E", "must be above 0 MPa"),
        ({"E": 1.2}, "chamber.law.E", "is beyond what can be computed: 0.0001 MPa to 1e+06 MPa; check its unit"),
        ({"E": "30A"}, "chamber.law.E", "wrong kind of unit"),
        ({"E": math.nan}, "chamber.law.E", "must be a finite number"),
        ({"shore": "10A"}, HARD, "must be at least 20 and at most 80; outside that range, hang a weight on a strip"),
        ({"shore": 80.5}, HARD, "must be at least 20 and at most 80"),
        ({"shore": "-30A"}, HARD, "must be at least 20"),
        ({"shore": math.inf}, HARD, "must be a finite number"),
        ({"shore": True}, HARD, "must be a number"),
        ({"shore": "30D"}, HARD, "no other scale is turned into a stiffness; hang a weight on a strip and give E"),
        ({"shore": "D30"}, HARD, "no other scale"),
        ({"shore": "00-30"}, HARD, "no other scale"),
        ({"shore": "30 OO"}, HARD, "no other scale"),
        ({"shore": "A30D"}, HARD, "no other scale"),
        ({"shore": "1 MPa"}, HARD, 'must be a Shore A hardness, such as "30A"'),
        ({"shore": "soft"}, HARD, 'must be a Shore A hardness, such as "30A"'),
        ({"shore": ""}, HARD, 'must be a Shore A hardness, such as "30A"'),
        ({"shore": "30,5A"}, HARD, 'write a decimal point: "30.5"'),
    ],
)
def test_what_is_refused(given: dict[str, object], field: str, words: str) -> None:
    with pytest.raises(mk.SpecError) as caught:
        mk.Rubber(**given)
    assert caught.value.field == field
    assert words in str(caught.value)
    if field == HARD:
        assert caught.value.value == given["shore"]  # all of it, not the number alone


TEXTS = st.text(st.characters(codec="utf-8"), max_size=12)
NEARLY = st.from_regex(r"[a-zA-Z0]{0,3}[ -]?-?[0-9.,]{0,4}[ a-zA-Z0]*")


@PROPERTY
@given(TEXTS | NEARLY)
def test_any_text_is_a_hardness_or_an_error(said: str) -> None:
    law = None
    with contextlib.suppress(mk.SpecError):  # nothing else may come of it
        law = mk.Rubber(shore=said)
    assert law is None or 20.0 <= law.shore <= 80.0


def test_an_estimate_is_always_assumed() -> None:
    muscle = with_law(mk.Rubber(shore="30A"))
    assert HARD in muscle.assumed
    assert HARD in muscle.replace("assumed", ()).assumed
    assert muscle.replace("assumed", (HARD, "ends")).assumed == (HARD, "ends")
    assert HARD in muscle.replace(HARD, "40A").assumed
    assert HARD not in with_law(mk.Rubber(E="1 MPa")).assumed
    assert HARD not in muscle.replace("chamber.law", mk.NeoHookean(c1="0.1 MPa")).assumed
    assert HARD not in muscle.replace("chamber", None).assumed


def test_one_replaces_the_other() -> None:
    soft = with_law(mk.Rubber(shore="30A"))
    measured = soft.replace("chamber.law.E", "1 MPa")
    assert measured.chamber.law == mk.Rubber(E=1e6)
    assert HARD not in measured.assumed
    again = measured.replace(HARD, "A30")
    assert again.chamber.law == soft.chamber.law
    assert HARD in again.assumed
    mine = {"preset": "paper", "chamber": {"law": {"name": "rubber", "shore": "30A"}}}
    assert from_mapping({"muscle": mine}, test_required=False).muscle.chamber.law == soft.chamber.law


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ('{ name = "rubber", E = "1.1 MPa" }', mk.Rubber(E="1.1 MPa")),
        ('{ name = "rubber", shore = "30A" }', mk.Rubber(shore=30)),
        ('{ name = "rubber", shore = 30 }', mk.Rubber(shore=30)),
        ('{ name = "arruda-boyce", mu = "17 kPa", lambda_m = 4 }', mk.ArrudaBoyce(mu=17e3, lambda_m=4)),
    ],
)
def test_laws_in_a_file(law: str, said: object) -> None:
    text = f'[muscle]\npreset = "paper"\n[muscle.chamber]\nlaw = {law}\n'
    case = from_mapping(tomllib.loads(text), test_required=False)
    assert case.muscle.chamber.law == said
    written = to_toml(Case(case.muscle, TEST))
    assert from_mapping(tomllib.loads(written)) == Case(case.muscle, TEST)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ('{ name = "rubber" }', "chamber.law: neither E nor shore is given"),
        ('{ name = "rubber", E = "1 MPa", shore = "30A" }', "chamber.law: both E and shore are given"),
        ('{ name = "rubber", shore = "30D" }', "chamber.law.shore = 30D: must be a Shore A hardness"),
        ('{ name = "rubber", mu = "1 MPa" }', "chamber.law.mu: unknown key; choose from E, shore"),
        ('{ name = "arruda-boyce", mu = "1 MPa" }', "chamber.law.lambda_m: is missing: chain stretch at which chains"),
        ('{ name = "arruda-boyce", mu = "1 MPa", lambda_m = 0.9 }', "chamber.law.lambda_m = 0.9: must be above 1"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(law: str, words: str) -> None:
    text = f'[muscle]\npreset = "paper"\n[muscle.chamber]\nlaw = {law}\n'
    with pytest.raises(mk.SpecError) as caught:
        from_mapping(tomllib.loads(text), test_required=False)
    assert words in str(caught.value)


def test_check_marks_the_estimate(tmp_path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(to_toml(Case(with_law(mk.Rubber(shore="30A")), TEST)), encoding="utf-8")
    done = CliRunner().invoke(app, ["check", str(path)], env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    (row,) = [line for line in done.output.splitlines() if HARD in line]
    assert "30 A (E = 1.14 MPa, estimated by Gent 1958)" in row
    assert "ASSUMED" in row
    assert any("chamber.law " in line and "rubber" in line for line in done.output.splitlines())
    told = json.loads(CliRunner().invoke(app, ["check", str(path), "--json"]).output)
    assert HARD in told["assumed"]


def test_results_of_rubber_are_those_of_neo_hookean() -> None:
    E = stiffness_of_shore(30.0)
    one, same, other = (
        mk.run(with_law(law), TEST) for law in (mk.Rubber(shore="30A"), mk.Rubber(E=E), mk.NeoHookean(c1=E / 6.0))
    )
    assert np.array_equal(one.force, other.force)
    assert np.array_equal(same.force, other.force)
    assert HARD in one.attributes["assumed"]
    assert HARD not in same.attributes["assumed"]


def test_sweeps_take_stiffness_and_hardness_anew() -> None:
    soft = with_law(mk.Rubber(shore="30A"))
    for field, values in (("chamber.law.E", ["0.2 MPa", "1 MPa"]), (HARD, ["25A", 40])):
        data = mk.sweep(soft, TEST, over={field: values})
        laws = [mk.Rubber(**{field.rpartition(".")[2]: value}) for value in values]
        assert (data.verdict == 0).all()
        alone = np.array([mk.run(with_law(law), TEST).force for law in laws])
        np.testing.assert_allclose(data.force.values, alone, rtol=1e-6)
    assert data[HARD].values.tolist() == [25.0, 40.0]
    table = mk.sweep(soft, TEST, designs={"chamber.law.shore [A]": [25, 40]})
    assert np.array_equal(table.force.values, data.force.values)
    limits = mk.sweep(with_law(mk.ArrudaBoyce(mu="17 kPa", lambda_m=3)), TEST, over={"chamber.law.lambda_m": [2, 100]})
    assert float(limits.force[0, -1]) > float(limits.force[1, -1])


@pytest.mark.parametrize("law", [mk.Rubber(shore=30), mk.Rubber(E=1e6), mk.ArrudaBoyce(mu=17e3, lambda_m=2.5)])
def test_derivatives_by_the_constants(law: object) -> None:
    """`sensitivity` against central differences of whole runs."""
    muscle = with_law(law)
    found = mk.sensitivity(muscle, TEST, of="force", by="chamber.law", tolerance=1e-9)
    assert list(found.absolute.index) == [f"chamber.law.{name}" for name, _, _ in spec.numbers(law)]
    for field in found.absolute.index:
        assert float(found.absolute.loc[field, "force"]) == pytest.approx(difference(muscle, field), rel=1e-5)


def difference(muscle: mk.Muscle, field: str) -> float:
    """The central difference of the last force by a constant of the law."""
    value = getattr(muscle.chamber.law, field.rpartition(".")[2])
    more, less = (muscle.replace(field, value * (1.0 + step)) for step in (1e-3, -1e-3))
    ends = [mk.run(changed, TEST, tolerance=1e-9).force[-1] for changed in (more, less)]
    return float(ends[0] - ends[1]) / (2e-3 * value)


def test_derivatives_inside_jax() -> None:
    soft = with_law(mk.Rubber(shore=30))
    slope = jax.grad(lambda muscle: mk.response(muscle, TEST)["force"][-1])(soft)
    assert float(slope.chamber.law.shore) == pytest.approx(difference(soft, HARD), rel=1e-4)
    assert slope.chamber.law.E is None


def test_arruda_boyce_stiffens_a_muscle() -> None:
    """With chains that nearly lock it pulls more than without a limit, and that is neo-Hookean."""
    locking, free = (mk.ArrudaBoyce(mu="17 kPa", lambda_m=limit) for limit in (1.5, 1e4))
    near, far, plain = (mk.run(with_law(law), TEST).force[-1] for law in (locking, free, mk.NeoHookean(c1="8.5 kPa")))
    assert far == pytest.approx(plain, rel=1e-7)
    assert near > plain + 0.1
