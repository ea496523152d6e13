"""Workbooks dropped on the plot in a real browser: a good one, one with several sheets, a bad one."""

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
