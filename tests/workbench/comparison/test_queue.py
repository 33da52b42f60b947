"""The queue of comparisons: real processes that fly, end, die and are asked again."""

from __future__ import annotations

import asyncio
import dataclasses
import subprocess
from collections.abc import Callable

import pytest

from tests.workbench.comparison.works import some_work
from workbench.comparison import work as work_module
from workbench.comparison.cache import ComparisonCache
from workbench.comparison.queue import ComparisonQueue
from workbench.comparison.work import Work
from workbench.runs import RunStore

PATIENCE_S = 300.0


def _until(queue: ComparisonQueue, works: list[Work], over: Callable[[], bool]) -> None:
    async def wait() -> None:
        queue.want(works)
        async with asyncio.timeout(PATIENCE_S):
            while not over():
                await asyncio.sleep(0.02)
        await queue.close()

    asyncio.run(wait())


def test_processes_fly_what_is_wanted_and_a_second_look_is_immediate(store: RunStore, cache: ComparisonCache) -> None:
    works = [some_work(store, policy) for policy in ("expert-dragging", "expert-navigation")]
    queue = ComparisonQueue(store.root, cache, workers=1)
    _until(queue, [*works, works[0]], lambda: all(cache.has(work) for work in works))
    one = cache.evaluation(works[0])
    assert one is not None and one.policy == "expert-dragging"
    again = ComparisonQueue(store.root, cache)
    again.want(works)  # outside an event loop: nothing is started
    assert all(again.standing(work) is None for work in works)


def test_what_is_dropped_ends_and_leaves_no_result(store: RunStore, cache: ComparisonCache) -> None:
    long, waiting = some_work(store, episodes=10_000), some_work(store, "expert-navigation", episodes=9_999)
    queue = ComparisonQueue(store.root, cache, workers=1)

    async def story() -> None:
        queue.want([long, waiting])
        async with asyncio.timeout(PATIENCE_S):
            while queue.state(long) != "flying":
                await asyncio.sleep(0.02)
            assert queue.state(waiting) == "waiting"
            process = queue._flying[long].process
            queue.drop([long, waiting])
            assert queue.standing(long) is None and queue.standing(waiting) is None
            assert process.wait(PATIENCE_S) != 0
        await queue.close()

    asyncio.run(story())
    assert not cache.has(long) and not cache.has(waiting)


def test_what_another_page_waits_for_is_not_dropped(store: RunStore, cache: ComparisonCache) -> None:
    work = some_work(store, episodes=10_000)
    queue = ComparisonQueue(store.root, cache, workers=1)

    async def story() -> None:
        queue.want([work], asker="one page")
        queue.want([work], asker="another")
        queue.drop([work], "one page")
        assert queue.state(work) == "waiting"
        queue.leave("another")  # its tab was closed: the work goes on, and whoever cancels next ends it
        assert queue.state(work) == "waiting"
        queue.drop([work], "one page")
        assert queue.standing(work) is None
        await queue.close()

    asyncio.run(story())


def test_a_worker_that_dies_is_told_of_and_its_work_can_be_asked_for_again(
    store: RunStore, cache: ComparisonCache
) -> None:
    work = some_work(store, episodes=10_000)
    queue = ComparisonQueue(store.root, cache, workers=1)

    async def story() -> None:
        queue.want([work])
        async with asyncio.timeout(PATIENCE_S):
            while queue.state(work) != "flying":
                await asyncio.sleep(0.02)
            queue._flying[work].process.kill()
            while queue.state(work) != "failed":
                await asyncio.sleep(0.02)
        standing = queue.standing(work)
        assert standing is not None and "ended" in standing.error
        queue.want([work])
        assert queue.state(work) == "waiting"
        await queue.close()

    asyncio.run(story())


def test_a_mistake_is_one_sentence(store: RunStore, cache: ComparisonCache) -> None:
    work = dataclasses.replace(some_work(store), scenario="nowhere")
    queue = ComparisonQueue(store.root, cache, workers=1)
    told: list[str] = []

    def over() -> bool:
        standing = queue.standing(work)
        told.append(standing.error if standing else "")
        return bool(told[-1])

    _until(queue, [work], over)
    assert "nowhere" in told[-1] and "Traceback" not in told[-1]


def test_a_result_of_other_code_is_not_waited_for_again_and_again(
    store: RunStore, cache: ComparisonCache, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work_module, "source", lambda: "what this process was started with")
    work = some_work(store)
    queue = ComparisonQueue(store.root, cache, workers=1)
    told: list[str] = []

    def over() -> bool:
        standing = queue.standing(work)
        told.append(standing.error if standing else "gone")
        return bool(told[-1])

    _until(queue, [work], over)
    assert "start it again" in told[-1]
    assert not cache.has(work) and len(list(cache.folder.iterdir())) == 1


@pytest.mark.parametrize("after", ["", "waiting", "flying"])
def test_a_server_that_ends_takes_its_workers_along(store: RunStore, cache: ComparisonCache, after: str) -> None:
    work, queue = some_work(store, episodes=10_000), ComparisonQueue(store.root, cache, workers=1)

    async def story() -> subprocess.Popen[bytes] | None:
        queue.want([work])
        while after and queue.state(work) != after:
            await asyncio.sleep(0.02)
        await asyncio.sleep(0.0 if not after else 0.02)
        return queue._flying[work].process if queue._flying else None

    process = asyncio.run(story())  # returns: nothing is waited for
    assert process is None or process.returncode is not None
