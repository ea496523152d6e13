"""Case files: mapping -> spec -> mapping, overrides, and one clear line for everything wrong."""

import copy
import math
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import CASE

from mckibben import spec
from mckibben.files.case import read_case
from mckibben.spec import SpecError, presets
from mckibben.spec.plausible import trusted
from mckibben.spec.text import Case, apply_overrides, from_mapping, to_mapping, to_toml

pytestmark = pytest.mark.spec

PROPERTY = settings(max_examples=50, deadline=None, derandomize=True, database=None)
GOOD = tomllib.loads(CASE)


def test_the_file_of_the_design():
    case = from_mapping(GOOD)
    assert case.muscle == presets.paper().replace("assumed", ()).replace("name", None)
    assert case.test == spec.Isometric(length="115 mm", pressure="0 to 1 bar")


def call(cls, **given):
    """Strategy for a constructor and its arguments. The run-time type checker draws random numbers, which hypothesis
    forbids while it makes examples, so nothing of the package is called before the test itself does."""
    return st.fixed_dictionaries(given).map(lambda kwargs: (cls, kwargs))


def made(recipe):
    """What a drawn recipe makes."""
    if isinstance(recipe, tuple) and recipe and isinstance(recipe[0], type):
        cls, kwargs = recipe
        return cls(**{name: made(value) for name, value in kwargs.items()})
    return [made(item) for item in recipe] if isinstance(recipe, list) else recipe


positive = st.floats(min_value=1e-6, max_value=1e6)
lengths = st.floats(min_value=1e-3, max_value=1.0)
moduli = st.floats(min_value=1.0, max_value=1e6)
numbers = st.floats(min_value=-1e5, max_value=1e5)
laws = st.one_of(
    call(spec.MooneyRivlin, c1=moduli, c2=st.floats(0.0, 1e6)),
    call(spec.NeoHookean, c1=moduli),
    call(spec.Yeoh, c1=moduli, c2=numbers, c3=numbers),
    call(spec.Ogden, mu=st.tuples(moduli, moduli), alpha=st.tuples(st.floats(0.01, 100.0), st.floats(0.01, 100.0))),
    call(spec.Gent, mu=moduli, Jm=st.floats(1e-3, 1e6)),
    call(spec.ArrudaBoyce, mu=moduli, lambda_m=st.floats(1.001, 1e3)),
    call(spec.Rubber, E=st.floats(1e2, 1e6)),
    call(spec.Rubber, shore=st.floats(20.0, 80.0)),
)
stiffnesses = st.floats(1e-12, 1e3)
fibres = st.one_of(
    call(spec.Fibre, B1=stiffnesses, B2=stiffnesses, B3=stiffnesses, natural=st.sampled_from(["helical", "straight"])),
    call(spec.Fibre, diameter=st.floats(1e-7, 1e-6), E=st.floats(1e6, 1e12), nu=st.floats(-0.9, 0.5),
         breaking_force=positive),
)  # fmt: skip
even = st.integers(1, 40).map(lambda half: 2 * half)
braids = call(spec.Braid, radius=lengths, length=lengths, angle=st.floats(0.1, 1.5), fibre=fibres, fibres=even)
muscles = call(
    spec.Muscle,
    braid=braids,
    chamber=st.none() | call(spec.Chamber, thickness=lengths, law=laws),
    ends=st.sampled_from(["clamped", "pinned", "free"]),
    name=st.none() | st.text(st.characters(codec="utf-8"), max_size=10),
    assumed=st.sampled_from([(), ("braid.fibres",), ("braid.angle", "ends")]),
)
ramps = st.lists(numbers, min_size=2, max_size=4).map(lambda values: " to ".join(f"{value!r} Pa" for value in values))
pressures = st.one_of(numbers, st.lists(numbers, min_size=1, max_size=5), ramps, ramps.map("to {}".format))
steps = st.one_of(
    call(spec.Step, length=lengths, pressure=pressures | st.just("hold")),
    call(spec.Step, force=numbers | st.just("to 0 N"), volume=positive),
)
tests = st.one_of(
    st.none(),
    call(spec.Isometric, length=lengths, pressure=pressures),
    call(spec.Isobaric, length=st.lists(lengths, min_size=1, max_size=3), pressure=numbers),
    call(spec.Isotonic, force=numbers, pressure=pressures),
    call(spec.BlockedForce, pressure=pressures, length=st.none() | lengths),
    call(spec.FreeContraction, pressure=pressures),
    call(spec.Protocol, steps=st.lists(steps, min_size=1, max_size=3)),
    steps,
)


