"""Stories of `workbench reproduce`: real processes around a fake learner and a fake evaluator."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.scenario_file import load_scenario
from workbench import launcher
from workbench.reproduce import evaluations, session
from workbench.reproduce.cost import cost
from workbench.reproduce.job import LOCKS, Job, job_path, read_job
from workbench.reproduce.plan import make_plan, training_of
from workbench.reproduce.protocol import Item
from workbench.reproduce.result_file import load
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.scorecard import complete
from workbench.reproduce.seed_counts import SeedCounts
from workbench.reproduce.session import BusyError, Report, Session
from workbench.reproduce.watch import Standing, Watch
from workbench.run_files import take_lock
from workbench.runs import RunStore

HERE = Path(__file__).parent
PATIENCE_S = 60.0


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunStore]:
    """An empty runs folder; none of its processes outlives the test."""
    monkeypatch.setattr(launcher, "ENTRY", (str(HERE / "fake_training.py"),))
    monkeypatch.setattr(evaluations, "ENTRY", (str(HERE / "fake_workbench.py"),))
    monkeypatch.setattr(session, "TICK_S", 0.02)
    for module in (launcher, session):
        monkeypatch.setattr(module, "cpu_count", lambda: 4)
    store = RunStore(tmp_path / "runs")
    store.root.mkdir()
    (store.root / "scenario.txt").write_text(load_scenario().digest)
    tell(store)
    yield store
    for run in store.list():
        if run.state.pid and run.is_alive():
            os.kill(run.state.pid, signal.SIGKILL)
    for child in launcher._children:
        child.kill()
        child.wait()
    launcher._children.clear()


def tell(store: RunStore, **told: str) -> None:
    words = {name.replace("_", " "): word for name, word in told.items()}
    (store.root / "told.json").write_text(json.dumps(words))


class Quiet(Watch):
    """Keeps what is said; may press Ctrl-C after some rounds with a training under way."""

    def __init__(self, interrupt: bool = False) -> None:
        super().__init__()
        self.lines: list[str] = []
        self.standings: list[Standing] = []
        self._interrupt = interrupt

    def say(self, text: str) -> None:
        self.lines.append(text)

    def show(self, standing: Standing) -> None:
        self.standings.append(standing)
        if self._interrupt and standing.running and all(run.state.pid for run in standing.running):
            raise KeyboardInterrupt


def reproduce(store: RunStore, item: Item = "fig9", seeds: int = 1, watch: Watch | None = None) -> Report:
    plan = make_plan(item, "smoke", SeedCounts.each(seeds), 100)
    return Session([plan], store, store.root / "results").run(watch or Quiet())


def written(store: RunStore, item: Item = "fig9") -> ResultSet:
    result = load(store.root / "results" / f"{item}.json")
    assert result is not None
    return result


def flown(store: RunStore) -> list[str]:
    log = store.root / "flown.txt"
    return sorted(log.read_text().splitlines()) if log.exists() else []


@pytest.fixture(autouse=True)
def _broken_ppo_is_left_out(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Three algorithms are enough for a story, unless it is about the one that cannot be evaluated."""
    if "ppo" not in request.node.name:
        from workbench.reproduce import plan

        monkeypatch.setattr(plan, "VARIANTS", {name: v for name, v in plan.VARIANTS.items() if name != "ppo"})


def test_what_is_missing_is_trained_evaluated_and_written_and_a_second_time_nothing(store: RunStore) -> None:
    report = reproduce(store)
    assert not report.failures and not report.interrupted
    result = written(store)
    assert report.results["fig9"] == result
    assert {(t.variant, t.seed, t.state) for t in result.trainings} == {
        ("submas", 0, "finished"), ("td3", 0, "finished"), ("sac", 0, "finished"),
    }  # fmt: skip
    submas = result.number("submas", "target", 0)
    assert submas is not None
    assert (submas.success_rate, submas.mean_return, submas.epochs, submas.env_steps) == (0.9, 90.0, 2, 2000)
    assert submas.command == f"workbench evaluate runs/{submas.run}/policies/target.safetensors " + (
        f"--episodes 100 --seed {2**46}"
    )
    (curve,) = [curve for curve in result.curves if curve.variant == "submas"]
    assert (curve.env_steps, curve.success_rate) == ((1000, 2000), (0.05, 0.1))
    # Its chain has four stages, the others one.
    assert {t.variant: t.env_steps for t in result.trainings} == {"submas": 8000, "td3": 2000, "sac": 2000}
    runs, before = {run.id for run in store.list()}, flown(store)
    assert len(runs) == 3 and len(before) == 3
    reproduce(store)
    assert ({run.id for run in store.list()}, flown(store), written(store)) == (runs, before, result)


