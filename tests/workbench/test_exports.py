"""Engagements as files: whole or not at all, refused in one sentence, and read back by somebody else."""

from __future__ import annotations

import csv
import io
import json
import xml.etree.ElementTree as ElementTree
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from PIL import Image
from rerun.chunk import RrdReader

from layouts.captions import caption
from layouts.letters import evader_inks, letters
from layouts.theme import BRANCH, POLICY_A, POLICY_B, rgb
from sim.errors import SubMasError, UsageError
from sim.task import Task
from sim.trajectory import BodyTrack, Trajectory
from sim.world import Outcome
from tests.engagements import changed
from tests.workbench.flights import branched, ending, shorten_films, unhindered
from workbench import cli, exports
from workbench.acmi.check import check_acmi
from workbench.exports import FORMATS, TOGETHER, ExportError, check_target, encode, export, suffix_of
from workbench.flight_table import table


@pytest.fixture(autouse=True)
def _short_films(monkeypatch: pytest.MonkeyPatch) -> None:
    shorten_films(monkeypatch)


UNITS = ("_s", "_m", "_rad", "_m_s")


def written(flight: Trajectory, folder: Path, suffix: str) -> Path:
    path = folder / f"flight{suffix}"
    export(flight, path)
    return path


def void(flight: Trajectory) -> Trajectory:
    """Only the first instant and the first decision of a flight."""
    tracks = [flight.evader, flight.interceptor]
    first = [BodyTrack(**{f.name: getattr(track, f.name)[:1] for f in fields(track)}) for track in tracks]
    names = ("time_s", "step_time_s", "action_rad", "reward_terms", "observation")
    arrays = {name: getattr(flight, name)[:1] for name in names}
    return replace(flight, evader=first[0], interceptor=first[1], missiles=(), events=(), **arrays)


@pytest.mark.parametrize("name", ["flight.xyz", "flight", "flight.zip", "flight.acmi.zip", ".csv", ".zip.acmi"])
def test_another_suffix_is_refused_in_one_sentence_that_lists_the_legal_ones(name: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as refused:
        check_target(tmp_path / name)
    for suffix in FORMATS:
        assert suffix in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "suffix"),
    [("a.csv", ".csv"), ("A.PNG", ".png"), ("a.acmi", ".acmi"), ("a.txt.acmi", ".acmi"), ("a.Zip.acmi", ".zip.acmi")],
)
def test_the_longest_suffix_counts_in_any_case(name: str, suffix: str) -> None:
    assert suffix_of(Path(name)) == suffix


def test_a_missing_folder_and_a_folder_as_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="there is no folder"):
        check_target(tmp_path / "nowhere" / "flight.csv")
    (tmp_path / "flight.csv").mkdir()
    with pytest.raises(ExportError, match="is a folder"):
        check_target(tmp_path / "flight.csv")


@pytest.mark.parametrize("suffix", FORMATS)
def test_every_format_is_written_whole_and_alone(suffix: str, tmp_path: Path) -> None:
    flight = unhindered()
    path = written(flight, tmp_path, suffix)
    assert list(tmp_path.iterdir()) == [path]
    assert path.stat().st_size > 1000


@pytest.mark.parametrize("suffix", [suffix for suffix in FORMATS if suffix != ".rrd"])
def test_equal_flights_give_equal_files(suffix: str) -> None:
    assert encode(unhindered(), suffix) == encode(unhindered(), suffix)


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), RuntimeError("a bug")])
def test_what_fails_half_way_leaves_the_old_file(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> bytes:
        raise error

    path = tmp_path / "flight.csv"
    path.write_text("old")
    monkeypatch.setitem(exports.FORMATS, ".csv", fail)
    with pytest.raises(ExportError if isinstance(error, OSError) else RuntimeError):
        export(unhindered(), path)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("flight.csv", "old")]


