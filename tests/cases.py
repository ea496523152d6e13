"""The reference cases: states to 8 digits and hard targets, computed with an independent solver."""

import json
import math
from pathlib import Path
from typing import Any

import mckibben as mk

CASES = json.loads((Path(__file__).parent / "data" / "reference_cases.json").read_text(encoding="utf-8"))


def muscle(case: dict[str, Any]) -> mk.Muscle:
    """The muscle of a case."""
    m = case["muscle"]
    fibre = mk.Fibre(B1=m["B1_Nmm2"] * 1e-6, B2=m["B2_Nmm2"] * 1e-6, B3=m["B3_Nmm2"] * 1e-6)
    braid = mk.Braid(
        radius=m["radius_mm"] * 1e-3,
        length=m["length_mm"] * 1e-3,
        angle=m["angle_rad"],
        fibres=int(m["fibres"]),
        fibre=fibre,
    )
    law = mk.MooneyRivlin(c1=m["c1_MPa"] * 1e6, c2=m["c2_MPa"] * 1e6)
    return mk.Muscle(braid=braid, chamber=mk.Chamber(thickness=m["thickness_mm"] * 1e-3, law=law), ends=case["ends"])


def held(case: dict[str, Any]) -> dict[str, float]:
    """What a reference state holds, in SI."""
    unit = 1e-3 if case["control"] == "length" else 1.0
    return {case["control"]: case["control_value"] * unit, "pressure": case["pressure_MPa"] * 1e6}


def relative_error(case: dict[str, Any], state: Any) -> float:
    """Of the force under length control, of the length under force control; of 1 N where the force is zero."""
    if case["control"] == "length":
        return abs(state.force - case["force_N"]) / max(abs(case["force_N"]), 1.0)
    return math.fabs(state.length * 1e3 / case["length_mm"] - 1.0)
