"""The page by its messages: numbers are the library's, wrong input is one message, files can be read again."""

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pages import PAPER, answered, client, look
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

import mckibben as mk
from mckibben.page.curves import pressures_with
from mckibben.page.session import LONGEST
from mckibben.page.shape import as_made
from mckibben.page.transfers import CASE
from mckibben.view.braid3d import SKIN

pytestmark = pytest.mark.page


@pytest.fixture(scope="module")
def page() -> Iterator[TestClient]:
    with client() as made:
        yield made


@pytest.fixture
def socket(page: TestClient) -> Iterator[Any]:
    with page.websocket_connect("/socket") as made:
        yield made


def changed(**values: Any) -> dict[str, Any]:
    return PAPER | {"changes": {name.replace("__", "."): value for name, value in values.items()}}


def test_the_page_and_its_parts_are_served(page: TestClient) -> None:
    for path, start in (("/", "<!doctype html>"), ("/page.js", "/*! mckibben"), ("/page.css", "/*! mckibben")):
        found = page.get(path)
        assert found.status_code == 200
        assert found.text.startswith(start)
    start = page.get("/start").json()
    assert start["start"] == PAPER
    assert [one["name"] for one in start["presets"]] == list(mk.presets.names())


@pytest.mark.parametrize("path", ["/../pyproject.toml", "/assets/page.js", "/%2e%2e/serve.py", "/index.html"])
def test_nothing_else_is_served(page: TestClient, path: str) -> None:
    assert page.get(path).status_code == 404


def test_a_preset_opens_with_a_slider_for_each_number(socket: Any) -> None:
    told = answered(socket, "open", PAPER)["done"]
    sliders = {one["name"]: one for one in told["sliders"]}
    assert told["from"] == {"preset": "paper"}
    radius = sliders["braid.radius"]
    assert (radius["value"], radius["unit"], radius["assumed"]) == (12.5, "mm", False)
    assert radius["least"] < 12.5 < radius["most"]
    assert sliders["braid.fibres"]["value"] == 56
    assert sliders["chamber.law.c1"]["log"]
    assert sliders["chamber.law.c2"]["least"] < 0.0
    assert {one["name"] for one in told["assumed"]} == set(mk.presets.paper().assumed)
    assert (told["top"], told["most"]) == (1e5, 1.5e5)


def test_every_preset_opens_within_its_sliders(socket: Any) -> None:
    for number, name in enumerate(mk.presets.names()):
        told = answered(socket, "open", {"from": {"preset": name}}, number)["done"]
        assert len({one["name"] for one in told["sliders"]}) == len(told["sliders"])
        for one in told["sliders"]:
            assert one["least"] <= one["value"] <= one["most"], (name, one)
            assert 0.0 < one["step"] < one["most"] - one["least"]
        for one in told["choices"]:
            assert one["value"] in [option for option, _ in one["options"]], (name, one)


def test_an_angle_keeps_the_words_of_its_maker(socket: Any) -> None:
    told = answered(socket, "open", {"from": {"preset": "festo-dmsp-20"}})["done"]
    angle = next(one for one in told["sliders"] if one["name"] == "braid.angle")
    assert angle["value"] == pytest.approx(28.6)
    assert angle["label"].endswith("from the axis")


def test_a_look_has_the_numbers_of_the_library(socket: Any) -> None:
    parts = answered(socket, "look", look(changed(braid__angle="38 deg"), hold="contraction", value=-0.1, pressure=5e4))
    muscle = mk.presets.paper().replace("braid.angle", "38 deg")
    state = mk.solve(muscle, contraction=-0.1, pressure="0.5 bar")
    told = parts["state"]
    assert (told["verdict"], told["good"], told["drawn"]) == ("stable", True, "")
    assert told["point"]["force"] == pytest.approx(state.force, rel=1e-11)
    assert told["point"]["length"] == pytest.approx(state.length, rel=1e-11)
    shown = {name: (value, unit) for name, value, unit in told["numbers"]}
    assert shown["axial force, positive in tension"] == (f"{state.force:.5g}", "N")
    parts_of_energy = sum(one["value"] for one in told["energy"])
    assert parts_of_energy == pytest.approx(float(state.data["energy"]), rel=1e-5)
    shape = told["shape"]
    assert max(shape["r"]) == pytest.approx(float(state.data["r"].max()), rel=1e-4)
    assert shape["z"][-1] - shape["z"][0] == pytest.approx(state.length, rel=1e-5)
    assert max(shape["tension"]) == pytest.approx(float(state.data["fibre_tension"].max()), rel=1e-2)
    levels = parts["done"]["levels"]
    assert [level["pressure"] for level in levels] == pytest.approx([1e5 / 3, 5e4, 2e5 / 3, 1e5])
    assert [level["present"] for level in levels] == [False, True, False, False]
    free = mk.solve(muscle, force="0 N", pressure="0.5 bar")
    assert levels[1]["free"]["value"] == pytest.approx(free.contraction, abs=1e-6)
    blocked = mk.solve(muscle, contraction=0.0, pressure="0.5 bar")
    assert levels[1]["blocked"]["value"] == pytest.approx(blocked.force, rel=1e-4)


