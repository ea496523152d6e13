"""The page in a real browser: it loads, follows, says what is wrong, and asks for nothing from outside."""

import json
from pathlib import Path
from typing import Any

import pypdf
import pytest
from browsers import Watched, axe, environment_is_ready, number, typed

import mckibben as mk

pytestmark = [
    pytest.mark.page,
    pytest.mark.skipif(bool(environment_is_ready()), reason=environment_is_ready() or "there is a browser"),
]

BENCH = Path(__file__).parent.parent / "examples" / "bench.csv"
PAPER = mk.presets.paper()


def test_what_is_shown_is_what_the_library_says(seen: Watched) -> None:
    seen.open()
    typed(seen, "Braid angle, from the parallels", "38")
    typed(seen, "Pressure", "0.8")
    seen.tab.get_by_label("a contraction").check()
    typed(seen, "Contraction", "-20")
    state = mk.solve(PAPER.replace("braid.angle", "38 deg"), contraction=-0.2, pressure="0.8 bar")
    assert number(seen, "axial force, positive in tension") == f"{state.force:.5g} N"
    assert number(seen, "distance between the fittings") == f"{1e3 * state.length:.5g} mm"
    assert number(seen, "volume inside the braid") == f"{1e6 * state.volume:.5g} mL"
    tension = float(state.data["fibre_tension"].max())
    assert number(seen, "largest tension of a fibre along its length") == f"{tension:.4g} N"
    assert "It holds. Stable under length control." in seen.tab.inner_text("#verdict")
    assert f"{1e3 * state.length:.4g} mm long" in seen.tab.inner_text("#scale")


def test_a_slider_that_is_dragged_is_followed_and_undone(seen: Watched) -> None:
    tab = seen.open()
    before = number(seen, "gauge pressure")
    slider = tab.get_by_label("Pressure, in bar")
    box = slider.bounding_box()
    tab.mouse.move(box["x"] + 0.66 * box["width"], box["y"] + box["height"] / 2)
    tab.mouse.down()
    for k in range(8):
        tab.mouse.move(box["x"] + (0.6 - 0.05 * k) * box["width"], box["y"] + box["height"] / 2)
    tab.mouse.up()
    seen.settled()
    value = float(tab.get_by_label("Pressure", exact=True).input_value())
    assert value < 0.6
    assert number(seen, "gauge pressure") == f"{value:.5g} bar"
    tab.click("#undo")
    seen.settled()
    assert number(seen, "gauge pressure") == before
    tab.keyboard.press("Control+y")
    seen.settled()
    assert number(seen, "gauge pressure") == f"{value:.5g} bar"
    fragment = "#" + tab.url.partition("#")[2]
    other = Watched(tab.context, seen.address)
    other.open(fragment)
    assert number(other, "gauge pressure") == f"{value:.5g} bar"
    other.quiet()


def test_the_point_is_dragged_on_the_plot(seen: Watched) -> None:
    tab = seen.open()
    box = tab.locator("#force .u-over").bounding_box()
    tab.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    seen.settled()
    assert tab.get_by_label("a contraction").is_checked()
    assert float(number(seen, "contraction 1 - h/H0, positive when shorter").removesuffix(" %")) < 0.0


def test_states_that_cannot_be_are_told_in_words(seen: Watched) -> None:
    tab = seen.open()
    tab.get_by_label("a contraction").check()
    typed(seen, "Contraction", "-60")
    assert "It cannot be held there. No equilibrium: the fibres are straight" in tab.inner_text("#verdict")
    typed(seen, "Contraction", "0")
    typed(seen, "Fibres", "57")
    assert "Such a muscle cannot be. braid.fibres = 57: must be even" in tab.inner_text("#verdict")
    typed(seen, "Fibres", "fifty")
    assert tab.get_by_label("Fibres", exact=True).get_attribute("aria-invalid") is not None
    typed(seen, "Fibres", "56")
    assert "It holds" in tab.inner_text("#verdict")


