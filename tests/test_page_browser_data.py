"""Workbooks and designs of two goals in a real browser."""

import base64

import pytest
from browsers import Watched, axe, environment_is_ready
from test_page_workbooks import ROWS
from workbooks import workbook

pytestmark = [
    pytest.mark.page,
    pytest.mark.skipif(bool(environment_is_ready()), reason=environment_is_ready() or "there is a browser"),
]
pytest.importorskip("python_calamine")


def drop(seen: Watched, content: bytes, name: str) -> None:
    """A file let go over the plot."""
    seen.tab.evaluate(
        """([text, name]) => {
            const data = new DataTransfer();
            data.items.add(new File([Uint8Array.from(atob(text), (one) => one.charCodeAt(0))], name));
            const panel = document.getElementById("force-panel");
            panel.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
        }""",
        [base64.b64encode(content).decode(), name],
    )


def test_workbooks_are_dropped_on_the_plot(seen: Watched) -> None:
    tab = seen.open()
    drop(seen, workbook({"bench": ROWS}), "bench.xlsx")
    seen.until("document.querySelector('#measured table') !== null")
    assert "bench.xlsx: 20 points" in tab.inner_text("#measured")
    tab.get_by_role("button", name="Remove the measured data").click()
    drop(seen, workbook({"by hand": [["nothing"]], "1 bar": ROWS}), "two.xlsx")
    seen.until("document.querySelector('dialog').open")
    assert axe(tab) == []
    assert tab.evaluate("document.activeElement.textContent") == "by hand"
    tab.keyboard.press("Tab")
    tab.keyboard.press("Enter")
    seen.until("document.querySelector('#measured table') !== null")
    assert "two.xlsx: 20 points" in tab.inner_text("#measured")
    drop(seen, b"PK\x03\x04 and nothing more", "torn.xlsx")
    seen.until("document.querySelector('#notices').textContent.includes('torn.xlsx: is no workbook that can be read')")
    assert "two.xlsx: 20 points" in tab.inner_text("#measured")  # what was there stays
    seen.complaints = [one for one in seen.complaints if "status of 400" not in one]  # the browser tells of each


def begun(seen: Watched, count: str) -> None:
    """A design of two goals, begun."""
    tab = seen.tab
    tab.click("#studies summary")
    tab.click("[data-kind=design]")
    tab.get_by_label("and against it").select_option(label="smallest diameter")
    tab.get_by_label("Braid: Radius", exact=True).check()
    tab.get_by_label("Rubber: c1, factor of I1 - 3", exact=True).uncheck()
    tab.get_by_label("Designs that are tried").fill(count)
    tab.get_by_role("button", name="Begin").click()


def test_a_design_of_the_front_is_taken_by_the_keyboard(seen: Watched) -> None:
    pytest.importorskip("pymoo")
    tab = seen.open()
    begun(seen, "64")
    seen.until("document.querySelector('#front-design') !== null")
    assert axe(tab) == []
    slider = tab.get_by_label("Design along the front")
    slider.focus()
    tab.keyboard.press("End")
    last = tab.evaluate("document.querySelector('#front-design').max")
    assert f"Design {last} of {last}" in tab.inner_text("dialog")
    radius = tab.locator("dialog tr", has_text="braid.radius").first.locator("td").inner_text()
    box = tab.locator("dialog .u-over").bounding_box()
    tab.mouse.click(box["x"] + 2, box["y"] + box["height"] - 2)
    assert "Design 1 of" in tab.inner_text("dialog")
    slider.focus()
    tab.keyboard.press("End")
    tab.get_by_role("button", name="Take this muscle").press("Enter")
    seen.until(
        "!document.querySelector('dialog').open && document.querySelector('#about').textContent.includes('changed')"
    )
    seen.settled()
    assert f"{float(tab.get_by_label('Radius', exact=True).input_value()):.5g} mm" == radius
    tab.click("#undo")
    seen.settled()
    assert tab.get_by_label("Radius", exact=True).input_value() == "12.5"


def test_a_front_is_cancelled_and_begun_anew_from_what_was_typed(seen: Watched) -> None:
    tab = seen.open()
    begun(seen, "1500")
    seen.until("document.querySelector('dialog .cancel') !== null")
    tab.click("dialog .cancel")
    seen.until("document.querySelector('dialog').textContent.includes('Cancelled.')")
    tab.get_by_role("button", name="Back").click()
    assert tab.get_by_label("Designs that are tried").input_value() == "1500"
    assert tab.get_by_label("and against it").evaluate("one => one.selectedOptions[0].text") == "smallest diameter"
    tab.get_by_role("button", name="Close").click()
