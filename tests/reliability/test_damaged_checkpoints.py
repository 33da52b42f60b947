"""A checkpoint is used only if it is what was written; else the one before, with a sentence that says why (R4)."""

from __future__ import annotations

import json
import math
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from agents.config import TrainingConfig
from agents.snapshot import Snapshot
from tests.reliability.fake_training import Slots
from tests.reliability.in_process import train
from workbench import pulse
from workbench.checkpoint_manifest import Manifest, Part
from workbench.checkpoints import Checkpoint, CheckpointError, Checkpoints
from workbench.recorder import DivergedError
from workbench.runs import Run, RunStore

RUN = "20260101-000000-aaaaaa"
NEWEST = ("manifest-000003.json", "state-000003.safetensors", "replay-000003-0.safetensors")


def snapshot(epoch: int) -> Snapshot:
    arrays = {
        "learner/actor": np.full((3, 2), epoch, np.float32),
        "updates": np.array(epoch),
        "flags": np.ones(3, bool),
    }
    return Snapshot(0, {"epoch": epoch, "generator": 2**127 + epoch}, arrays, Slots(epoch))


def saved(folder: Path, run: str = RUN, epochs: int = 3) -> Path:
    """The checkpoints of so many epochs."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    checkpoints = Checkpoints(folder, run)
    for epoch in range(1, epochs + 1):
        checkpoints.save(snapshot(epoch), {"epoch": epoch})
    return folder


def latest(folder: Path, run: str = RUN) -> Checkpoint:
    found = Checkpoints(folder, run).latest()
    assert found is not None
    return found


def epoch_of(checkpoint: Checkpoint) -> int:
    """Its epoch, if all of it is as `snapshot` made it."""
    epoch = checkpoint.facts["epoch"]
    expected = snapshot(epoch)
    assert checkpoint.snapshot.values == expected.values
    for name, array in expected.arrays.items():
        found = checkpoint.snapshot.arrays[name]
        assert (found.dtype, found.shape) == (array.dtype, array.shape)
        np.testing.assert_array_equal(found, array)
    assert checkpoint.snapshot.slots is not None and expected.slots is not None
    kept, whole = checkpoint.snapshot.slots, expected.slots
    oldest = max(0, epoch - 4)
    ours = np.concatenate([rows[max(oldest - first, 0) :] for first, rows in kept.blocks(oldest)])
    np.testing.assert_array_equal(ours, np.concatenate([rows for _, rows in whole.blocks(0)]))
    assert kept.added == whole.added == epoch
    return epoch


def test_what_is_saved_is_found_again_and_two_are_kept(tmp_path: Path) -> None:
    for epochs in range(1, 10):
        folder = saved(tmp_path / str(epochs), epochs=epochs)
        assert epoch_of(latest(folder)) == epochs
        names = sorted(path.name for path in folder.iterdir())
        assert [name for name in names if name[0] == "m"] == [
            f"manifest-{n:06}.json" for n in (epochs - 1, epochs) if n
        ]
        # The ring holds four slots; the older of the two checkpoints needs one more.
        assert sum(name.startswith("replay") for name in names) == min(epochs, 5)


def test_no_checkpoint_is_none(tmp_path: Path) -> None:
    assert Checkpoints(tmp_path / "absent", RUN).latest() is None


def cut(keep: Callable[[int], int]) -> Callable[[Path], object]:
    return lambda path: os.truncate(path, keep(path.stat().st_size))


def flip(at: float) -> Callable[[Path], object]:
    def damage(path: Path) -> None:
        data = bytearray(path.read_bytes())
        data[int(at * (len(data) - 1))] ^= 4
        path.write_bytes(data)

    return damage


def replaced_by(make: Callable[[Path], object]) -> Callable[[Path], object]:
    return lambda path: (path.unlink(), make(path))


DAMAGE: dict[str, Callable[[Path], object]] = {
    "empty": cut(lambda size: 0),
    "one byte": cut(lambda size: 1),
    "half": cut(lambda size: size // 2),
    "one byte short": cut(lambda size: size - 1),
    "a byte too many": lambda path: path.write_bytes(path.read_bytes() + b"x"),
    **{f"a bit at {at:.0%}": flip(at) for at in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)},
    "gone": lambda path: path.unlink(),
    "a folder": replaced_by(lambda path: path.mkdir()),
    "a pipe": replaced_by(os.mkfifo),
    "a link to nowhere": replaced_by(lambda path: path.symlink_to("/nowhere")),
    "a link to its twin": replaced_by(lambda path: path.symlink_to(path.name.replace("3", "2"))),
    "zeros": lambda path: path.write_bytes(bytes(path.stat().st_size)),
    "text": lambda path: path.write_text("hello"),
    "deeply nested": lambda path: path.write_text("[" * 100_000),
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("name", NEWEST)
def test_a_damaged_checkpoint_is_refused_by_name_and_the_one_before_is_taken(
    name: str, damage: str, tmp_path: Path
) -> None:
    folder = saved(tmp_path / "checkpoints")
    DAMAGE[damage](folder / name)
    if damage == "gone" and name.startswith("manifest"):
        assert epoch_of(latest(folder)) == 2  # as if it had never been written
        return
    found = latest(folder)
    assert epoch_of(found) == 2
    (reason,) = found.refused
    assert reason.startswith("checkpoint 3 cannot be used: ") and name in reason and len(reason) < 400
    # The next save takes the damaged one's place.
    checkpoints = Checkpoints(folder, RUN)
    checkpoints.latest()
    if damage != "a folder":
        checkpoints.save(snapshot(3), {"epoch": 3})
        assert epoch_of(latest(folder)) == 3 and not latest(folder).refused


def test_parts_of_another_run_are_refused(tmp_path: Path) -> None:
    folder, other = saved(tmp_path / "a"), tmp_path / "b"
    checkpoints = Checkpoints(other, "20260101-000000-bbbbbb")
    for epoch in (11, 12, 13):
        checkpoints.save(snapshot(epoch), {"epoch": epoch})
    shutil.copy(other / "state-000003.safetensors", folder / "state-000003.safetensors")
    assert "state-000003.safetensors is damaged" in latest(folder).refused[0]
    shutil.copy(other / "manifest-000003.json", folder / "manifest-000003.json")
    assert "belongs to checkpoint 3 of run 20260101-000000-bbbbbb" in latest(folder).refused[0]


def test_a_checkpoint_of_a_later_version_says_so(tmp_path: Path) -> None:
    folder = saved(tmp_path / "checkpoints")
    path = folder / NEWEST[0]
    content = json.loads(path.read_text())
    content["checkpoint"]["schema"] = 99
    path.write_text(json.dumps(content))
    assert "has format 99, this version reads 1; use the version that wrote it" in latest(folder).refused[0]


@pytest.mark.parametrize("name", ["../../state-000001.safetensors", "/etc/passwd", "state-1.safetensors", "", "a\nb"])
def test_a_manifest_cannot_name_a_file_elsewhere(name: str, tmp_path: Path) -> None:
    folder = saved(tmp_path / "checkpoints")
    Manifest(RUN, 3, 0, {}, {"epoch": 3}, None, (Part(name, 1, "0" * 64),)).write(folder)
    assert "names a part that is none" in latest(folder).refused[0]


def test_two_damaged_checkpoints_are_an_error_with_both_reasons(tmp_path: Path) -> None:
    folder = saved(tmp_path / "checkpoints")
    for name in ("state-000002.safetensors", "state-000003.safetensors"):
        (folder / name).write_bytes(b"")
    with pytest.raises(CheckpointError, match=r"has no whole checkpoint: checkpoint 3 .* checkpoint 2 ") as refused:
        Checkpoints(folder, RUN).latest()
    assert refused.value.exit_code == 3
    assert "state-000003.safetensors is 0 bytes long" in str(refused.value)


def test_a_new_stage_leaves_the_experience_of_the_last_one_behind(tmp_path: Path) -> None:
    folder = saved(tmp_path / "checkpoints")
    checkpoints = Checkpoints(folder, RUN)
    checkpoints.latest()
    for epoch in (1, 2):
        one = snapshot(epoch)
        checkpoints.save(Snapshot(1, one.values, one.arrays, one.slots), {"epoch": epoch})
    assert epoch_of(latest(folder)) == 2
    assert len(list(folder.glob("replay-*"))) == 2


def test_a_learner_without_experience_has_none_on_disk(tmp_path: Path) -> None:
    checkpoints = Checkpoints(tmp_path / "checkpoints", RUN)
    checkpoints.save(Snapshot(0, {}, {"x": np.zeros(2)}), {"epoch": 1})
    assert latest(tmp_path / "checkpoints").snapshot.slots is None


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.setattr(pulse, "SAVING_SHARE", math.inf)
    return RunStore(tmp_path / "runs").create(
        TrainingConfig(profile="smoke", name="epochs=6 epoch_s=0 weights_nan_at=4")
    )


def test_weights_that_are_not_finite_end_the_run_and_are_never_saved(run: Run) -> None:
    # R14; the losses of an epoch may all be finite when its last step is not.
    with pytest.raises(DivergedError, match="learning diverged: non-finite actor in target"):
        train(run, RunStore(run.path.parent))
    found = Checkpoints(run.path / "checkpoints", run.id).latest()
    assert found is not None and found.snapshot.values["epoch"] == 3


def test_a_number_that_is_not_finite_is_not_saved_either(tmp_path: Path) -> None:
    folder = saved(tmp_path / "checkpoints")
    checkpoints = Checkpoints(folder, RUN)
    checkpoints.latest()
    with pytest.raises(Exception, match="a number is not finite"):
        checkpoints.save(Snapshot(0, {"beta": math.nan}, {"x": np.zeros(2)}), {"epoch": 4})
    assert epoch_of(latest(folder)) == 3
