"""Another kind of muscle in a real browser: its law and its lists are chosen, typed, undone and shared."""

from pathlib import Path
from typing import Any

import pytest
from browsers import Watched, axe, environment_is_ready, number, typed

import mckibben as mk
from mckibben.spec.text import Case, to_toml

pytestmark = [
    pytest.mark.page,
    pytest.mark.skipif(bool(environment_is_ready()), reason=environment_is_ready() or "there is a browser"),
]


def choose(seen: Watched, label: str, word: str) -> None:
    """Another word of a choice, and what comes of it."""
    seen.tab.evaluate("document.querySelector('#form').firstChild.dataset.old = true")
    seen.tab.get_by_label(label, exact=True).select_option(label=word)
    seen.until("!document.querySelector('#form').firstChild.dataset.old")
    seen.settled()


def test_another_law_is_chosen_typed_undone_and_shared(seen: Watched) -> None:
    tab = seen.open()
    force = "axial force, positive in tension"
    tab.get_by_label("a contraction").check()
    typed(seen, "Contraction", "-20")
    choose(seen, "Law", "Gent")
    assert tab.get_by_label("mu, initial shear modulus", exact=True).input_value() == "17"
    assumed = tab.get_by_text("are assumed, not measured").inner_text()
    typed(seen, "Jm, limit of I1 - 3, chains stretched out", "2")
    left = tab.get_by_text("are assumed, not measured").inner_text()
    assert int(left.split()[0]) == int(assumed.split()[0]) - 1
    assert not tab.locator(".slider", has_text="Jm, limit").locator(".mark").is_visible()
    assert tab.locator(".slider", has_text="mu, initial").locator(".mark").is_visible()
    typed(seen, "mu, initial shear modulus", "34")
    muscle = mk.presets.paper().replace("chamber.law", mk.Gent(mu="34 kPa", Jm=2.0))
    state = mk.solve(muscle, contraction=-0.2, pressure="1 bar")
    assert number(seen, force) == f"{state.force:.5g} N"
    assert "Shear modulus at small strains 34 kPa." in tab.inner_text("#form")
    other = Watched(tab.context, seen.address)
    other.open("#" + tab.url.partition("#")[2])
    assert number(other, force) == f"{state.force:.5g} N"
    assert other.tab.get_by_label("Law", exact=True).evaluate("one => one.selectedOptions[0].text") == "Gent"
    other.quiet()
    typed(seen, "Jm, limit of I1 - 3, chains stretched out", "-2")
    assert "chamber.law.Jm = -2: must be above 0" in tab.inner_text("#verdict")
    for _ in range(4):
        tab.click("#undo")
        seen.settled()
    assert tab.get_by_label("Law", exact=True).evaluate("one => one.selectedOptions[0].text") == "Mooney-Rivlin"
    assert tab.get_by_label("c1, factor of I1 - 3", exact=True).input_value() == "8.5"


def test_a_choice_by_keyboard_alone(seen: Watched) -> None:
    tab = seen.open()
    law = tab.get_by_label("Law", exact=True)
    law.focus()
    for _ in range(6):
        tab.keyboard.press("ArrowDown")
    seen.until("document.querySelector('#form').textContent.includes('Shore A hardness')")
    seen.until("document.querySelector('#form').textContent.includes('estimated by Gent 1958')")
    assert tab.evaluate("document.activeElement.labels[0].textContent") == "Law"  # the focus is where it was
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.labels[0].textContent") == "Shore A hardness"


def test_radii_on_the_fittings_are_chosen_and_typed(seen: Watched) -> None:
    tab = seen.open()
    choose(seen, "Radius held", "one for each end")
    typed(seen, "Radius on the fittings, last end", "10")
    state = mk.solve(mk.presets.paper().replace("end_radii", ["12.5 mm", "10 mm"]), force=0.0, pressure="1 bar")
    assert number(seen, "distance between the fittings") == f"{1e3 * state.length:.5g} mm"
    tab.get_by_label("Braid angle", exact=True).select_option(label="at 3 places")
    seen.until("document.querySelector('#notices').textContent.includes('braid.angle_profile: asks for fibres that')")
    assert tab.get_by_label("Braid angle", exact=True).evaluate("one => one.selectedIndex") == 0


@pytest.mark.parametrize(("width", "scheme"), [(1366, "light"), (390, "dark")])
def test_new_controls_keep_nobody_out(chromium: Any, address: str, width: int, scheme: str, tmp_path: Path) -> None:
    muscle = mk.presets.paper().replace("chamber.law", mk.Ogden(mu=["17 kPa", "0 Pa"], alpha=[2.0, -2.0]))
    profile = mk.AngleProfile(at=[0.5, 1.0], angle=["41 deg", "40 deg"])
    muscle = muscle.replace("braid.fibre.stretch", True).replace("braid.angle_profile", profile)
    case = tmp_path / "all.toml"
    case.write_text(to_toml(Case(muscle.replace("name", "all of it"))), encoding="utf-8")
    context = chromium.new_context(viewport={"width": width, "height": 844}, color_scheme=scheme)
    seen = Watched(context, address)
    tab = seen.open()
    tab.set_input_files("#file", case)
    seen.until("document.querySelector('#about').textContent.startsWith('all of it')")
    for label in ("Terms", "Angle 2", "Place 1", "mu 2", "Radius held", "Second half mirrored"):
        assert tab.get_by_label(label, exact=True).is_visible()
    assert axe(tab, "#muscle") == []  # what else there is waits for this kind of muscle to be compiled, in grey
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    seen.quiet()
    context.close()
