"""Fields, laws and the muscle: what is accepted, what is refused and in which words."""

import math
import pickle
import subprocess
import sys

import attrs
import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mckibben import spec
from mckibben.spec import Braid, Chamber, Fibre, Muscle, SpecError, presets
from mckibben.spec.fields import spec_classes
from mckibben.units import show

pytestmark = pytest.mark.spec

PROPERTY = settings(max_examples=50, deadline=None, derandomize=True, database=None)
ROD = Fibre(B1=1e-6, B2=1e-6, B3=1e-6)
BRAID = {"radius": "12.5 mm", "length": "85 mm", "angle": "37 deg", "fibres": 56}
FIBRE = {"diameter": "0.25 mm", "E": "3 GPa", "nu": 0.4}


def braid(**changes):
    return Braid(**({"fibre": ROD} | BRAID | changes))


def test_layer_0_is_light():
    """Neither JAX nor pint is imported before it is needed."""
    code = "import sys, mckibben.spec.text, mckibben.spec.presets, mckibben.files.case\n"
    code += "print(sorted({'jax', 'pint', 'scipy', 'xarray', 'rapidfuzz'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_values_are_si():
    made = braid(fibre=Fibre(**FIBRE))
    assert (made.radius, made.length, made.angle, made.fibres) == (0.0125, 0.085, math.radians(37), 56)
    assert made.fibre == Fibre(diameter=0.00025, E=3e9, nu=0.4)


def test_immutable_and_compared_by_value():
    muscle = presets.paper()
    assert muscle == presets.paper()
    assert hash(muscle) == hash(presets.paper())
    assert muscle != presets.reference()
    assert pickle.loads(pickle.dumps(muscle)) == muscle
    with pytest.raises(attrs.exceptions.FrozenInstanceError):
        muscle.braid.angle = 0.5


def test_repr_is_the_call_that_makes_it():
    names = {name: getattr(spec, name) for name in ("Braid", "Fibre", "Chamber", "Muscle", "MooneyRivlin")}
    assert eval(repr(presets.reference()), names) == presets.reference()
    assert "angle='37 deg'" in repr(presets.paper())


def test_the_range_error_in_full():
    with pytest.raises(SpecError) as caught:
        braid(angle="95 deg")
    assert str(caught.value) == (
        "braid.angle = 95 deg: must be above 0 deg and below 90 deg; "
        'give the angle from the parallels, or set angle_from = "axis"'
    )
    missing = SpecError("test", allowed="is missing")
    assert str(pickle.loads(pickle.dumps(missing))) == str(missing) == "test: is missing"
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.field, error.value, error.allowed) == (
        "braid.angle",
        "95 deg",
        "must be above 0 deg and below 90 deg",
    )


def test_an_error_is_short_whatever_the_name():
    error = SpecError("muscle." + "x" * 20000, 1.0, "unknown " + "y" * 20000)
    assert len(str(error)) < 1500
    assert len(error.field) == 20007


OWNERS = {
    "Braid": braid,
    "Chamber": lambda **given: Chamber(**({"thickness": 1e-3, "law": spec.NeoHookean(c1=1.0)} | given)),
    "NeoHookean": spec.NeoHookean,
    "Yeoh": spec.Yeoh,
    "Gent": lambda **given: spec.Gent(**({"mu": 1.0, "Jm": 1.0} | given)),
    "ArrudaBoyce": lambda **given: spec.ArrudaBoyce(**({"mu": 1.0, "lambda_m": 5.0} | given)),
    "Rubber": spec.Rubber,
    "Isometric": lambda **given: spec.Isometric(**({"length": 0.1, "pressure": 0.0} | given)),
    "Isobaric": lambda **given: spec.Isobaric(**({"length": 0.1, "pressure": 0.0} | given)),
    "Step": lambda **given: spec.Step(
        **({"force": 0.0} if "length" not in given else {}),
        **({"pressure": 0.0} if "volume" not in given and "pressure" not in given else {}),
        **given,
    ),
}
BOUNDED = [
    (cls.__name__, field)
    for cls in spec_classes()
    for field in spec.describe(cls)
    if cls.__name__ in OWNERS and field.kind in ("quantity", "path", "held") and field.allowed
] + [("Fibre", field) for field in spec.describe(Fibre) if field.kind == "quantity"]


