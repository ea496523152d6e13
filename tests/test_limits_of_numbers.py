"""Numbers that nobody means: refused with what can be computed, singly and as products, before
anything is solved.
"""

import math

import pytest

import mckibben as mk
from mckibben.files.case import read_case
from mckibben.spec import describe, spec_classes
from mckibben.spec.text import from_mapping, to_mapping
from mckibben.sweeps.sweepfile import read_sweep

pytestmark = pytest.mark.spec

PAPER = mk.presets.paper()
FIBRE = {"diameter": "0.25 mm", "E": "3 GPa", "nu": 0.4}


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("braid.radius", 1e-320),
        ("braid.radius", 1e300),
        ("braid.length", 1e-12),
        ("braid.length", "1e30 km"),
        ("braid.fibre.diameter", 5e-324),
        ("braid.fibre.E", 1e308),
        ("braid.fibre.E", 1e-300),
        ("braid.fibre.breaking_force", 1e-300),
        ("chamber.thickness", 1e-200),
        ("chamber.thickness", 1e200),
        ("chamber.law.c1", 1e200),
        ("chamber.law.c2", -1e200),
    ],
)
def test_single_numbers(field: str, value: object) -> None:
    with pytest.raises(mk.SpecError, match=r"is beyond what can be computed: (up to )?\S+ \S+") as caught:
        PAPER.replace(field, value)
    assert caught.value.field == field
    assert caught.value.value == value


@pytest.mark.parametrize(
    "make",
    [
        lambda: mk.Fibre(B1=1e-300, B2=1e-6, B3=1e-6),
        lambda: mk.Fibre(B1=1e-6, B2=1e300, B3=1e-6),
        lambda: mk.NeoHookean(c1=1e-200),
        lambda: mk.Yeoh(c1=1e4, c3=1e100),
        lambda: mk.Ogden(mu=[1e200], alpha=[2.0]),
        lambda: mk.Ogden(mu=[1e4], alpha=[1e200]),
        lambda: mk.Ogden(mu=[1e-5], alpha=[1e-3]),
        lambda: mk.Gent(mu="10 kPa", Jm=1e-200),
        lambda: mk.ArrudaBoyce(mu="10 kPa", lambda_m=1e200),
        lambda: mk.Rubber(E=1.0),
        lambda: mk.MooneyRivlin(c1=1e-200),
        lambda: mk.Isometric(length=1e-300, pressure=0.0),
        lambda: mk.Isometric(length=0.1, pressure=1e300),
        lambda: mk.Isometric(length=0.1, pressure="0 to 1e20 bar"),
        lambda: mk.Isotonic(force=-1e300, pressure=0.0),
        lambda: mk.Step(volume=1e-300, pressure=0.0),
    ],
)
def test_parts_and_tests(make) -> None:
    with pytest.raises(mk.SpecError, match=r"beyond what can be computed|at most 10000 bar"):
        make()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"braid.length": "100 m", "braid.radius": "0.5 mm", "braid.fibre.diameter": "0.01 mm"}, "times the radius"),
        ({"braid.radius": "10 m", "braid.length": "1 mm"}, "times the radius"),
        ({"braid.fibre.diameter": "0.0001 mm", "braid.fibre.E": "1 kPa"}, "the stiffness B1 of a fibre is"),
        ({"braid.fibre.nu": math.nextafter(-1.0, 0.0), "braid.fibre.E": "1e13 Pa"}, "the stiffness B3 of a fibre is"),
        ({"chamber.thickness": "10 m"}, None),
        ({"chamber.thickness": "1e-5 mm", "braid.radius": "1 m"}, "times the radius of the braid"),
        ({"chamber.thickness": "1e-5 mm", "chamber.law.c1": 1e-3, "braid.radius": "3 mm"}, None),
    ],
)
def test_products(changes: dict[str, object], said: str | None) -> None:
    from mckibben.spec.change import changed_muscle

    thin = PAPER.replace("braid.fibre.diameter", "0.01 mm")
    if said is None:
        assert changed_muscle(thin, changes).name == "paper (changed)"
        return
    with pytest.raises(mk.SpecError, match="beyond what can be computed") as caught:
        changed_muscle(thin, changes)
    assert said in str(caught.value)


