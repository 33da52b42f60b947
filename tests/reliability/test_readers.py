"""R16: who reads a run while it is written, or cut back and written again, sees whole epochs and each of them once."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from agents.disk import Disk
from tests.reliability.failing_disk import installed
from tests.reliability.in_process import train
from workbench.checkpoint_manifest import manifest_numbers
from workbench.run_files import LineReader, RunFileError, cut_back
from workbench.runs import RunStore

Config = Callable[..., TrainingConfig]


def test_metrics_shorter_than_at_the_checkpoint_are_an_error(tmp_path: Path) -> None:
    path = tmp_path / "metrics.jsonl"
    path.write_text("{}\n")
    with pytest.raises(RunFileError, match=r"metrics.jsonl is 3 bytes long and was 4 at the last checkpoint"):
        cut_back(path, 4)


def test_a_reader_begins_again_when_rows_are_made_again(tmp_path: Path) -> None:
    path = tmp_path / "metrics.jsonl"
    path.write_text('{"epoch":1}\n{"epoch":2}\n{"epoch":3}\n')
    reader = LineReader(path)
    assert len(reader.read_new()) == 3 and not reader.anew
    cut_back(path, 24)
    with path.open("a") as file:
        file.write('{"epoch":33}\n{"epoch":44}\n')
    assert [row["epoch"] for row in reader.read_new()] == [1, 2, 33, 44] and reader.anew
    assert reader.read_new() == [] and not reader.anew


class Slow(Disk):
    """Writes in two halves, with time for a reader in between."""

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        half = len(data) // 2
        super().write(descriptor, memoryview(data)[:half])
        time.sleep(0.001)
        super().write(descriptor, memoryview(data)[half:])

    def sync(self, descriptor: int) -> None:
        pass


def test_readers_beside_a_writer_see_whole_epochs_only(store: RunStore, config: Config) -> None:
    # R16: every row is whole, none is missed, none comes twice, and no checkpoint is ahead of the rows.
    run, over = store.create(config("epochs=60 epoch_s=0")), threading.Event()

    def read() -> list[int]:
        reader, seen = LineReader(run.path / "metrics.jsonl"), list[int]()
        while True:
            last = over.is_set()
            saved = next(iter(manifest_numbers(run.path / "checkpoints")), 0)
            seen += [row["epoch"] for row in reader.read_new()]
            assert len(seen) >= saved
            if last:
                return seen

    with installed(Slow()), ThreadPoolExecutor(4) as pool:
        readers = [pool.submit(read) for _ in range(4)]
        try:
            train(run, store)
        finally:
            over.set()
        assert [reader.result() for reader in readers] == [list(range(1, 61))] * 4