@settings(PROPERTY, max_examples=100)
@given(call(Case, muscle=muscles, test=tests))
def test_what_is_written_reads_back_equal(recipe):
    with trusted():  # bare numbers of any size; what is written of them is read back with doubts
        case = made(recipe)
    mapping = to_mapping(case)
    again = from_mapping(copy.deepcopy(mapping), test_required=False)
    assert again == case
    assert to_mapping(again) == mapping
    assert from_mapping(tomllib.loads(to_toml(case)), test_required=False) == case


@PROPERTY
@given(st.floats(1.0, 99.9), st.floats(1.0, 89.0))
def test_text_with_units_equals_si_floats(radius, angle):
    spelt, plain = copy.deepcopy(GOOD), copy.deepcopy(GOOD)
    spelt["muscle"]["braid"] |= {"radius": f"{radius!r} cm", "angle": f"{angle!r} deg", "fibres": 2}
    plain["muscle"]["braid"] |= {"radius": radius / 100, "angle": math.radians(angle), "fibres": 2}
    one, other = from_mapping(spelt).muscle.braid, from_mapping(plain).muscle.braid
    assert one.radius == pytest.approx(other.radius, rel=2e-16)
    assert one.angle == other.angle


junk = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.dates(), st.binary(max_size=3),
        st.sampled_from(["paper", "1 mm", "0 to 1 bar", "hold", "none", "isometric", "protocol", "gent", "custom"]),
    ),
    lambda inner: st.lists(inner, max_size=3)
    | st.dictionaries(
        st.text(max_size=4) | st.integers()
        | st.sampled_from(["muscle", "test", "braid", "chamber", "fibre", "law", "name", "kind", "steps", "preset",
                           "length", "pressure", "points", "E", "B1", "assumed", "angle_from"]),
        inner, max_size=4,
    ),
    max_leaves=12,
)  # fmt: skip


def places(table, at=()):
    """The key paths of everything in a mapping."""
    for key, value in table.items():
        yield (*at, key)
        if isinstance(value, dict):
            yield from places(value, (*at, key))


def put(table, at, value):
    result = copy.deepcopy(table)
    inner = result
    for key in at[:-1]:
        inner = inner[key]
    inner[at[-1]] = value
    return result


def only_spec_errors(mapping):
    """Any other exception gets through and fails the test."""
    said = ""
    try:
        from_mapping(mapping)
    except SpecError as error:
        said = str(error)
    assert "\n" not in said
    assert len(said) < 500


@settings(PROPERTY, max_examples=150)
@given(junk)
def test_garbage_raises_nothing_but_spec_errors(mapping):
    only_spec_errors(mapping)
    only_spec_errors({"muscle": mapping, "test": mapping})


@settings(PROPERTY, max_examples=300)
@given(st.sampled_from(list(places(GOOD))), junk, st.booleans())
def test_garbage_in_one_place_raises_nothing_but_spec_errors(at, value, over_preset):
    base = put(GOOD, ("muscle", "preset"), "paper") if over_preset else GOOD
    only_spec_errors(put(base, at, value))


@PROPERTY
@given(
    st.lists(st.text(max_size=20) | st.sampled_from(["braid.angle=[", "test.pressure=1\nb=2", "test=3"]), max_size=3)
)
def test_garbage_overrides_raise_nothing_but_spec_errors(overrides):
    try:
        mapping = apply_overrides(GOOD, overrides)
    except SpecError:
        return
    only_spec_errors(mapping)


