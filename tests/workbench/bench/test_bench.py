"""Benchmarks say what they promise, in the promised shape; how fast anything is, no test asks."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator

import numpy as np
import pytest
import torch

from agents.numerics import matmul_route
from sim.errors import UsageError
from sim.reference import ReferenceWorld
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Fate, World
from workbench.bench import growth as bench_growth
from workbench.bench import learner as bench_learner
from workbench.bench import openings as bench_openings
from workbench.bench import page as bench_page
from workbench.bench import sim as bench_sim
from workbench.bench.growth import Growth, GrowthCase
from workbench.bench.openings import Openings
from workbench.bench.page import BenchError, PageBench
from workbench.bench.sim import SimCase
from workbench.cli import main
from workbench.commands import bench

SIM_KEYS = {"work", "lanes", "threads", "device", "env_steps_per_s", "reference_env_steps_per_s"}
LEARNER_KEYS = {
    "batch", "device", "updates_per_s", "reference_updates_per_s", "sb3_updates_per_s",
    "reference_same_products_updates_per_s", "sb3_same_products_updates_per_s",
}  # fmt: skip
PAGE_KEYS = {"first_page_s", "flights_drawn_s", "switch_s", "scrub_hz", "runs_open_s", "runs_filter_s", "compare_s"}


@pytest.fixture
def _restore_torch() -> Iterator[None]:
    matmul = torch.backends.mkldnn.matmul
    before = matmul.fp32_precision
    yield
    matmul.fp32_precision = before
    torch.set_flush_denormal(False)


@pytest.fixture(scope="module")
def sim_cases() -> list[SimCase]:
    heard: list[tuple[int, int]] = []
    cases = bench_sim.bench_sim((1, 32), (1, 2), rounds=1, seconds=(0.0, 0.0), progress=lambda *t: heard.append(t))
    assert heard == [(n, 4) for n in (1, 2, 3, 4)]
    return cases


def test_the_simulator_is_measured_in_every_promised_way(sim_cases: list[SimCase]) -> None:
    assert {field.name for field in dataclasses.fields(SimCase)} == SIM_KEYS
    on_cpu = [case for case in sim_cases if case.device == "cpu"]
    assert sorted((case.lanes, case.threads) for case in on_cpu) == [(1, 1)] * 2 + [(32, 1)] * 2 + [(32, 2)] * 2
    assert len({case.work for case in sim_cases}) == 2
    assert all(case.env_steps_per_s > 0 and case.reference_env_steps_per_s > 0 for case in sim_cases)


def test_four_missiles_really_fly_throughout() -> None:
    work = bench_sim._four_flying(engagements=6)
    world = World(work.task, 8)
    bench_sim.load(world, work, draw=0)
    reference = ReferenceWorld.taking_over(world)
    for _ in range(work.steps):
        world.step(work.act(world.observation))
    reference.step(work.act(reference.observation))
    for each in (world, reference):
        assert each.fate.shape == (8, 4)
        assert (each.fate == Fate.FLYING).all()


def test_lanes_begin_in_all_phases_of_the_flights_that_are_measured() -> None:
    work = bench_sim._dragging(engagements=4, every=50)
    world = World(Task(load_scenario()), 64)
    bench_sim.load(world, work, draw=1)
    assert world.steps.min() < 100
    assert world.steps.max() > 250
    assert {Fate.UNLAUNCHED, Fate.FLYING, Fate.EVADED} <= set(np.unique(world.fate))


@pytest.mark.usefixtures("_restore_torch")
def test_the_learner_is_measured_beside_its_twin_and_another_library(capsys: pytest.CaptureFixture[str]) -> None:
    threads = torch.get_num_threads()
    measured = bench_learner.bench_learner((8,), rounds=1, slice_s=0.0, stored=500)
    (case,) = [dataclasses.asdict(case) for case in measured.cases]
    assert set(case) == LEARNER_KEYS
    assert case["batch"] == 8
    assert all(case[name] > 0 for name in LEARNER_KEYS if name.endswith("_per_s"))
    assert measured.fast_profile_updates_per_s > 0
    assert torch.get_num_threads() == threads
    assert capsys.readouterr().out == ""


@pytest.mark.usefixtures("_restore_torch")
def test_each_turn_has_its_own_matrix_products() -> None:
    seen: list[str] = []
    routes = ("onednn", "default", "onednn")
    for route in routes:
        bench_learner._on(route, lambda _count: seen.append(matmul_route()))(1)
    assert seen == [*routes]


def test_json_is_one_object_and_alone_on_standard_output(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], sim_cases: list[SimCase]
) -> None:
    monkeypatch.setattr(bench_sim, "bench_sim", lambda device, progress: sim_cases)
    monkeypatch.setattr(
        bench_growth, "bench_growth", lambda device: Growth([GrowthCase(1, 0, 20, "cpu", 9.0)], 1e3, 50.0)
    )
    assert main(["bench", "sim", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert len(said["cases"]) == len(sim_cases)
    assert all(set(case) == SIM_KEYS for case in said["cases"])
    assert main(["bench", "sim"]) == 0
    shown = capsys.readouterr().out
    assert "NumPy reference" in shown
    assert "1,000 bytes a lane" in shown


def test_growth_counts_lanes_missiles_and_substeps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_growth, "MANY", 32)
    monkeypatch.setattr(bench_growth, "LANES", (1, 32))
    measured = bench_growth.bench_growth(repeats=1)
    assert {case.missiles_flying for case in measured.growth} == {0, 1, 2, 4, 8}
    assert {case.substeps for case in measured.growth} == {5, 10, 20, 40}
    assert all(case.step_us > 0.0 for case in measured.growth)
    # Two aircraft of 15 numbers and four missiles of 21, and what is read out of them.
    assert 500 < measured.memory_bytes_per_lane < 2000


def test_a_device_that_is_not_there_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "sim", "--device", "cuda:99"]) == 2
    assert "there is no device 'cuda:99'; here are cpu" in capsys.readouterr().err


def test_pages_keep_the_promised_names(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    measured = PageBench(1.0, 1.5, 3.0, 1.0, 12.0, 0.5, 0.25, 4.5)
    monkeypatch.setattr(bench_page, "bench_page", lambda progress: measured)
    assert bench.run(bench.Args("page", json=True)) == 0
    said = json.loads(capsys.readouterr().out)
    assert set(said) >= PAGE_KEYS
    assert said["compare_s"] == 4.5
    assert bench.run(bench.Args("page")) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("scrub") and "12 a second" in line for line in lines)
    assert any(line.startswith("compare") and "4.5 s" in line for line in lines)


def test_openings_tell_of_memory(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    measured = Openings(300, 400.0, 406.0, 2.0, 30.0, 33.0, 1.0)
    monkeypatch.setattr(bench_openings, "bench_openings", lambda openings, progress: measured)
    assert bench.run(bench.Args("page", openings=300)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("before") and "400 MiB" in line for line in lines)


def test_without_playwright_it_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bench_page, "find_spec", lambda name: None)
    assert main(["bench", "page"]) == 1
    assert capsys.readouterr().err == f"workbench: {bench_page.NO_PLAYWRIGHT}\n"


def test_without_chromium_it_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CHROMIUM", "/nowhere/chromium")
    with pytest.raises(BenchError, match="no Chromium found"):
        bench_page.bench_page()
    assert not issubclass(BenchError, UsageError)


def test_anything_else_is_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "coffee"]) == 2
    assert "coffee" in capsys.readouterr().err