def test_a_disk_that_fills_up_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(SubMasError, match="No space left"):
        export(unhindered(), tmp_path / "flight.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_new_file_is_there_for_others_too(tmp_path: Path) -> None:
    (tmp_path / "plain").write_text("")
    assert written(unhindered(), tmp_path, ".csv").stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize("outcome", [Outcome.EXIT, Outcome.SHOT_DOWN], ids=["exit", "shot_down"])
def test_parquet_and_csv_hold_the_same_columns(outcome: Outcome, tmp_path: Path) -> None:
    flight = ending(outcome)
    parquet = pq.read_table(written(flight, tmp_path, ".parquet"))
    text = pd.read_csv(written(flight, tmp_path, ".csv"))
    assert parquet.column_names == list(text.columns) == list(table(flight))
    for name, column in table(flight).items():
        read = parquet[name].to_pandas().to_numpy(dtype=np.float64)
        assert np.array_equal(read, column, equal_nan=True), name
        assert np.allclose(text[name].to_numpy(dtype=np.float64), column, rtol=1e-8, atol=1e-12, equal_nan=True), name


def test_columns_say_their_unit_and_missiles_that_do_not_fly_are_empty() -> None:
    flight = ending(Outcome.EXIT)
    for name in table(flight):
        assert name.endswith(UNITS) or name == "reward"
    parquet = pq.read_table(io.BytesIO(encode(flight, ".parquet")))
    missile = flight.missiles[0]
    before = int((flight.time_s < missile.launch_s).sum())
    assert parquet["missile_1_range_m"][: before - 1].null_count == before - 1
    first = next(csv.DictReader(io.StringIO(encode(flight, ".csv").decode())))
    assert first["missile_1_range_m"] == ""


def test_a_column_holds_what_its_name_says() -> None:
    flight = ending(Outcome.EXIT)
    columns = table(flight)
    for axis, name in enumerate("xyz"):
        assert np.array_equal(columns[f"evader_{name}_m"], flight.evader.position_m[:, axis])
        assert np.array_equal(columns[f"missile_2_{name}_m"], flight.missiles[1].position_m[:, axis], equal_nan=True)
    assert np.array_equal(columns["interceptor_heading_rad"], flight.interceptor.heading_rad)
    assert np.array_equal(columns["missile_2_azimuth_rad"], flight.missiles[1].azimuth_rad, equal_nan=True)


def test_the_sum_over_steps_of_the_reward_column_is_the_return() -> None:
    flight = ending(Outcome.EXIT)
    columns = table(flight)
    steps = np.searchsorted(columns["time_s"], flight.step_time_s + 1e-9)
    assert columns["reward"][steps].sum() == pytest.approx(flight.episode_return)


def test_parquet_says_what_was_flown() -> None:
    flight = ending(Outcome.SHOT_DOWN)
    metadata = pq.read_table(io.BytesIO(encode(flight, ".parquet"))).schema.metadata
    said = {key.decode(): value.decode() for key, value in metadata.items()}
    task = flight.task
    assert (said["policy"], said["task"], said["scenario"]) == (flight.policy, "target", "drill")
    assert said["scenario_digest"] == task.scenario.digest
    assert (json.loads(said["seed"]), said["outcome"]) == (flight.seed, "shot_down")
    assert json.loads(said["return"]) == pytest.approx(flight.episode_return)
    assert [event["text"] for event in json.loads(said["events"])] == [event.text for event in flight.events]
    assert json.loads(said["missile_fates"])[str(flight.killer)] == "hit"


def test_rerun_reads_its_recording_with_the_blueprint_in_it(tmp_path: Path) -> None:
    flight = ending(Outcome.EXIT)
    reader = RrdReader(written(flight, tmp_path, ".rrd"))
    assert [store.application_id for store in reader.recordings()] == ["submas-workbench"]
    (blueprint,) = reader.blueprints()
    assert blueprint.application_id == "submas-workbench"
    views = reader.store(store=blueprint).summary()
    assert "ViewBlueprint" in views
    assert caption(flight) in "".join(chunk.format() for chunk in reader.stream(store=blueprint))
    entities = {chunk.entity_path for chunk in reader.stream()}
    assert {"/a/space/evader", "/a/space/interceptor", "/a/events"} <= entities
    assert {"/a/azimuth/missile_1", "/a/range/missile_1", "/a/range/interceptor"} <= entities
    assert {f"/a/space/missile_{missile.number}" for missile in flight.missiles} <= entities


def test_rerun_finds_the_evader_where_it_was(tmp_path: Path) -> None:
    flight = unhindered()
    reader = RrdReader(written(flight, tmp_path, ".rrd"))
    chunks = [c.to_record_batch() for c in reader.stream() if c.entity_path == "/a/space/evader" and not c.is_static]
    (batch,) = [batch for batch in chunks if "Points3D:positions" in batch.schema.names]
    seconds = np.array([t.total_seconds() for t in batch.column("sim_time").to_pylist()])
    read = np.array([place[0] for place in batch.column("Points3D:positions").to_pylist()])
    for axis in (0, 1):
        wanted = np.interp(seconds, flight.time_s, flight.evader.position_m[:, axis]) / 1e3
        assert np.allclose(read[:, axis], wanted, atol=0.05)


def test_the_picture_is_a_png_of_the_promised_size_with_its_caption() -> None:
    flight = unhindered()
    with Image.open(io.BytesIO(encode(flight, ".png"))) as picture:
        picture.load()
        assert (picture.format, picture.size) == ("PNG", (1680, 1200))
        assert picture.info["Title"] == caption(flight)
        colours = {colour for _count, colour in picture.convert("RGB").getcolors(maxcolors=10**6)}
    assert {(255, 255, 255), (47, 134, 255), (229, 65, 77), (31, 160, 95)} <= colours


def test_the_scalable_picture_is_svg() -> None:
    root = ElementTree.fromstring(encode(ending(Outcome.SHOT_DOWN), ".svg"))
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 50


@pytest.mark.parametrize("suffix", FORMATS)
def test_no_name_of_a_policy_spoils_a_file(suffix: str) -> None:
    assert encode(replace(unhindered(), policy="x\udcff\x00$\\frac{a,b|c\n<&" + "n" * 500), suffix)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".rrd"])