def test_what_is_being_typed_is_not_overwritten(seen: Watched) -> None:
    tab = seen.open()
    field = tab.get_by_label("Pressure", exact=True)
    field.fill("0.75")
    tab.evaluate("document.querySelector('input[value=contraction]').click()")  # answers come, the focus stays
    seen.settled()
    assert tab.get_by_label("a contraction").is_checked()
    assert field.input_value() == "0.75"
    assert number(seen, "gauge pressure") == "1 bar"
    field.press("Enter")
    seen.settled()
    assert number(seen, "gauge pressure") == "0.75 bar"
    field.fill("seven")
    field.press("Enter")
    assert field.get_attribute("aria-invalid") is not None
    tab.get_by_label("Pressure, in bar").press("ArrowLeft")
    seen.settled()
    assert field.get_attribute("aria-invalid") is None
    assert number(seen, "gauge pressure") == f"{float(field.input_value()):.5g} bar"


def test_files_that_are_opened(seen: Watched, tmp_path: Path) -> None:
    tab = seen.open()
    case = tmp_path / "mine.toml"
    case.write_text('[muscle]\npreset = "paper"\nname = "mine"\nbraid.angle = "36 deg"\n', encoding="utf-8")
    tab.set_input_files("#file", case)
    seen.until("document.querySelector('#about').textContent.startsWith('mine')")
    seen.settled()
    assert tab.get_by_label("Braid angle, from the parallels", exact=True).input_value() == "36"
    case.write_text("[muscle\n", encoding="utf-8")
    tab.set_input_files("#file", case)
    seen.until("document.querySelector('#notices').textContent.includes('mine.toml: is not valid TOML')")
    large = tmp_path / "large.csv"
    large.write_bytes(b"1,2\n" * 12_500_000)
    tab.set_input_files("#data-file", large)
    seen.until("document.querySelector('#notices').textContent.includes('too large: measured data have at most 10 MB')")
    tab.set_input_files("#data-file", BENCH)
    seen.until("document.querySelector('#measured table') !== null")
    assert "bench.csv: 20 points" in tab.inner_text("#measured")
    seen.complaints = [one for one in seen.complaints if "status of 400" not in one]  # the browser tells of each


def test_downloads_are_read_again(seen: Watched, tmp_path: Path) -> None:
    tab = seen.open()
    for kind in ("toml", "nc", "csv", "glb", "pdf"):
        tab.click("#downloads summary")
        with tab.expect_download(timeout=120_000) as waiting:
            tab.click(f"#downloads [data-kind={kind}]")
        assert waiting.value.suggested_filename == f"paper.{kind}"
        waiting.value.save_as(tmp_path / f"paper.{kind}")
    assert mk.read_case(tmp_path / "paper.toml").muscle == PAPER
    curve = mk.load(tmp_path / "paper.nc")
    assert isinstance(curve, mk.Result)
    assert len((tmp_path / "paper.csv").read_text(encoding="utf-8").splitlines()) == len(curve) + 1
    made = (tmp_path / "paper.glb").read_bytes()
    assert json.loads(made[20 : 20 + int.from_bytes(made[12:16], "little")])["asset"]["version"] == "2.0"
    assert "paper" in pypdf.PdfReader(tmp_path / "paper.pdf").pages[0].extract_text()


def test_a_long_job_is_cancelled_and_others_go_on(seen: Watched, chromium: Any, address: str) -> None:
    tab = seen.open()
    tab.click("#studies summary")
    tab.click("[data-kind=effects]")
    seen.until("document.querySelector('dialog .cancel') !== null")
    with chromium.new_context() as context:
        other = Watched(context, address)
        other.open()
        typed(other, "Pressure", "0.7")
        assert number(other, "gauge pressure") == "0.7 bar"
        other.quiet()
    assert number(seen, "gauge pressure") == "1 bar"
    tab.click("dialog .cancel")
    seen.until("document.querySelector('dialog').textContent.includes('Cancelled.')")
    tab.click("dialog .ends button")