def fibre_with(name, value):
    given = {"B1": 1e-6, "B2": 1e-6, "B3": 1e-6} if name.startswith("B") else FIBRE
    return Fibre(**(given | {name: value}))


@settings(PROPERTY, max_examples=200)
@given(st.sampled_from(BOUNDED), st.data())
def test_out_of_range_names_field_and_range(case, data):
    owner, field = case
    sides = []
    if field.low > -math.inf:
        sides.append(st.floats(max_value=field.low, exclude_max=not field.low_open, allow_infinity=False))
    if field.high < math.inf:
        sides.append(st.floats(min_value=field.high, exclude_min=not field.high_open, allow_infinity=False))
    value = data.draw(st.one_of(sides))
    with pytest.raises(SpecError) as caught:
        fibre_with(field.name, value) if owner == "Fibre" else OWNERS[owner](**{field.name: value})
    assert caught.value.field.endswith(f".{field.name}")
    assert caught.value.allowed == f"must be {field.allowed}"
    assert "\n" not in str(caught.value)


def test_the_range_cases_cover_every_bounded_number():
    assert {(owner, field.name) for owner, field in BOUNDED} >= {
        ("Braid", "radius"), ("Braid", "length"), ("Braid", "angle"), ("Chamber", "thickness"), ("Fibre", "nu"),
        ("Fibre", "diameter"), ("Fibre", "E"), ("Fibre", "B3"), ("Step", "volume"), ("Isometric", "pressure"),
    }  # fmt: skip


def test_angle_from_axis_is_converted_once():
    made = braid(angle="53 deg", angle_from="axis")
    assert made.angle == pytest.approx(math.radians(37), abs=1e-15)
    assert made.angle_from == "parallels"
    assert braid(angle=made.angle) == made
    assert attrs.evolve(made, radius=0.02).angle == made.angle


@pytest.mark.parametrize("count", [0, 1, 7, -2, 56.5, "56", None, True, 200_000])
def test_fibres_must_be_even_and_whole(count):
    with pytest.raises(SpecError) as caught:
        braid(fibres=count)
    assert caught.value.field == "braid.fibres"


@pytest.mark.parametrize("count", [[40, 56], (56,), {"at": [0.5], "fibres": [40]}, np.array([40, 56]), lambda v: 56])
def test_fibres_do_not_end_within_a_braid(count):
    """What is refused says why, and what may vary along the length."""
    said = r"braid\.fibres.*one whole number all along.*would hold nothing; vary the angle.*braid\.angle_profile"
    with pytest.raises(SpecError, match=said) as caught:
        braid(fibres=count)
    assert caught.value.field == "braid.fibres"


def test_fibres_that_do_not_fit_side_by_side():
    """Neighbours of one hand are 2 pi R0 sin(theta0)/(N/2) apart; the advice given can be followed, but no more."""
    thick = Fibre(diameter="1 mm", E=1e9, nu=0.3)
    with pytest.raises(SpecError, match=r"use at most 94 fibres or a diameter of at most 0\.945") as caught:
        braid(fibres=100, fibre=thick)
    assert caught.value.field == "braid.fibres"
    room = 2 * math.pi * 12.5 * math.sin(math.radians(37))  # mm
    assert room / 47 >= 1.0 > room / 48
    assert braid(fibres=94, fibre=thick).fibres == 94
    with pytest.raises(SpecError):
        braid(fibres=96, fibre=thick)
    advised = str(caught.value).rpartition("at most ")[2]
    assert braid(fibres=100, fibre=Fibre(diameter=advised, E=1e9, nu=0.3)).fibres == 100
    with pytest.raises(SpecError, match="overlap"):
        braid(fibres=100, fibre=Fibre(diameter="0.946 mm", E=1e9, nu=0.3))
    with pytest.raises(SpecError, match="overlap"):  # a diameter beside stiffnesses is checked too
        braid(fibres=100, fibre=Fibre(diameter="1 mm", B1=1, B2=1, B3=1))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "diameter and E and nu missing"),
        ({"diameter": 1e-3, "E": 1e9}, "nu missing"),
        ({"E": 1e9, "nu": 0.3}, "diameter missing"),
        ({"B1": 1, "B3": 1}, "B2 missing"),
        ({"B1": 1, "B2": 1, "B3": 1, "E": 1e9}, "both B1 and B2 and B3 and E are given"),
    ],
)
def test_a_fibre_is_described_in_exactly_one_way(given, words):
    with pytest.raises(SpecError, match=words) as caught:
        Fibre(**given)
    assert caught.value.field == "braid.fibre"