@pytest.mark.parametrize(
    ("at", "value", "message"),
    [
        (("muscle", "braid", "angle"), "95 deg", "braid.angle = 95 deg: must be above 0 deg and below 90 deg; "),
        (("muscle", "braid", "radius"), "12 s", 'braid.radius = 12 s: has the wrong kind of unit, "s"; '),
        (("muscle", "braid", "radius"), "12", 'braid.radius = 12: needs a unit; write it like "12.5 mm"'),
        (("muscle", "braid", "radius"), True, "braid.radius = True: must be a number; "),
        (("muscle", "braid", "angel"), 1, 'muscle.braid.angel: unknown key; did you mean "angle"?'),
        (("muscle", "braid"), 5, "braid = 5: must be a table; write [muscle.braid] with its keys below"),
        (("muscle", "braid", "fibre"), {"B1": 1.0}, "braid.fibre: B2 and B3 missing; give all of B1, B2, B3"),
        (("muscle", "chamber", "law"), {"c1": 1.0}, "chamber.law.name: is missing; choose from mooney-rivlin"),
        (
            ("muscle", "chamber", "law", "name"),
            "mooney",
            'chamber.law.name = mooney: is unknown; did you mean "mooney-',
        ),
        (("muscle", "chamber", "law", "name"), "custom", "chamber.law: a law of your own is a Python function"),
        (("muscle", "ends"), "fixed", "muscle.ends = fixed: must be one of clamped, pinned, free"),
        (("muscle", "assumed"), ["braid.fibers"], "muscle.assumed = braid.fibers: is no field of this muscle; did you"),
        (("muscle", "preset"), "papr", 'muscle.preset = papr: there is no such preset; did you mean "paper"?'),
        (("test", "kind"), "isomtric", 'test.kind = isomtric: is unknown; did you mean "isometric"?'),
        (("test", "lenght"), 1, 'test.lenght: unknown key; did you mean "length"?'),
        (("test", "pressure"), "0 to 1 mm", 'test.pressure = 0 to 1 mm: has the wrong kind of unit, "mm"'),
        (("test", "points"), 1, "test.points = 1: must be at least 2"),
        (("tset",), {}, 'tset: unknown key; did you mean "test"?'),
    ],
)
def test_one_clear_line(at, value, message):
    with pytest.raises(SpecError) as caught:
        from_mapping(put(GOOD, at, value))
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("at", "message"),
    [
        (("muscle",), "muscle: is missing"),
        (("test",), "test: is missing"),
        (("test", "length"), "test.length: is missing: distance between the fittings; add it to [test]"),
        (("muscle", "braid", "radius"), "braid.radius: is missing: radius R0"),
        (("muscle", "chamber", "law"), "chamber.law: is missing"),
    ],
)
def test_missing_keys_are_named(at, message):
    mapping = copy.deepcopy(GOOD)
    inner = mapping
    for key in at[:-1]:
        inner = inner[key]
    del inner[at[-1]]
    with pytest.raises(SpecError) as caught:
        from_mapping(mapping)
    assert str(caught.value).startswith(message)


def preset(**over):
    return from_mapping({"muscle": {"preset": "paper", **over}}, test_required=False).muscle


def test_a_preset_and_keys_on_top():
    paper = presets.paper()
    assert preset() == paper
    assert preset(braid={"angle": "36 deg"}) == paper.replace("braid.angle", "36 deg")
    assert preset(ends="clamped") == paper.replace("ends", "clamped")  # the same value, but now it was said
    assert "ends" not in preset(ends="clamped").assumed
    assert preset(chamber="none") == paper.replace("chamber", None)
    turned = preset(braid={"angle": "53 deg", "angle_from": "axis"})
    assert turned.braid.angle == pytest.approx(paper.braid.angle, abs=1e-15)
    with pytest.raises(SpecError, match="given without an angle"):
        preset(braid={"angle_from": "axis"})


