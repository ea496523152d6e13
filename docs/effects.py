"""The tables of docs/effects.md: `make tables` computes them anew and puts them between the marks of the page."""

import re
from pathlib import Path

import mckibben as mk

PAGE = Path(__file__).parent / "effects.md"
CASES = {
    "paper": {"length": "115 mm", "pressure": "1 bar"},
    "pet-10": {"contraction": "10 %", "pressure": "3 bar"},
    "festo-dmsp-20": {"contraction": "10 %", "pressure": "6 bar"},
    "loose-tube": {"length": "105 mm", "pressure": "0.3 bar"},
}
"""The muscles of the page, presets but for the last, and where their effects are told."""
MARKED = re.compile(r"(<!-- table of ([\w.-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def table(found: mk.Effects) -> str:
    """Effects as a table of the page, the largest first; time is left out, which differs between machines."""
    lines = ["| effect | force | radius at mid-length | fibre tension | switch |", "|---|---|---|---|---|"]
    untold = []
    for name, row in found.table.iterrows():
        if row["reason"]:
            untold.append(f"\nNo numbers for *{name}*: {row['reason']}.\n")
            continue
        shares = (row[f"{key} [%]"] for key in ("force", "middle_radius", "peak_fibre_tension"))
        shown = " | ".join("–" if share != share else f"{share:+.1f} %".replace("-0.0", "+0.0") for share in shares)
        lines.append(f"| {name} | {shown} | `{row['switch']}` |")
    return "\n".join(lines) + "\n" + "".join(untold)


def muscle(name: str) -> mk.Muscle:
    """A muscle of the page."""
    if name == "loose-tube":
        tube = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"), gap=True)
        return mk.presets.paper().replace("chamber", tube)
    return mk.presets.get(name)


def main() -> None:
    """All tables into the page."""
    made = {
        name: table(
            mk.effects(
                muscle(name),
                length=at.get("length"),
                contraction=at.get("contraction"),
                pressure=at["pressure"],
            )
        )
        for name, at in CASES.items()
    }
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(MARKED.sub(lambda mark: mark[1] + made[mark[2]] + mark[3], text), encoding="utf-8")


if __name__ == "__main__":
    main()
