"""The small training, which on a cluster waits in its first attempt until it is killed or told to go on.

The run's name says when and for what: "hold=3 go=FILE" waits behind the checkpoint of the third epoch for FILE.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path

from agents import numerics
from agents.snapshot import Snapshot
from tests.reliability.small_training import learn, one_route
from workbench import launcher, pulse, training
from workbench.recorder import RunRecorder

save = RunRecorder.checkpoint


def checkpoint(recorder: RunRecorder, take: Callable[[], Snapshot]) -> None:
    save(recorder, take)
    told = dict(word.split("=", 1) for word in recorder.run.config.name.split())
    while (
        recorder.state.engine
        and not recorder.state.retries
        and len(recorder.run.metrics()) == int(told.get("hold", 0))
        and not Path(told["go"]).exists()
    ):
        time.sleep(0.02)


numerics.choose_matmul_route = one_route
pulse.SAVING_SHARE = math.inf
launcher.ENTRY = (str(Path(__file__).resolve()),)
training._learn = learn
RunRecorder.checkpoint = checkpoint

if __name__ == "__main__":
    sys.exit(training.main())