def test_another_law_or_kind_of_fibre_replaces_that_of_the_preset():
    gent = {"name": "gent", "mu": "17 kPa", "Jm": 30.0}
    assert preset(chamber={"law": gent}).chamber.law == spec.Gent(mu="17 kPa", Jm=30)
    same = preset(chamber={"law": {"name": "mooney-rivlin", "c2": "1 kPa"}})
    assert same.chamber.law == spec.MooneyRivlin(c1="8.5 kPa", c2="1 kPa")
    assert "chamber.law.c1" in same.assumed
    assert "chamber.law.c2" not in same.assumed
    rod = preset(braid={"fibre": {"B1": 1.0, "B2": 1.0, "B3": 1.0}})
    assert rod.braid.fibre == spec.Fibre(B1=1, B2=1, B3=1, diameter="0.25 mm")
    assert [name for name in rod.assumed if name.startswith("braid.fibre.")] == ["braid.fibre.diameter"]
    with pytest.raises(SpecError, match="both B1 and B2 and B3 and E"):
        preset(braid={"fibre": {"B1": 1.0, "B2": 1.0, "B3": 1.0, "E": 1e9}})


def test_overrides():
    before = copy.deepcopy(GOOD)
    overrides = ["braid.angle=36 deg", "test.pressure=0 to 2 bar", "muscle.ends=pinned", "braid.fibres = 48",
                 "chamber.law={name = 'gent', mu = '1 kPa', Jm = 3}", "test.points=3"]  # fmt: skip
    case = from_mapping(apply_overrides(GOOD, overrides))
    assert before == GOOD
    assert case.muscle.braid.angle == math.radians(36)
    assert (case.muscle.ends, case.muscle.braid.fibres) == ("pinned", 48)
    assert case.muscle.chamber.law == spec.Gent(mu=1e3, Jm=3)
    assert case.test.pressure.sample(3).tolist() == [0.0, 1e5, 2e5]
    listed = from_mapping(apply_overrides(GOOD, ["test.pressure=[0, '1 bar']", "test.points=2"]))
    assert listed.test.pressure.waypoints == (0.0, 1e5)


def test_overriding_a_step_of_a_protocol():
    steps = [{"length": "hold", "pressure": "0 to 1 bar"}, {"force": "to 0 N", "pressure": "hold"}]
    mapping = GOOD | {"test": {"kind": "protocol", "steps": steps}}
    case = from_mapping(apply_overrides(mapping, ["test.steps.1.points=7"]))
    assert [step.points for step in case.test.steps] == [21, 7]
    with pytest.raises(SpecError, match=r'test\.steps\.2\.points: "2" is no entry of the list; entries are 0 to 1'):
        apply_overrides(mapping, ["test.steps.2.points=7"])
    with pytest.raises(SpecError, match=r"^test\.steps\[1\]\.points = 1: must be at least 2"):
        from_mapping(apply_overrides(mapping, ["test.steps.1.points=1"]))


@pytest.mark.parametrize("text", ["braid.angle", "=3", "muscle=3", ".=1", "braid.angle.x=3", ""])
def test_overrides_that_cannot_be(text):
    with pytest.raises(SpecError):
        apply_overrides(GOOD, [text])


def test_a_custom_law_is_not_written_silently():
    muscle = presets.paper().replace("chamber.law", spec.CustomLaw(function=put, constants={"a": 1.0}))
    with pytest.raises(SpecError, match="cannot be written"):
        to_toml(muscle)
    written = to_mapping(muscle, allow_custom=True)["chamber"]["law"]
    assert written["name"] == "custom"
    assert written["function"].endswith("test_case_text.put")
    assert written["constants"] == {"a": 1.0}
    with pytest.raises(SpecError, match="cannot be read from a file"):
        from_mapping({"muscle": to_mapping(muscle, allow_custom=True)}, test_required=False)


def test_read_case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    assert read_case(path) == from_mapping(GOOD)
    assert read_case(str(path), ["ends=free"]).muscle.ends == "free"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "there is no such file"),
        (b"\xff\xfe", "is not UTF-8 text"),
        (b"[muscle]\nends = \n", "is not valid TOML: .*line 2"),
        (b"a = " + b"[" * 100_000, "cannot be read|not valid TOML"),
        (b"", "muscle: is missing"),
    ],
)
def test_files_that_cannot_be_read(tmp_path, content, words):
    path = tmp_path / "case.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(SpecError, match=words) as caught:
        read_case(path)
    assert "\n" not in str(caught.value)


def test_a_folder_is_no_case(tmp_path):
    with pytest.raises(SpecError, match="cannot be read"):
        read_case(tmp_path)
