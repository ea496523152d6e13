"""Measured data, fits, designs and effects by the page's messages: numbers are the library's, wrong input is told."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pages import PAPER, answered, client, look
from starlette.testclient import TestClient
from workbooks import workbook

import mckibben as mk
from mckibben.data.compare import compare
from mckibben.experiments import effects as experiment
from mckibben.page import held
from mckibben.page.kept import MOST, Kept
from mckibben.page.muscles import muscle_of
from mckibben.page.tasks import TaskError
from mckibben.page.transfers import DATA

pytestmark = pytest.mark.page

BENCH = Path(__file__).parent.parent / "examples" / "bench.csv"


@pytest.fixture(scope="module")
def page() -> Iterator[TestClient]:
    with client() as made:
        yield made


@pytest.fixture
def socket(page: TestClient) -> Iterator[Any]:
    with page.websocket_connect("/socket") as made:
        yield made


def sent(page: TestClient, content: bytes, name: str = "bench.csv") -> Any:
    return page.post(f"/data?name={name}", content=content)


def test_measured_points_are_compared_as_by_the_library(page: TestClient, socket: Any) -> None:
    told = sent(page, BENCH.read_bytes()).json()
    data = mk.read_data(BENCH)
    assert (told["name"], told["points"], told["tests"]) == ("bench.csv", len(data), list(data.tests))
    assert told["assumptions"] == list(data.assumptions)
    found = answered(socket, "measured", look() | {"data": told["data"]})["done"]
    muscle = mk.presets.paper()
    for one in found["compared"]:
        own = data[one["test"]]
        ends = 1.0 - own.length / muscle.rest_length
        test = mk.Isobaric(pressure=float(own.pressure[0]), contraction=[float(x) for x in (ends.min(), ends.max())])  # type: ignore[call-arg]
        assert one["count"] == len(own)
        assert one["force"] == pytest.approx(own.force.tolist())
        coarse = compare(mk.run(muscle, test), own)  # of two states only: the page has sixteen
        assert one["rms"] < coarse.rms
        assert one["said"].startswith("rms ")


@pytest.mark.parametrize(
    ("content", "name", "status", "said"),
    [
        (b"a,b\n1,2\n", "x.csv", 400, "x.csv"),
        (b"", "x.csv", 400, "x.csv"),
        (b"PK\x03\x04", "x.xlsx", 400, "x.xlsx: is no workbook that can be read"),
        (b"PK\x03\x04", "x.csv", 400, "x.csv: is no workbook that can be read"),
        (b"\xd0\xcf\x11\xe0", "x.csv", 400, "x.csv: is no XLSX workbook"),
        (b"PK\x03\x04", "x.ods", 400, "save another workbook as XLSX or CSV"),
        (workbook({"bench": [["p", "F"], [1, "slack"]]}), "x.xlsx", 400, "x.xlsx"),
        (workbook({"bench": []}), "x.xlsx", 400, "x.xlsx: is empty"),
        (b"x", "../../etc/passwd", 400, "passwd: must end in .csv"),
        (b"\x00\xff\xfe", "x.txt", 400, "x.txt"),
    ],
)
def test_wrong_data_are_one_message(page: TestClient, content: bytes, name: str, status: int, said: str) -> None:
    answer = sent(page, content, name)
    assert answer.status_code == status
    told = answer.json()["error"]
    assert said in told
    assert "mckibben-page" not in told


def test_fifty_megabytes_are_refused_unread(page: TestClient) -> None:
    answer = page.post("/data?name=x.csv", content=b"", headers={"content-length": str(5 * DATA)})
    assert (answer.status_code, answer.json()["error"]) == (
        413, "the file is too large: measured data has at most 10 MB",
    )  # fmt: skip


@pytest.mark.parametrize("mark", ["nobody", 17, None, "../x"])
def test_data_that_are_gone_are_told(socket: Any, mark: Any) -> None:
    for number, task in enumerate(("measured", "fit")):
        told = answered(socket, task, look() | {"data": mark, "path": str(BENCH), "name": "x"}, number)
        assert "no longer here" in told["error"]


def test_only_so_many_files_are_kept(tmp_path: Path) -> None:
    kept = Kept()
    marks = [kept.put(str(tmp_path), "x.csv", b"1") for _ in range(MOST + 3)]
    assert len(list(tmp_path.iterdir())) == MOST
    assert len(set(marks)) == len(marks)
    with pytest.raises(TaskError, match="no longer here"):
        kept.found(marks[0])
    assert kept.found(marks[-1])["name"] == "x.csv"


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({}, "free"),
        ({"free": {}}, "free"),
        ({"free": {"braid.colour": "1 to 2"}}, "braid.colour"),
        ({"free": {"braid.angle": "50 deg to 40 parsec"}}, "parsec"),
    ],
)
def test_a_wrong_fit_is_one_message(page: TestClient, socket: Any, more: dict[str, Any], words: str) -> None:
    mark = sent(page, BENCH.read_bytes()).json()["data"]
    assert words in answered(socket, "fit", look() | {"data": mark} | more)["error"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({}, "free"),
        ({"objective": None}, "none"),
        ({"objective": {"maximise": "beauty"}}, "beauty"),
        ({"designs": 10**6}, "at most 2000"),
        ({"designs": "many"}, "whole number"),
        ({"subject_to": [{"measure": "force", "pressure": "1 bar", "at_least": "5 kg"}]}, "at_least"),
    ],
)
def test_a_wrong_design_is_one_message(socket: Any, more: dict[str, Any], words: str) -> None:
    wish = {"free": {"braid.angle": "40 deg to 45 deg"}, "objective": {"maximise": "force", "pressure": "1 bar"},
            "designs": 16}  # fmt: skip
    told = answered(socket, "design", look() | (wish | more if more else {}))["error"]
    assert words in told
    assert "/tmp" not in told


def test_two_goals_give_the_front_of_the_library(socket: Any) -> None:
    free = {"braid.angle": "42 deg to 55 deg", "braid.radius": "8 mm to 14 mm"}
    goals = [
        {"maximise": "force", "pressure": "1 bar", "contraction": "5 %"},
        {"minimise": "diameter", "pressure": "1 bar"},
    ]
    told = answered(socket, "design", look() | {"free": free, "objective": goals, "designs": 64})
    assert told["progress"] == {"done": 64, "of": 64}
    front = told["done"]["front"]
    found = mk.design(
        mk.presets.paper(), free, [mk.Maximise(mk.ForceAt(pressure="1 bar", contraction="5 %")),
                                   mk.Minimise(mk.Diameter(pressure="1 bar"))], designs=64,
    )  # fmt: skip
    forces, diameters = (found.front[name].values for name in ("force", "diameter"))
    order = forces.argsort(kind="stable")
    assert front["goals"][0]["values"] == pytest.approx(forces[order].tolist(), rel=1e-5)
    assert front["goals"][1]["values"] == pytest.approx((1e3 * diameters[order]).tolist(), rel=1e-5)
    assert [goal["short"] for goal in front["goals"]] == ["Force [N]", "Largest diameter [mm]"]
    assert [goal["better"] for goal in front["goals"]] == ["larger is better", "smaller is better"]
    assert [muscle_of(one) for one in front["muscles"]] == [found.member(int(k)) for k in order]
    assert muscle_of(front["muscles"][front["middle"]]) == found.muscle
    assert front["numbers"] == list(free)


def test_effects_tell_how_far_they_are(socket: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    two = [one for one in experiment.EFFECTS if one.field in ("chamber.lies", "ends")]
    monkeypatch.setattr(experiment, "EFFECTS", tuple(two))
    seen: list[Any] = []
    socket.send_text(json.dumps({"id": 5, "task": "effects", "said": look(hold="contraction", value=-0.2)}))
    while not seen or seen[-1]["part"] not in ("done", "error"):
        seen.append(socket.receive_json())
    assert [one["data"] for one in seen[:-1]] == [{"done": k, "of": 2} for k in range(3)]
    found = mk.effects(mk.presets.paper(), contraction=-0.2, pressure="1 bar").table
    rows = {row["effect"]: row for row in seen[-1]["data"]["rows"]}
    assert list(rows) == found.index.tolist()
    for name, row in rows.items():
        assert row["force"] == pytest.approx(found.loc[name, "force [%]"], rel=1e-4)


def test_a_page_has_a_pool_for_long_jobs_of_its_own() -> None:
    page = held.Page(PAPER)
    assert page.tasks["effects"] is page.tasks["design"] is page.jobs
    assert page.jobs is not page.beside