def test_a_state_that_cannot_be_shows_the_last_good_one(socket: Any) -> None:
    told = answered(socket, "look", look(hold="contraction", value=-0.6))["state"]
    assert told["verdict"] == "no equilibrium"
    assert "fibres are straight" in told["said"]
    assert told["drawn"].startswith("Shown is")
    assert told["point"]["force"] is None
    assert not told["good"]


def test_four_pressures_always() -> None:
    for present in (0.0, 1e3, 1e5 / 3, 5e4, 1e5, 1.5e5):
        found = pressures_with(present, 1e5)
        assert len(set(found)) == 4
        assert list(found) == sorted(found)
        assert present in found


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (look(changed(braid__angle="95 deg")), "braid.angle"),
        (look(changed(braid__fibres=57)), "must be even"),
        (look(changed(braid__colour="red")), "braid.colour"),
        (look({"from": {"preset": "papre"}}), 'did you mean "paper"'),
        (look({"from": {"preset": "paper"}, "changes": {f"x{k}": 1 for k in range(200)}}), "at most 100"),
        (look({"from": json.loads("[" * 40 + "]" * 40)}), "muscle"),
        (look("paper"), "muscle"),
        (look(hold="volume"), "force or contraction"),
        (look(pressure=-1.0), "pressure"),
        (look(pressure=True), "pressure"),
        (look(value="20 N"), "value"),
        (look(top=0.0), "top"),
        (look(pressure=1e300), "pressure"),
    ],
)  # fmt: skip
def test_wrong_input_is_one_message(socket: Any, said: dict[str, Any], words: str) -> None:
    told = answered(socket, "look", said)["error"]
    assert words in told
    assert "\n" not in told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    "rubbish",
    [
        "", "{", "null", "[]", "17", '"look"', "{}", '{"id":1}', '{"id":"1","task":"look","said":{}}',
        '{"id":true,"task":"look","said":{}}', '{"id":1,"task":"look","said":[]}', '{"id":1,"task":"system","said":{}}',
        '{"id":1,"task":"file","said":{"kind":"toml","folder":"/tmp"}}', '{"id":1,"task":"look","said":{"value":NaN}}',
        "[" * 50_000, "x" * (LONGEST + 1),
    ],
)  # fmt: skip
def test_rubbish_ends_the_socket_with_a_word(socket: Any, rubbish: str) -> None:
    socket.send_text(rubbish)
    told = socket.receive_json()
    assert told["part"] == "rubbish"
    assert "this is no page of ours" in told["data"]
    with pytest.raises(WebSocketDisconnect) as closed:
        socket.receive_json()
    assert closed.value.code == 1008


def test_bytes_on_the_socket_are_rubbish(socket: Any) -> None:
    socket.send_bytes(b"\x00\xff")
    assert socket.receive_json()["part"] == "rubbish"


def test_a_case_file_is_opened(page: TestClient) -> None:
    text = '[muscle]\npreset = "paper"\nbraid.angle = "36 deg"\n[test]\nkind = "isometric"\nlength = "85 mm"\n'
    text += 'pressure = "0 to 2 bar"\n'
    told = page.post("/case?name=my.toml", content=text).json()
    angle = next(one for one in told["sliders"] if one["name"] == "braid.angle")
    assert angle["value"] == pytest.approx(36.0)
    assert told["name"] == "paper (changed)"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"[muscle\n", "my.toml: is not valid TOML"),
        (b"\xff\xfe", "my.toml: is not UTF-8"),
        (b'[muscle]\npreset="paper"\n[sweep]\n', "describes a sweep"),
        (b"[muscle]\n[muscle.braid]\nradius = 12.5\n", "braid."),
        (b"a." * 5000 + b"b = 1", "within each other"),
        (b'[muscle]\npreset = "paper"\nchamber = { law = { name = "custom" } }', "law"),
    ],
)  # fmt: skip
def test_a_wrong_case_file_is_one_message(page: TestClient, content: bytes, said: str) -> None:
    answer = page.post("/case?name=../../my.toml", content=content)
    assert answer.status_code == 400
    told = answer.json()["error"]
    assert said in told
    assert "mckibben-page" not in told
    assert "\n" not in told