def test_a_second_muscle_stands_beside_the_first(seen: Watched) -> None:
    tab = seen.open()
    tab.click("#second")
    seen.until("document.querySelector('#second-said').textContent.includes('stable')")
    typed(seen, "Braid angle, from the parallels", "39")
    rows = seen.until("[...document.querySelectorAll('#numbers tbody tr')].map(r => r.innerText.split('\\t'))")
    lengths = next(row for row in rows if row[0].startswith("distance"))
    assert lengths[1] != lengths[2]
    tab.click("#second")
    assert tab.locator("#second-place").is_hidden()


def test_by_keyboard_alone(seen: Watched) -> None:
    tab = seen.open()
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.textContent") == "Skip to pressure and load"
    tab.keyboard.press("Enter")
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.labels[0].textContent") == "Pressure"
    tab.keyboard.press("Tab")
    before = number(seen, "gauge pressure")
    for _ in range(5):
        tab.keyboard.press("ArrowLeft")
    seen.settled()
    assert number(seen, "gauge pressure") != before
    tab.locator("#stage canvas").focus()
    for key in ("ArrowLeft", "ArrowUp", "+", "-", "Home"):
        tab.keyboard.press(key)
    tab.locator("#downloads summary").focus()
    tab.keyboard.press("Enter")
    assert tab.locator("#downloads").get_attribute("open") is not None
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.dataset.kind") == "toml"
    tab.keyboard.press("Escape")
    assert tab.locator("#downloads").get_attribute("open") is None
    tab.locator("#share").focus()
    tab.keyboard.press("Enter")
    assert "#m1." in tab.get_by_label("Link", exact=True).input_value()
    tab.keyboard.press("Escape")
    assert not tab.evaluate("document.querySelector('dialog').open")


@pytest.mark.parametrize(("width", "scheme"), [(1366, "light"), (1366, "dark"), (390, "light"), (390, "dark")])
def test_nothing_keeps_anybody_out(chromium: Any, address: str, width: int, scheme: str) -> None:
    context = chromium.new_context(viewport={"width": width, "height": 844}, color_scheme=scheme)
    seen = Watched(context, address)
    tab = seen.open()
    assert axe(tab) == []
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    if width < 500:
        tab.click("#studies summary")
        tab.click("[data-kind=design]")
        seen.until("document.querySelector('dialog').open")
        assert axe(tab) == []
    seen.quiet()
    context.close()


def test_a_link_that_was_cut_is_told(seen: Watched) -> None:
    tab = seen.open("#m1.1x2y3z.eyJtdXNjbGUiOnsiZnJvbSI6")
    assert "This link is cut or damaged." in tab.inner_text("#notices")
    assert "It holds" in tab.inner_text("#verdict")


def test_without_webgl_it_is_drawn_flat(address: str, chromium: Any) -> None:
    context = chromium.new_context()
    context.add_init_script("HTMLCanvasElement.prototype.getContext = (of => function (kind, ...more) {"
                            "return kind.startsWith('webgl') ? null : of.call(this, kind, ...more) })"
                            "(HTMLCanvasElement.prototype.getContext)")  # fmt: skip
    seen = Watched(context, address)
    tab = seen.open()
    assert "this browser has no WebGL" in tab.inner_text("#scale")
    assert tab.locator("#stage svg line").count() > 100
    assert [one for one in seen.complaints if "WebGL" not in one] == []
    context.close()


def test_a_name_that_points_here_is_refused(chromium: Any, address: str) -> None:
    context = chromium.new_context()
    tab = context.new_page()
    answer = tab.goto(address.replace("127.0.0.1", "evil.example"))
    assert answer.status == 400
    assert "use the link that was printed" in tab.inner_text("body")
    context.close()
