"""The front of a design as a page shows it: goals against each other, and each design as a muscle to take."""

from __future__ import annotations

from typing import Any

import numpy as np

from mckibben.designing.answer import Design
from mckibben.page.plain import listed
from mckibben.spec.asked import MEASURES
from mckibben.spec.text import to_mapping
from mckibben.view.design import goal

__all__ = ["front_of"]


def front_of(design: Design) -> dict[str, Any] | None:
    """The designs of the front along its first goal, in the units of people; None where there is none."""
    if design.front is None:
        return None
    values, said = design.data["front_goal"].values, design.data["front_said"].values
    order = np.argsort(values[:, 0], kind="stable")
    goals = []
    for k in range(values.shape[1]):
        shown, label, better = goal(design, k, values[order, k])
        kind = str(design.data["goal_kind"].values[k])
        meaning = getattr(MEASURES[kind], "meaning", kind)
        meaning = meaning if isinstance(meaning, str) else kind  # of some it depends on what is asked
        unit = f" [{label.rpartition('(')[2][:-1]}]" if label.endswith(")") else ""
        short = f"{meaning[0].upper()}{meaning[1:]}{unit}"
        goals.append({"label": label, "short": short, "better": better, "values": listed(shown)})
    members = [design.member(int(place)) for place in order]
    middle = next((k for k, muscle in enumerate(members) if muscle == design.muscle), 0)
    return {
        "goals": goals,
        "numbers": list(design.numbers),
        "said": [[str(one) for one in said[place]] for place in order],
        "muscles": [{"from": to_mapping(muscle)} for muscle in members],
        "middle": middle,
    }