def test_a_failed_training_is_told_and_holds_nothing_up(store: RunStore) -> None:
    tell(store, td3_0="fail", sac_0="die")
    watch = Quiet()
    report = reproduce(store, watch=watch)
    assert {sentence.split(",")[0] for sentence in report.failures} == {"TD3 seed 0", "SAC seed 0"}
    assert any("the learner is broken" in sentence for sentence in report.failures)
    result = written(store)
    assert {(t.variant, t.state) for t in result.trainings} == {
        ("submas", "finished"), ("td3", "failed"), ("sac", "interrupted"),
    }  # fmt: skip
    assert [number.variant for number in result.numbers] == ["submas"]
    assert len(store.list()) == 3  # not tried again and again
    tell(store)
    assert not reproduce(store).failures
    assert {number.variant for number in written(store).numbers} == {"submas", "td3", "sac"}
    # The good one was kept, the failed one trained anew, and the interrupted one went on.
    assert len(store.list()) == 4
    (resumed,) = [run for run in store.list() if run.config.variant == "sac"]
    assert (resumed.state.state, resumed.state.resumes) == ("finished", 1)


def test_a_policy_that_cannot_be_evaluated_is_told_ppo(store: RunStore) -> None:
    report = reproduce(store)
    (sentence,) = report.failures
    assert sentence.startswith("evaluation of runs/") and sentence.endswith("failed: the policy is broken")
    assert {number.variant for number in written(store).numbers} == {"submas", "td3", "sac"}


