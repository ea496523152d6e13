"""The pictures of the README, of the gallery and of the recipes: `make pictures`.

They are those of `mckibben reproduce`, made small: at most 1000 pixels wide, line drawings with 256 colours.
A folder made by that command may be given instead of making the pictures anew.
"""

import runpy
import sys
import tempfile
from pathlib import Path

from PIL import Image

import mckibben as mk
from mckibben.paper.reproduce import PICTURES, reproduce
from mckibben.sheet.facts import facts
from mckibben.sheet.pdf import typeset
from mckibben.sheet.pictures import curves, drawing, svg
from mckibben.sheet.words import page
from mckibben.spec import presets

HERE = Path(__file__).parent / "pictures"
WIDEST = 1000
"""Pixels."""
SHADED = ("fig5_energy_density", "fig6_stiff_fibres", "scene", "page", "page_dark")
"""Pictures with colour scales, which a palette would falsify."""


def shrink(source: Path, target: Path) -> None:
    """A smaller copy."""
    with Image.open(source) as picture:
        flat = picture.convert("RGB")
        flat.thumbnail((WIDEST, 2 * WIDEST), Image.Resampling.LANCZOS)
        small = flat if source.stem in SHADED else flat.quantize(256, dither=Image.Dither.NONE)
        small.save(target, optimize=True)


def working_range() -> None:
    """The picture that examples/working_range.py makes."""
    made = Path("out") / "working_range.png"
    runpy.run_path(str(HERE.parent.parent / "examples" / "working_range.py"), run_name="__main__")
    shrink(made, HERE / made.name)


def lift() -> None:
    """A weight lifted by pulses, as it moves: small, for it is in the repository."""
    rig = mk.read_rig(HERE.parent.parent / "examples" / "rig.toml").rig
    mk.animate(mk.simulate(rig, "3 s"), HERE / "lift.gif", fps=5, size=(640, 360), force=True)


def scene() -> None:
    """The muscle in three dimensions, where PyVista is there and can draw."""
    state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    try:
        plotter = mk.scene(state, cut=True, ghost=True, off_screen=True)
    except mk.SpecError as error:
        print(f"docs/pictures/scene.png stays: {error}")
        return
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "scene.png"
        plotter.screenshot(made)
        shrink(made, HERE / made.name)


def datasheet() -> None:
    """The first page of a datasheet."""
    muscle = presets.get("festo-dmsp-20")
    found = facts(muscle, (1.5e5, 3e5, 4.5e5, 6e5), (1440.0, 1300.0))
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "datasheet.png"
        made.write_bytes(typeset(page(found, svg(drawing(found)), svg(curves(found)), "2026-11-28"), "png")[0])
        shrink(made, HERE / made.name)


def browser() -> None:
    """The page of `mckibben serve`, in light and dark, where there is a Chromium."""
    sys.path.insert(0, str(HERE.parent.parent / "tests"))
    from browsers import CHROMIUM, FLAGS, Watched, served

    if CHROMIUM is None:
        print("docs/pictures/page.png stays: there is no Chromium")
        return
    from playwright.sync_api import sync_playwright

    with served() as address, sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        for name, scheme in (("page", "light"), ("page_dark", "dark")):
            seen = Watched(chromium.new_context(viewport={"width": 1366, "height": 860}, color_scheme=scheme), address)
            tab = seen.open()
            tab.get_by_label("a contraction").check()
            tab.get_by_label("Contraction", exact=True).fill("-25")
            tab.get_by_label("Contraction", exact=True).press("Enter")
            seen.settled()
            seen.until("!document.querySelector('#range').classList.contains('old')")
            made = Path(folder) / f"{name}.png"
            tab.screenshot(path=made)
            shrink(made, HERE / made.name)
        chromium.close()


def spread() -> None:
    """The picture of tolerances in the recipes."""
    test = mk.Isometric(length="115 mm", pressure="1 bar")
    vary = {"braid.angle": "0.5 deg", "test.pressure": "5 %", "braid.length": "0.5 mm uniform",
            "chamber.thickness": "10 %"}  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "tolerances.png"
        mk.plot(mk.tolerances(presets.paper(), test, vary)).savefig(made, dpi=200)
        shrink(made, HERE / made.name)


def main(folder: Path) -> None:
    """Every picture of the paper's figures from a folder into docs/pictures."""
    HERE.mkdir(exist_ok=True)
    for name in PICTURES:
        target = HERE / f"{name}.png"
        shrink(folder / target.name, target)
        print(f"docs/pictures/{target.name}: {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    working_range()
    lift()
    scene()
    datasheet()
    spread()
    browser()
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as made:
            reproduce(made)
            main(Path(made))
