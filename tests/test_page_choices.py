"""Choices of the page that make another kind of muscle: its law, how many numbers its lists have."""

import math
from typing import Any

import pytest

import mckibben as mk
from mckibben.page.chosen import chosen
from mckibben.page.muscles import muscle_of
from mckibben.page.offered import offered
from mckibben.page.opening import opened
from mckibben.page.tasks import TaskError, perform
from mckibben.spec.laws import LAWS

pytestmark = pytest.mark.page

PAPER: dict[str, Any] = {"from": {"preset": "paper"}}
WORDS = [value for value, _ in offered(mk.presets.paper())[0]["options"]]


def told(name: str, value: Any, start: Any = PAPER, **changes: Any) -> dict[str, Any]:
    """What the page is told of a muscle with another choice."""
    return opened({**start, "changes": changes, "choose": {name: value}})


def numbers_of(answer: dict[str, Any], group: str) -> dict[str, Any]:
    return {one["name"]: one for one in answer["sliders"] if one["group"] == group}


def test_every_law_that_a_file_can_say_is_offered() -> None:
    assert {word.partition(" ")[0] for word in WORDS} == set(LAWS) - {"custom"}


@pytest.mark.parametrize("word", [word for word in WORDS if word not in ("rubber shore", "bellows")])
@pytest.mark.parametrize("before", ["neo-hookean", "arruda-boyce", "bellows"])
def test_another_law_begins_as_stiff_at_small_strains(word: str, before: str) -> None:
    was = chosen(mk.presets.paper(), "chamber.law", before)
    made = chosen(was, "chamber.law", word)
    assert made.chamber.law.shear_modulus == pytest.approx(17e3, rel=1e-6)
    law = type(made.chamber.law)
    assert {name for name in made.assumed if name.startswith("chamber.law.")}
    assert law is not type(was.chamber.law) or word == before


def test_a_hardness_is_the_nearest_there_is() -> None:
    stiff = mk.presets.paper().replace("chamber.law", mk.Rubber(E="2 MPa"))
    made = chosen(stiff, "chamber.law", "rubber shore").chamber.law
    assert made.shore == round(made.shore, 1)
    assert made.youngs_modulus == pytest.approx(2e6, rel=2e-3)
    assert chosen(mk.presets.paper(), "chamber.law", "rubber shore").chamber.law.shore == 20.0  # softer is none


def test_folds_are_as_stiff_as_the_tube_and_back() -> None:
    paper = mk.presets.paper()
    folds = chosen(paper, "chamber.law", "bellows")
    area = paper.chamber.area(paper.braid.radius)
    assert folds.chamber.law.axial_stiffness == pytest.approx(3.0 * 17e3 * area, rel=1e-6)
    bare = paper.replace("chamber", mk.Chamber(law=mk.Bellows(axial_stiffness="50 N")))
    with pytest.raises(mk.SpecError, match="give the chamber a thickness"):
        chosen(bare, "chamber.law", "gent")


@pytest.mark.parametrize("word", WORDS)
def test_the_constants_of_a_law_have_sliders(word: str) -> None:
    answer = told("chamber.law", word)
    sliders = numbers_of(answer, "Rubber")
    assert sliders
    for one in sliders.values():
        assert one["least"] <= one["value"] <= one["most"]
        assert one["assumed"]
        assert one["unit"] in ("kPa", "MPa", "N", "")
    (law,) = (one for one in answer["choices"] if one["name"] == "chamber.law")
    assert law["value"] == word
    again = opened({"from": answer["from"]})  # as a link has it
    assert again["sliders"] == answer["sliders"]
    assert [one["value"] for one in again["choices"]] == [one["value"] for one in answer["choices"]]


def test_constants_are_checked_as_those_of_a_file() -> None:
    answer = told("chamber.law", "gent")
    said = {"from": answer["from"], "changes": {"chamber.law.Jm": "-1", "chamber.law.mu": "17 kPa"}}
    with pytest.raises(mk.SpecError) as caught:
        muscle_of(said)
    assert str(caught.value).startswith("chamber.law.Jm = -1: must be above 0")
    muscle = muscle_of({"from": answer["from"], "changes": {"chamber.law.Jm": "12"}})
    assert muscle.chamber.law == mk.Gent(mu=17e3, Jm=12.0)
    assert "chamber.law.Jm" not in muscle.assumed


def test_terms_of_ogdens_law_come_and_go() -> None:
    one = chosen(mk.presets.paper(), "chamber.law", "ogden")
    two = chosen(one, "chamber.law.mu", 2)
    assert two.chamber.law.shear_modulus == one.chamber.law.shear_modulus
    assert two.chamber.law.mu == (17e3, 0.0)
    assert chosen(two, "chamber.law.mu", 1).chamber.law == one.chamber.law
    answer = told("chamber.law", "ogden")
    answer = opened({"from": answer["from"], "choose": {"chamber.law.mu": 2}})
    assert list(numbers_of(answer, "Rubber")) == [
        f"chamber.law.{name}[{k}]" for name in ("mu", "alpha") for k in (0, 1)
    ]
    changes = {"chamber.law.mu[0]": "130 kPa", "chamber.law.alpha[0]": "1.3", "chamber.law.mu[1]": "-15 kPa"}
    law = muscle_of({"from": answer["from"], "changes": changes}).chamber.law
    assert law == mk.Ogden(mu=["130 kPa", "-15 kPa"], alpha=[1.3, -2.0])


