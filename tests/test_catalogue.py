"""The catalogue of presets: each solves at its pressure, and every number says where it comes from."""

import math
import tomllib

import pytest

import mckibben as mk
from mckibben.spec.catalogue import CATALOGUE
from mckibben.spec.declared import walk
from mckibben.spec.text import muscle_from_mapping, to_toml

pytestmark = pytest.mark.experiments


@pytest.mark.parametrize("name", mk.presets.names())
def test_every_value_has_a_source_or_is_assumed(name: str) -> None:
    muscle, sources = mk.presets.get(name), mk.presets.sources(name)
    given = {field for field, _, value in walk(muscle) if value is not None and field not in ("name", "assumed")}
    assert given == set(sources)
    assert set(muscle.assumed) == {field for field, source in sources.items() if source.startswith("assumed")}
    assert muscle.name == name
    assert len(mk.presets.about(name)) > 20
    assert muscle_from_mapping(tomllib.loads(to_toml(muscle))) == muscle


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_it_does_at_its_pressure(name: str) -> None:
    """Stable, with a force below that of a cylinder that stores nothing, and a free contraction of 15 to 31 %."""
    muscle, pressure = mk.presets.get(name), CATALOGUE[name].rated
    blocked = mk.solve(muscle, length=muscle.rest_length, pressure=pressure)
    free = mk.solve(muscle, force=0.0, pressure=pressure)
    assert blocked.verdict == free.verdict == "stable"
    ideal = float(mk.textbook_force(muscle, length=muscle.rest_length, pressure=pressure))
    assert 0.3 * ideal < blocked.force < 1.001 * ideal
    assert 0.15 < free.contraction < 0.31
    assert free.contraction < 1.0 - 1.0 / (math.sqrt(3.0) * math.sin(muscle.braid.angle))  # the magic angle's


def test_what_the_spread_of_rubber_does() -> None:
    """24 and 9 %, as the source of pet-10 says."""
    muscle = mk.presets.get("pet-10")
    found = [
        mk.solve(muscle.replace("chamber.law.c1", c1), force=0.0, pressure="3 bar").contraction
        for c1 in ("100 kPa", "400 kPa")
    ]
    assert [round(100.0 * one) for one in found] == [24, 9]
    assert "24 to 9 %" in mk.presets.sources("pet-10")["chamber.law.c1"]


def test_festo_as_published() -> None:
    muscle = mk.presets.get("festo-dmsp-20")
    assert muscle.braid.angle == pytest.approx(math.radians(90.0 - 28.6))
    assert muscle.braid.radius - muscle.chamber.thickness == pytest.approx(10e-3)
    assert not {"braid.length", "braid.angle", "chamber.thickness"} & set(muscle.assumed)
    assert {"braid.fibres", "chamber.law.c1", "braid.radius"} <= set(muscle.assumed)