@pytest.mark.parametrize("angle", [1e-320, 1e-6, math.pi / 2 - 1e-6, math.nextafter(math.pi / 2, 0.0)])
def test_fibres_along_the_axis_or_the_parallels(angle: float) -> None:
    with pytest.raises(
        mk.SpecError, match=r"braid.angle = .* beyond what can be computed: 0\.0057 deg to 89\.9943 deg"
    ):
        PAPER.replace("braid.fibre", mk.Fibre(B1=1e-6, B2=1e-6, B3=1e-6)).replace("braid.angle", angle)
    with pytest.raises(mk.SpecError, match="beyond what can be computed"):
        PAPER.replace("braid.angle", angle)


def test_zero_is_a_choice() -> None:
    assert mk.Fibre(B1=0.0, B2=0.0, B3=0.0).stiffnesses == (0.0, 0.0, 0.0)
    assert mk.Isotonic(force=0.0, pressure=0.0).points == 1
    assert mk.MooneyRivlin(c1=1e4, c2=0.0).c2 == 0.0


def test_every_number_has_its_range() -> None:
    """Between low and high, or by its size; the names of constants are the user's own."""
    for cls in spec_classes():
        for field in describe(cls):
            if field.kind in ("quantity", "quantities", "path", "held"):
                assert field.computed or (math.isfinite(field.low) and math.isfinite(field.high)), (cls, field.name)
    assert "above 0 mm; computed: 0.001 mm to 100000 mm" in mk.spec.reference_markdown()


def test_the_command_line_has_one_line(tmp_path) -> None:
    from typer.testing import CliRunner

    from mckibben.app.cli import app

    case = tmp_path / "case.toml"
    case.write_text('[muscle]\npreset = "paper"\n[test]\nkind = "free-contraction"\npressure = "1 bar"\n')
    done = CliRunner().invoke(app, ["check", str(case), "--set", "braid.radius=1e-320"])
    assert done.exit_code == 2
    said = "braid.radius = 1e-320: is beyond what can be computed: 0.001 mm to 100000 mm; check its unit"
    assert done.stderr == f"mckibben: {said}\n"


@pytest.mark.parametrize("depth", [20, 900, 3000, 100_000])
@pytest.mark.parametrize("where", ["[{}]\nx = 1\n", "[muscle.{}]\nx = 1\n", "{} = 1\n", "[sweep.over.{}]\nx = 1\n"])
def test_tables_nested_deep(tmp_path, where: str, depth: int) -> None:
    file = tmp_path / "case.toml"
    dotted = ".".join("a" * depth)
    file.write_text('muscle.preset = "paper"\n' + where.replace("{}", dotted), encoding="utf-8")
    for read in (read_case, read_sweep):
        with pytest.raises(mk.SpecError, match="has too many tables or lists within each other; at most 12 are read"):
            read(file)


@pytest.mark.parametrize("depth", [20, 900, 3000])
def test_other_things_nested_deep(tmp_path, depth: int) -> None:
    mapping: dict[str, object] = to_mapping(PAPER)
    deep: object = 1.0
    for _ in range(depth):
        deep = {"a": [deep]}
    with pytest.raises(mk.SpecError):
        from_mapping({"muscle": mapping | {"braid": deep}})
    with pytest.raises(mk.SpecError, match="too many tables or lists"):
        mk.spec.text.apply_overrides({"muscle": mapping | {"braid": deep}}, [])
    with pytest.raises(mk.SpecError, match="names a table within"):
        mk.spec.text.apply_overrides({"muscle": mapping}, [".".join("a" * depth) + "=1"])
    for text in ("[" * depth + "]" * depth, "{a=" * depth + "1" + "}" * depth):
        file = tmp_path / "case.toml"
        file.write_text(f"muscle = {text}\n")
        with pytest.raises(mk.SpecError, match=r"too many tables or lists|cannot be read"):
            read_case(file)


def test_many_spaces_take_no_time(tmp_path) -> None:
    """In a head of a table, and in a path: nothing there takes more than a time that grows with the length."""
    from mckibben.sweeps.plan import plan

    test = mk.Isometric(length="0.1 m", pressure="0 to" + " " * 100_000 + "1 bar")
    assert test.pressure.waypoints == (0.0, 1e5)
    file = tmp_path / "designs.csv"
    file.write_text("braid." + " " * 20_000 + "angle,ends\n36,clamped\n")
    with pytest.raises(mk.SpecError) as caught:
        plan(PAPER, test, designs=file)
    assert len(str(caught.value)) < 1500
    file.write_text("braid.angle" + " " * 20_000 + "[deg]\n36\n")
    assert plan(PAPER, test, designs=file).varied[0].values == (math.radians(36.0),)