def test_stiffnesses_of_a_round_fibre():
    b1, b2, b3 = Fibre(**FIBRE).stiffnesses
    assert b1 == b2 == pytest.approx(3e9 * math.pi * 0.25e-3**4 / 64)
    assert b3 == pytest.approx(3e9 / 2.8 * math.pi * 0.25e-3**4 / 32)
    assert ROD.stiffnesses == (1e-6, 1e-6, 1e-6)


@pytest.mark.parametrize(
    ("law", "modulus"),
    [
        (spec.MooneyRivlin(c1=0, c2="10 kPa"), 20e3),
        (spec.MooneyRivlin(c1="30 kPa", c2="-10 kPa"), 40e3),
        (spec.NeoHookean(c1="10 kPa"), 20e3),
        (spec.Yeoh(c1="10 kPa", c2=-5.0), 20e3),
        (spec.Ogden(mu=["20 kPa", -1e3], alpha=(2, -2)), 21e3),
        (spec.Gent(mu="20 kPa", Jm=30), 20e3),
        (spec.ArrudaBoyce(mu="20 kPa", lambda_m=3), 20e3 * (1 + 1 / 15 + 11 / 1575 + 19 / 23625 + 173 / 1819125)),
        (spec.Rubber(E="60 kPa"), 20e3),
    ],
)
def test_shear_modulus(law, modulus):
    assert law.shear_modulus == pytest.approx(modulus)
    assert spec.LAWS[law.name] is type(law)


@pytest.mark.parametrize(
    "make",
    [
        lambda: spec.MooneyRivlin(c1=1, c2=-1),
        lambda: spec.MooneyRivlin(c1=0),
        lambda: spec.NeoHookean(c1=0),
        lambda: spec.Yeoh(c1=-1, c2=1),
        lambda: spec.Ogden(mu=[1.0], alpha=[-2.0]),
        lambda: spec.Ogden(mu=[1.0, 2.0], alpha=[2.0]),
        lambda: spec.Ogden(mu=[1.0, 0.0], alpha=[2.0, 0.0]),
        lambda: spec.Ogden(mu=[], alpha=[]),
        lambda: spec.Ogden(mu=1.0, alpha=2.0),
        lambda: spec.Gent(mu=1, Jm=0),
        lambda: spec.ArrudaBoyce(mu=1, lambda_m=1),
        lambda: spec.CustomLaw(function=3),
        lambda: spec.CustomLaw(function=max, constants={"a": "1 kPa"}),
        lambda: spec.CustomLaw(function=max, constants=[1.0]),
    ],
)
def test_laws_without_stiffness_or_sense(make):
    with pytest.raises(SpecError, match=r"^chamber\.law\."):
        make()


def test_custom_law():
    constants = {"a": 1.0}
    law = spec.CustomLaw(function=max, constants=constants)
    constants["a"] = 2.0
    assert dict(law.constants) == {"a": 1.0}
    assert law == spec.CustomLaw(function=max, constants={"a": 1})
    assert hash(law) == hash(spec.CustomLaw(function=max, constants={"a": 1}))


def test_parts_must_be_objects():
    with pytest.raises(SpecError, match=r"^braid\.fibre = .* must be a Fibre; write fibre=mk\.Fibre"):
        braid(fibre={"B1": 1})
    with pytest.raises(SpecError, match="must be a MooneyRivlin or NeoHookean"):
        Chamber(thickness=1e-3, law="gent")
    with pytest.raises(SpecError, match=r"did you mean \"clamped\""):
        Muscle(braid=braid(), ends="clampd")
    with pytest.raises(SpecError, match="must be text"):
        Muscle(braid=braid(), name=3)


def test_ends_are_words():
    assert Muscle(braid=braid()).ends == "clamped"
    assert Muscle(braid=braid(), ends="free").ends == "free"