def test_a_large_upload_is_not_read(page: TestClient) -> None:
    read = 0

    def pieces() -> Iterator[bytes]:
        nonlocal read
        for _ in range(50):
            read += 1_000_000
            yield b"x" * 1_000_000

    answer = page.post("/case?name=large.toml", content=b"", headers={"content-length": "50000000"})
    assert answer.status_code == 413
    assert answer.json()["error"] == "the file is too large: a case file has at most 2 MB"
    assert page.post("/case", content=pieces()).status_code == 413
    assert read > CASE


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1:1"])
def test_another_page_gets_nothing(page: TestClient, origin: str) -> None:
    assert page.post("/case", content="", headers={"origin": origin}).status_code == 403
    with pytest.raises(WebSocketDisconnect), page.websocket_connect("/socket", headers={"origin": origin}):
        pass


@pytest.fixture(scope="module")
def asked() -> dict[str, Any]:
    return look(hold="contraction", value=-0.2)


def downloaded(page: TestClient, kind: str, asked: dict[str, Any], folder: Path) -> Path:
    answer = page.post(f"/file/{kind}", content=json.dumps(asked))
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-disposition"] == f'attachment; filename="paper.{kind}"'
    place = folder / f"paper.{kind}"
    place.write_bytes(answer.content)
    return place


def test_downloads_can_be_read_again(page: TestClient, asked: dict[str, Any], tmp_path: Path) -> None:
    case = mk.read_case(downloaded(page, "toml", asked, tmp_path))
    assert case.muscle == mk.presets.paper()
    assert case.test is not None
    curve = mk.load(downloaded(page, "nc", asked, tmp_path))
    assert isinstance(curve, mk.Result)
    assert (curve.muscle, curve.test) == (case.muscle, case.test)
    rows = list(csv.DictReader(io.StringIO(downloaded(page, "csv", asked, tmp_path).read_text(encoding="utf-8"))))
    assert [float(row["force [N]"]) for row in rows] == pytest.approx(curve.force.tolist())
    assert "braid.fibres" in downloaded(page, "txt", asked, tmp_path).read_text(encoding="utf-8")
    assert downloaded(page, "glb", asked, tmp_path).read_bytes().startswith(b"glTF")


@pytest.mark.parametrize(
    ("kind", "content", "status"),
    [("exe", "{}", 404), ("toml", "[", 400), ("toml", "[1]", 400), ("toml", "{}", 400), ("..%2fx", "{}", 404)],
)
def test_a_wrong_download_is_one_message(page: TestClient, kind: str, content: str, status: int) -> None:
    answer = page.post(f"/file/{kind}", content=content)
    assert answer.status_code == status


def test_the_range_is_that_of_limits(socket: Any) -> None:
    told = answered(socket, "reach", look())["done"]
    found = mk.limits(mk.presets.paper(), pressure="1 bar")
    assert told["shortest"] == pytest.approx(found.shortest, rel=1e-11)
    assert told["longest"] == pytest.approx(found.longest, rel=1e-11)
    assert told["cause"] == found.shortest_cause


def test_the_newest_look_wins(socket: Any) -> None:
    for number in range(20):
        said = look(hold="contraction", value=-0.01 * number)
        socket.send_text(json.dumps({"id": number, "task": "look", "said": said}))
    done: list[int] = []
    while not done or done[-1] != 19:
        message = socket.receive_json()
        if message["part"] == "done":
            done.append(message["id"])
    assert done[-1] == 19
    assert len(done) < 20


def test_bellows_whose_wall_is_not_told_are_drawn_as_made() -> None:
    """What is drawn where no stable state was found on the way."""
    bellows = mk.Chamber(law=mk.Bellows(axial_stiffness="50 N"))
    drawn = as_made(mk.presets.paper().replace("chamber", bellows))
    assert drawn["wall"] == [pytest.approx(SKIN * 0.0125)] * len(drawn["r"])