def test_after_ctrl_c_trainings_go_on_nothing_is_started_and_the_same_command_picks_them_up(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    tell(store, submas_0="wait", td3_0="wait", sac_0="wait")
    monkeypatch.setattr(launcher, "cpu_count", lambda: 2)
    watch = Quiet(interrupt=True)
    report = reproduce(store, watch=watch)
    assert report.interrupted and not report.failures
    runs = {run.id for run in store.list()}
    assert len(runs) == 2
    assert all(run.is_alive() for run in store.list())
    assert "2 trainings go on in the background" in watch.lines[-1] and "same command" in watch.lines[-1]
    assert load(store.root / "results" / "fig9.json") is not None
    (store.root / "go").touch()
    assert not reproduce(store).failures
    assert runs < {run.id for run in store.list()}
    assert len(store.list()) == 3
    assert len(written(store).numbers) == 3


def test_what_has_finished_is_evaluated_and_nothing_is_trained_or_waited_for_if_wished(store: RunStore) -> None:
    reproduce(store, seeds=1)
    runs = {run.id: run.state for run in store.list()}
    waiting = store.create(training_of("submas", "smoke", 1))
    plan = make_plan("fig9", "smoke", SeedCounts.each(2), 100)
    watch = Quiet()
    report = Session([plan], store, store.root / "results", finished_only=True).run(watch)
    assert not report.failures and not report.interrupted
    assert {run.id for run in store.list()} == {*runs, waiting.id} and waiting.state.state == "queued"
    result = written(store)
    finished = {run.config.variant for run in store.list() if run.state.state == "finished"}
    assert {(one.variant, one.seed) for one in result.trainings} == {(variant, 0) for variant in finished}
    assert "submas" in finished
    assert result.asked_for("submas") == 2 and not complete(result)
    assert watch.standings[-1].left_s == 0.0, "nobody waits for what is not trained"
    assert {number.seed for number in result.numbers} == {0}


def test_another_machine_adds_what_is_missing_to_what_is_there(store: RunStore) -> None:
    reproduce(store, seeds=1)
    first, results = written(store), store.root / "results"
    for run in store.list():
        shutil.rmtree(run.path)
    plan = make_plan("fig9", "smoke", SeedCounts.each(2), 100)
    watch = Quiet()
    assert not Session([plan], store, results, add=True).run(watch).failures
    assert {run.config.seed for run in store.list()} == {1}
    result = written(store)
    assert len(result.trainings) == len(result.numbers) == 6
    for rows in ("trainings", "numbers", "curves"):
        assert [row for row in getattr(result, rows) if row.seed == 0] == list(getattr(first, rows))
    assert watch.standings[0].left_s > 0.0
    assert watch.standings[-1].summary.startswith("3/3 trained, 3/3 evaluated")


def test_a_training_that_somebody_else_runs_is_waited_for(store: RunStore) -> None:
    tell(store, td3_0="wait")
    theirs = launcher.launch(store, training_of("td3", "smoke", 0))
    (store.root / "go").touch()
    reproduce(store)
    (number,) = [number for number in written(store).numbers if number.variant == "td3"]
    assert number.run == theirs.id


def test_a_run_of_another_scenario_does_not_count(store: RunStore) -> None:
    reproduce(store)
    (run,) = [run for run in store.list() if run.config.variant == "td3"]
    (run.path / "policy.json").write_text(json.dumps({"scenario_digest": "another"}))
    assert load_scenario().digest != "another"
    reproduce(store)
    assert sum(run.config.variant == "td3" for run in store.list()) == 2


def test_a_result_of_another_source_is_flown_again(store: RunStore) -> None:
    reproduce(store)
    path = store.root / "results" / "fig9.json"
    path.write_text(path.read_text().replace(written(store).source_digest, "000000000000"))
    before = len(flown(store))
    reproduce(store)
    assert len(flown(store)) == 2 * before


def test_cores_are_not_overbooked(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (launcher, session):
        monkeypatch.setattr(module, "cpu_count", lambda: 2)
    watch = Quiet()
    reproduce(store, seeds=2, watch=watch)
    assert max(len(standing.running) for standing in watch.standings) <= 2
    assert len(store.list()) == 6
    assert [standing.trained for standing in watch.standings] == sorted(s.trained for s in watch.standings)
    assert watch.standings[0].left_s > 0.0
    assert watch.standings[-1].summary == "6/6 trained, 6/6 evaluated, about 0:00 left"


def test_two_at_once_in_one_folder_are_refused(store: RunStore) -> None:
    lock = take_lock(store.root / LOCKS["trainings"])
    assert lock is not None
    with contextlib.closing(os.fdopen(lock)), pytest.raises(BusyError, match="another reproduction works in"):
        reproduce(store)
    assert not store.list()


def test_result_sets_are_written_while_trainings_go_on(store: RunStore) -> None:
    tell(store, submas_0="wait")

    class Releasing(Quiet):
        """Lets the long training go as soon as the short ones are in the file."""

        def show(self, standing: Standing) -> None:
            super().show(standing)
            result = load(store.root / "results" / "fig9.json")
            if result is not None and len(result.numbers) == 2:
                (store.root / "go").touch()
            assert time.monotonic() < deadline

    deadline = time.monotonic() + PATIENCE_S
    reproduce(store, watch=Releasing())
    assert len(written(store).numbers) == 3


def test_runs_copied_together_from_other_folders_count_as_they_are(store: RunStore, tmp_path: Path) -> None:
    reproduce(store)
    first = written(store)
    elsewhere = RunStore(tmp_path / "elsewhere")
    elsewhere.root.mkdir()
    for name in ("scenario.txt", "told.json"):
        shutil.copy(store.root / name, elsewhere.root / name)
    for run in store.list():
        shutil.move(run.path, elsewhere.root / run.id)
    assert not reproduce(elsewhere).failures
    moved = written(elsewhere)
    assert {run.run for run in moved.trainings} == {run.run for run in first.trainings}
    assert len(elsewhere.list()) == 3  # nothing was trained again
    assert (moved.numbers, moved.curves) == (first.numbers, first.curves)
    # Flown from where they lie now, told as a reader would write it.
    assert all(line.startswith(str(elsewhere.root)) for line in flown(elsewhere))
    assert all(number.command.startswith("workbench evaluate runs/") for number in moved.numbers)


def test_a_run_that_was_copied_without_its_policies_is_trained_again(store: RunStore) -> None:
    reproduce(store)
    (run,) = [run for run in store.list() if run.config.variant == "submas"]
    (run.path / "policies" / "source-2.safetensors").unlink()
    assert not reproduce(store).failures
    assert sum(run.config.variant == "submas" for run in store.list()) == 2


def test_how_it_stands_is_in_a_file_while_it_works_and_afterwards(store: RunStore) -> None:
    class Looking(Quiet):
        """Reads the file as a page would."""

        def show(self, standing: Standing) -> None:
            super().show(standing)
            seen.append(read_job(store.root, "trainings"))

    seen: list[Job | None] = []
    reproduce(store, watch=Looking())
    assert {(job.state, job.pid, job.items, job.profile) for job in seen if job} == {
        ("running", os.getpid(), ("fig9",), "smoke")
    }
    last = read_job(store.root, "trainings")
    assert last is not None and (last.state, last.running) == ("finished", ())
    assert last.doing.startswith("3/3 trained, 3/3 evaluated") and last.share == 1.0
    assert any(line == "TD3 seed 0 is trained" for line in last.lines)
    assert read_job(store.root, "flights") is None


def test_one_that_was_killed_is_known_to_have_died(store: RunStore) -> None:
    reproduce(store)
    path = job_path(store.root, "trainings")
    path.write_text(path.read_text().replace('"finished"', '"running"'))
    last = read_job(store.root, "trainings")
    assert last is not None and last.state == "died"
    path.write_text("[]")
    assert read_job(store.root, "trainings") is None


def test_the_cost_counts_what_is_missing(store: RunStore) -> None:
    plan = make_plan("fig9", "smoke", SeedCounts.each(2), 100)
    before = cost(plan, store)
    assert (before.trainings, before.there, before.under_way, before.evaluations) == (6, 0, 0, 6)
    reproduce(store)
    after = cost(plan, store)
    assert (after.trainings, after.there, after.under_way) == (6, 3, 0)
    assert 0.0 < after.left_s < before.left_s