def test_replace():
    muscle = presets.paper()
    other = muscle.replace("braid.angle", "36 deg")
    assert other.braid.angle == math.radians(36)
    assert other.name == "paper (changed)"
    assert other.replace("braid.angle", muscle.braid.angle).replace("name", "paper") == muscle
    bare = muscle.replace("chamber", None)
    assert bare.chamber is None
    assert not any(name.startswith("chamber") for name in bare.assumed)
    assert "ends" not in muscle.replace("ends", "pinned").assumed
    assert set(muscle.assumed) - set(muscle.replace("braid.fibre", ROD).assumed) == {
        "braid.fibre.diameter", "braid.fibre.E", "braid.fibre.nu",
    }  # fmt: skip
    assert muscle.replace("assumed", ()).assumed == ()


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("braid.angel", r'is no field of this muscle; did you mean "braid.angle"'),
        ("brade.angle", 'did you mean "braid.angle"'),
        ("braid.angle.deg", "is no field"),
        ("braid.angle_from", "must be one of parallels, axis"),
        ("", "is no field"),
        ("chamber.law.c3", 'did you mean "chamber.law.c1"'),
    ],
)
def test_replace_suggests_the_nearest_name(field, words):
    with pytest.raises(SpecError, match=words):
        presets.paper().replace(field, 1.0)


def test_replace_inside_a_missing_part():
    with pytest.raises(SpecError, match="this muscle has no chamber"):
        Muscle(braid=braid()).replace("chamber.thickness", "1 mm")


def test_assumed_names_must_exist():
    with pytest.raises(SpecError, match=r'did you mean "braid.fibres"'):
        Muscle(braid=braid(), assumed=("braid.fibers",))


def test_jax_numbers_pass_through():
    """The converters and the cross checks let tracers by, so that every number can be differentiated."""

    def modulus_and_angle(x):
        made = braid(radius=x[0], angle=x[1], angle_from="axis", fibre=Fibre(diameter=x[2], E=1e9, nu=x[3]))
        law = spec.MooneyRivlin(c1=x[4], c2=x[4])
        muscle = Muscle(braid=made, chamber=Chamber(thickness=x[5], law=law)).replace("braid.length", x[6])
        step = spec.Isometric(length=x[7], pressure=0.0).as_steps(muscle)[0]
        held = step.length.waypoints[0]
        return made.radius + 2 * made.angle + 3 * made.fibre.diameter + law.shear_modulus + muscle.braid.length + held

    slope = jax.grad(modulus_and_angle)(jax.numpy.full(8, 0.3))
    assert slope.tolist() == [1.0, -2.0, 3.0, 0.0, 4.0, 0.0, 1.0, 1.0]


def test_every_field_is_described():
    for cls in spec_classes():
        for field in spec.describe(cls):
            assert field.meaning, f"{cls.__name__}.{field.name}"
            assert field.unit or field.kind not in ("quantity", "quantities", "path", "held")
    page = spec.reference_markdown()
    assert all(f"## {cls.__name__}\n" in page for cls in spec_classes())
    assert "| `angle` | braid angle theta0 between fibres and parallels | rad | above 0 deg and below 90 deg |" in page


def test_walk_visits_every_number():
    found = {name: value for name, _, value in spec.walk(presets.paper())}
    assert found["chamber.law.c1"] == 8500.0
    assert found["braid.fibre.E"] == 3e9
    assert "braid.angle_from" not in found


def test_presets():
    paper = presets.paper()
    assert presets.names()[:2] == ("paper", "reference")  # then the catalogue: test_catalogue.py
    assert presets.get("paper") == paper
    assert (paper.braid.radius, paper.braid.length, show(paper.braid.angle, "rad")) == (0.0125, 0.085, "37 deg")
    assert presets.reference().braid.fibre.stiffnesses == (0.575e-6, 0.575e-6, 0.41e-6)
    for name in presets.names():
        muscle, sources = presets.get(name), presets.sources(name)
        shown = {field for field, _, value in spec.walk(muscle) if value is not None} - {"name", "assumed"}
        assert set(sources) == shown
        assert {field for field, source in sources.items() if source.startswith("assumed")} == set(muscle.assumed)
    assert not {"braid.radius", "braid.length", "braid.angle"} & set(paper.assumed)
    with pytest.raises(SpecError, match='did you mean "paper"'):
        presets.get("papr")