def test_radii_on_the_fittings() -> None:
    answer = told("end_radii", 2)
    sliders = numbers_of(answer, "Fittings")
    assert [(one["label"], one["value"], one["unit"]) for one in sliders.values()] == [
        ("Radius on the fittings, first end", 12.5, "mm"), ("Radius on the fittings, last end", 12.5, "mm"),
    ]  # fmt: skip
    muscle = muscle_of({"from": answer["from"], "changes": {"end_radii[1]": "9 mm"}})
    assert muscle == mk.presets.paper().replace("end_radii", ["12.5 mm", "9 mm"])
    assert chosen(muscle, "end_radii", 1).end_radii == (0.0125,)
    assert chosen(muscle, "end_radii", 0).end_radii is None
    with pytest.raises(mk.SpecError, match="end_radii = 20 mm: must be from"):
        muscle_of({"from": answer["from"], "changes": {"end_radii[0]": "20 mm"}})


PROGRAMMED = mk.presets.paper().replace("braid.fibre.stretch", True)


def test_a_profile_keeps_the_angles_that_there_were() -> None:
    same = chosen(PROGRAMMED, "braid.angle_profile", 2)
    assert same.braid.angles == pytest.approx([math.radians(37.0)] * 3)
    bent = same.replace("braid.angle_profile.angle", ["42 deg", "40 deg"])
    finer = chosen(bent, "braid.angle_profile", 4)
    assert finer.braid.angle_profile.angle[1::2] == pytest.approx(bent.braid.angle_profile.angle)
    assert finer.braid.angle_profile.at == (0.25, 0.5, 0.75, 1.0)
    half = chosen(bent, "braid.angle_profile.mirrored", True).braid.angle_profile
    assert (half.at, half.angle) == ((0.25, 0.5), bent.braid.angle_profile.angle)
    assert chosen(finer, "braid.angle_profile", 0) == PROGRAMMED


def test_the_last_place_of_a_profile_is_no_slider() -> None:
    start = opened({**PAPER, "choose": {"braid.fibre.stretch": True}})
    answer = opened({"from": start["from"], "choose": {"braid.angle_profile": 2}})
    assert list(numbers_of(answer, "Angle along the length")) == [
        "braid.angle_profile.angle[0]", "braid.angle_profile.angle[1]", "braid.angle_profile.at[0]",
    ]  # fmt: skip
    words = [one["name"] for one in answer["choices"] if one["group"] == "Angle along the length"]
    assert words == ["braid.angle_profile", "braid.angle_profile.mirrored", "braid.angle_profile.between"]
    changes = {"braid.angle_profile.angle[0]": "41 deg", "braid.angle_profile.at[0]": "0.3"}
    profile = muscle_of({"from": answer["from"], "changes": changes}).braid.angle_profile
    assert profile.at == (0.3, 1.0)
    assert profile.angle[0] == pytest.approx(math.radians(41.0))


def test_points_of_a_pull_test_but_that_at_rest() -> None:
    yarn = mk.AxialLaw(strain=[0.0, 0.01, 0.02], force=["0 N", "0.3 N", "1 N"])
    fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True, axial_law=yarn)
    start = mk.presets.paper().replace("braid.fibre", fibre)
    from mckibben.spec.text import to_mapping

    answer = opened({"from": to_mapping(start)})
    assert list(numbers_of(answer, "Pull test of a fibre")) == [
        f"braid.fibre.axial_law.{name}[{k}]" for name in ("strain", "force") for k in (1, 2)
    ]
    made = muscle_of({"from": answer["from"], "changes": {"braid.fibre.axial_law.force[2]": "1.5 N"}})
    assert made.braid.fibre.axial_law.force == (0.0, 0.3, 1.5)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"choose": {"chamber.law": "hooke"}}, 'chamber.law = hooke: must be one of neo-hookean'),
        ({"choose": {"chamber.law": ["gent"]}}, "chamber.law"),
        ({"choose": {"chamber.law.mu": 2}}, "no law of Ogden's"),
        ({"choose": {"end_radii": 3}}, "end_radii = 3: must be a whole number from 0 to 2"),
        ({"choose": {"end_radii": True}}, "must be a whole number"),
        ({"choose": {"braid.angle_profile": 2}}, "asks for fibres that stretch"),
        ({"choose": {"nobody": 2}}, "is no field of this muscle"),
        ({"changes": {"end_radii[0]": "9 mm"}}, "is no number of a list of this muscle"),
        ({"changes": {"chamber.law.c1[0]": "9 kPa"}}, "is no number of a list of this muscle"),
        ({"changes": {"end_radii[-1]": "9 mm"}}, "is no number of a list of this muscle"),
    ],
)  # fmt: skip
def test_wrong_choices_are_one_message(said: Any, words: str) -> None:
    with pytest.raises(TaskError) as caught:
        perform("open", {**PAPER, **said}, lambda name, part: None)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_seen_tells_how_stiff_the_rubber_is() -> None:
    from mckibben.page.asked import asked_of
    from mckibben.page.look import look

    asked = {"muscle": PAPER, "pressure": 1e5, "hold": "force", "value": 0.0, "top": 1e5}
    assert look(asked_of(asked))["law"] == "shear modulus at small strains 17 kPa"