def test_eight_missiles_fit_into_every_format(suffix: str) -> None:
    flight = ending(Outcome.EXIT, Task(changed(launch={"missiles": 8, "interval_s": 6.0})))
    assert encode(flight, suffix)


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_flight_that_is_void_at_once_is_a_file_all_the_same(suffix: str) -> None:
    flight = void(ending(Outcome.TIMEOUT))
    data = encode(flight, suffix)
    if suffix == ".acmi":
        assert check_acmi(data.decode()) == []
        assert data.count(b"#") == 1


@pytest.mark.parametrize("suffix", FORMATS)
def test_the_command_writes_every_format(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["fly", "random", "--mask", "1,2,3", "--seed", "4", "--out", f"x{suffix}"]) == 0
    assert f"written to x{suffix}" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == [f"x{suffix}"]


@pytest.mark.parametrize("suffix", FORMATS)
def test_two_flights_share_the_files_that_have_room_for_two(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    against = ["--against", "expert-navigation", "--mask", "1,2,3,4", "--out", f"x{suffix}"]
    code = cli.main(["fly", "expert-dragging", *against])
    said = capsys.readouterr()
    assert code == (0 if suffix in TOGETHER else 2)
    assert [path.name for path in tmp_path.iterdir()] == ([f"x{suffix}"] if suffix in TOGETHER else [])
    assert suffix in TOGETHER or said.err.startswith(f"workbench: --out x{suffix} holds one flight; two together fit")


@pytest.mark.parametrize("suffix", sorted(TOGETHER))
def test_a_branch_is_beside_both_flights_in_the_files_that_have_room(suffix: str) -> None:
    pair = ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN)
    data = encode(pair[0], suffix, pair[1], branched())
    assert len(data) > 1.2 * len(encode(pair[0], suffix, pair[1]))
    if suffix == ".gif":
        with Image.open(io.BytesIO(data)) as animation:
            assert b"from 30 s by hand, then circle" in animation.info["comment"]


def test_files_of_a_branch_say_from_when_on_and_who_flew(tmp_path: Path) -> None:
    flight = branched()
    metadata = pq.read_table(io.BytesIO(encode(flight, ".parquet"))).schema.metadata
    told = json.loads(metadata[b"branch"])
    assert told == {
        "left_flight": "B", "flown_until_then_by": "shot_down of a test", "from_s": 30.0, "by_hand_until_s": 90.0,
        "headings_s_deg": [[20, 90], [40, 200]], "then": "circle",
    }  # fmt: skip
    acmi = encode(flight, ".acmi").decode()
    assert check_acmi(acmi) == []
    frame = acmi.index("Event=Bookmark|leaves B: by hand")
    assert acmi[:frame].rsplit("#", 1)[1].startswith("30.000\n")
    assert "Event=Bookmark|handed over to circle" in acmi[frame:]
    with Image.open(io.BytesIO(encode(flight, ".png"))) as picture:
        assert "from 30 s by hand, then circle" in picture.info["Title"]
        colours = {colour for _count, colour in picture.convert("RGB").getcolors(maxcolors=10**6)}
    assert rgb(BRANCH) in colours
    assert b"branch" not in pq.read_table(io.BytesIO(encode(ending(Outcome.EXIT), ".parquet"))).schema.metadata


def test_rerun_has_a_column_for_the_branch_in_its_colour(tmp_path: Path) -> None:
    path = tmp_path / "three.rrd"
    export(ending(Outcome.EXIT), path, ending(Outcome.SHOT_DOWN), branched())
    reader = RrdReader(path)
    assert "/c/space/evader" in {chunk.entity_path for chunk in reader.stream()}
    (blueprint,) = reader.blueprints()
    assert "B′ · shot_down" in "".join(chunk.format() for chunk in reader.stream(store=blueprint))
    assert evader_inks([ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN), branched()]) == (POLICY_A, POLICY_B, BRANCH)
    assert (letters([branched()]), evader_inks([branched()])) == (("",), (POLICY_A,))


def test_a_second_policy_without_a_file_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fly", "random", "--against", "expert-dragging"]) == 2
    assert "--against expert-dragging needs --out" in capsys.readouterr().err


def test_the_help_of_fly_names_every_format(capsys: pytest.CaptureFixture[str]) -> None:
    cli.main(["fly", "--help"])
    shown = capsys.readouterr().out
    assert all(suffix in shown for suffix in FORMATS)
