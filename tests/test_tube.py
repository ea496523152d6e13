"""A chamber of its own, from what the user says to results: fields, errors, files, states, derivatives, sweeps."""

import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments import foresee
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.parameters import parameters
from mckibben.results.result import Result
from mckibben.spec.text import Case, from_mapping, to_mapping, to_toml

RUBBER = mk.NeoHookean(c1="0.1 MPa")
BRAID = mk.Braid(
    radius="5 mm", length="100 mm", angle="60 deg", fibres=40, fibre=mk.Fibre(diameter="0.2 mm", E="3 GPa", nu=0.4)
)
TUBE = mk.Chamber(outer_diameter="8 mm", inner_diameter="6 mm", length="90 mm", wall="thick", law=RUBBER)
MUSCLE = mk.Muscle(braid=BRAID, chamber=TUBE)
WALL = mk.Muscle(braid=BRAID, chamber=mk.Chamber(thickness="1 mm", law=RUBBER))


def chamber(**given: Any) -> mk.Muscle:
    return mk.Muscle(braid=BRAID, chamber=mk.Chamber(law=RUBBER, **given))


@pytest.mark.spec
@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ({}, "chamber.thickness", "is missing"),
        ({"thickness": "1 mm", "outer_diameter": "8 mm"}, "chamber", "both thickness and outer_diameter are given"),
        ({"outer_diameter": "8 mm"}, "chamber.inner_diameter", "is missing beside outer_diameter; give either"),
        ({"inner_diameter": "8 mm"}, "chamber.outer_diameter", "is missing beside inner_diameter"),
        ({"outer_diameter": "8 mm", "inner_diameter": "8 mm"}, "chamber.inner_diameter", "below the outer .* 8 mm"),
        ({"outer_diameter": "8 mm", "inner_diameter": "6 mm", "lies": "outside"}, "chamber.lies", "lies inside"),
        ({"outer_diameter": "10.1 mm", "inner_diameter": "6 mm"}, "chamber.outer_diameter", "10.1 mm: .* most 10 mm"),
        ({"outer_diameter": 8, "inner_diameter": "6 mm"}, "chamber.outer_diameter", 'write "8 mm"'),
        ({"outer_diameter": "0 mm", "inner_diameter": "6 mm"}, "chamber.outer_diameter", "above 0 mm"),
        ({"outer_diameter": "0.4 mm", "inner_diameter": "0.3 mm"}, "chamber.outer_diameter", "stretch of 25 .* 20"),
        ({"thickness": "5 mm", "lies": "inside"}, "chamber.thickness", "5 mm: must be above 0 mm and below 5 mm"),
        ({"thickness": "1 mm", "lies": "within"}, "chamber.lies", "one of outside, inside"),
        ({"thickness": "1 mm", "wall": "thik"}, "chamber.wall", 'did you mean "thick"'),
        ({"thickness": "1 mm", "length": "2 mm"}, "chamber.length", "stretch of 50 .* 0.05 to 20"),
        (
            {"outer_diameter": "8 mm", "inner_diameter": "2 mm", "length": "200 mm"}, "chamber.length",
            "bore of the tube is closed",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be(given: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(mk.SpecError, match=words) as caught:
        chamber(**given)
    assert caught.value.field == field


@pytest.mark.spec
def test_a_tube_as_wide_as_the_braid_fits() -> None:
    """Half a diameter need not be the radius to the last digit."""
    for radius in ("5 mm", "0.3 mm", "7.35 mm"):
        braid = mk.Muscle(braid=BRAID).replace("braid.fibres", 2).replace("braid.radius", radius).braid
        diameter = 2.0 * float(radius.split()[0])
        mk.Muscle(braid=braid, chamber=mk.Chamber(outer_diameter=f"{diameter} mm", inner_diameter="0.4 mm", law=RUBBER))


@pytest.mark.spec
def test_one_way_replaces_the_other() -> None:
    wide = WALL.replace("chamber", mk.Chamber(outer_diameter="9 mm", inner_diameter="6 mm", law=RUBBER))
    table = to_mapping(Case(WALL))
    table["muscle"]["chamber"] |= {"outer_diameter": "9 mm", "inner_diameter": "6 mm"}
    with pytest.raises(mk.SpecError, match="both thickness and"):
        from_mapping(table, test_required=False)
    over = {"preset": "paper", "chamber": {"outer_diameter": "20 mm", "inner_diameter": "17 mm"}}
    made = from_mapping({"muscle": over}, test_required=False).muscle
    assert made.chamber is not None
    assert (made.chamber.thickness, made.chamber.outer_diameter) == (None, 0.02)
    assert "chamber.thickness" not in made.assumed
    assert "chamber.law.c1" in made.assumed
    back = wide.replace("chamber.thickness", "1 mm")
    assert back == WALL


@pytest.mark.spec
@pytest.mark.parametrize("muscle", [MUSCLE, WALL, chamber(thickness="1 mm", lies="inside", wall="thin")])
def test_what_is_written_reads_back_equal(muscle: mk.Muscle) -> None:
    assert from_mapping(tomllib.loads(to_toml(Case(muscle))), test_required=False).muscle == muscle
    assert eval(repr(muscle.chamber), vars(mk) | {name: getattr(mk, name) for name in mk.__all__}) == muscle.chamber


@pytest.mark.spec
def test_the_papers_chamber_is_written_as_before() -> None:
    assert to_mapping(WALL)["chamber"] == {
        "thickness": 1e-3, "law": {"name": "neo-hookean", "c1": 1e5},
    }  # fmt: skip


@pytest.mark.spec
def test_radius_of_the_centre_lines() -> None:
    assert mk.centre_radius("10 mm", "0.25 mm") == pytest.approx(5.25e-3, rel=1e-15)
    for given, field in ((("0 mm", "1 mm"), "inner_diameter"), (("10 mm", 0.25), "fibre_diameter")):
        with pytest.raises(mk.SpecError) as caught:
            mk.centre_radius(*given)
        assert caught.value.field == f"centre_radius.{field}"


@pytest.mark.experiments
def test_what_check_shows() -> None:
    shown = {name: value for name, value, _ in foresee.derived(MUSCLE)}
    assert shown["chamber as mounted"] == "1.25 x 1.111"
    assert shown["rubber inside"] == "1.9792 mL"
    assert shown["dead zone"].endswith(" bar")
    assert not {"chamber as mounted", "dead zone"} & {name for name, _, _ in foresee.derived(WALL)}


CURVE = mk.Isometric(length="95 mm", pressure="0.3 to 3 bar", points=3)


@pytest.fixture(scope="module")
def curve() -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mk.MuscleWarning)
        return mk.run(MUSCLE, CURVE)


@pytest.mark.experiments
def test_where_the_tube_would_not_touch(curve: Result) -> None:
    contact = curve.data["contact_pressure"].values
    middle = contact[:, contact.shape[1] // 2]
    assert contact[0].max() > 0.0 > contact[0].min()
    assert contact[2].min() > 0.0
    assert middle[2] - middle[0] == pytest.approx(2.7e5, rel=0.02)  # the shape hardly changes
    said = [note for note in curve.cautions if "dead zone" in note]
    assert len(said) == 1
    assert said[0].startswith("state 0 (95 mm, 0.3 bar): the chamber would not touch the braid everywhere")
    assert f"from about {0.3 - contact[0].min() * 1e-5:.3g} bar" in said[0]
    first = mk.cautions(MUSCLE, length="95 mm", pressure="0.3 bar")
    assert any("dead zone" in note for note in first)
    assert not any("dead zone" in note for note in mk.cautions(MUSCLE, length="90 mm", pressure="3 bar"))


@pytest.mark.experiments
def test_air_is_what_the_rubber_leaves(curve: Result, tmp_path: Path) -> None:
    rubber = np.pi * (4e-3**2 - 3e-3**2) * 90e-3
    air = curve.data["air_volume"]
    np.testing.assert_allclose(air.values, curve.volume - rubber, rtol=1e-14)
    assert air.attrs == {"long_name": "volume inside the braid without the rubber that lies inside", "units": "m^3"}
    assert mk.load(mk.save(curve, tmp_path / "curve.nc")) == curve
    head = (mk.save(curve, tmp_path / "curve.csv")).read_text().splitlines()[0]
    assert "air_volume [m^3]" in head


@pytest.mark.experiments
def test_state_is_an_equilibrium(curve: Result) -> None:
    """The conserved quantity sees energy, pull and loads together."""
    assert curve.data["conserved_variation"].values[1:].max() < 1e-5
    assert curve.verdict[1:] == ("stable", "stable")


@pytest.mark.experiments
def test_free_ends_are_the_cylinder() -> None:
    """But for the moment of the fibres at a free end, which is small for thin ones."""
    thin = MUSCLE.replace("ends", "free").replace("braid.fibre.diameter", "0.05 mm")
    p = parameters(thin)
    found = mk.solve(thin, length="90 mm", pressure="3 bar")
    assert found.force == pytest.approx(float(cylinder_force(cylinder_angle(90e-3, p), 3e5, p)), rel=1e-9)


@pytest.mark.experiments
def test_derivatives_are_those_of_differences() -> None:
    test = mk.Isometric(length="90 mm", pressure="3 bar")
    found = mk.sensitivity(MUSCLE, test, of=("force", "air_volume"), by="chamber").absolute
    for name, at in (("outer_diameter", 8e-3), ("inner_diameter", 6e-3), ("length", 90e-3)):
        step = 3e-3 * at
        near = [mk.response(MUSCLE.replace(f"chamber.{name}", at + k * step), test) for k in (-2, -1, 1, 2)]
        for result in ("force", "air_volume"):
            a, b, c, d = (float(one[result][0]) for one in near)
            slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step)
            assert found[result][f"chamber.{name}"] == pytest.approx(slope, rel=1e-9), (name, result)


@pytest.mark.sweeps
def test_sweep_over_tubes() -> None:
    """In a batch as alone, and what does not fit spoils no other."""
    test = mk.Isometric(length="90 mm", pressure="3 bar")
    made = mk.sweep(MUSCLE, test, over={"chamber.outer_diameter": ["7.6 mm", "8 mm", "10.4 mm"]})
    assert made["status"].values.tolist() == [0, 0, 2]
    assert "must be at most 10 mm" in str(made["reason"].values[2])
    alone = mk.run(MUSCLE, test)
    assert made["force"].values[1, 0] == pytest.approx(float(alone.force[0]), rel=1e-8)
    assert made["air_volume"].values[1, 0] == pytest.approx(float(alone.data["air_volume"][0]), rel=1e-8)
