"""What the paper says about its figures, point by point, and what a result set says to that."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median, pstdev
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from agents.statistics import Interval, bootstrap, interquartile_mean
from workbench.reproduce.paper_numbers import EXPERT_ON_TARGET, HOURS_PER_TASK
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import BASELINES, LABELS, TRAINED_FOR, Item
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.text_table import points_text, share_text, success_text

Verdict = Literal["yes", "no", "undecided", "–"]
"""Whether a point holds here: undecided where intervals leave both possible, a dash where there is nothing to judge."""
Finding = tuple[Verdict, str]
"""A verdict and the figures behind it."""
CLOSE: Final = 0.1
"""Success rates this near to each other count as the same."""
FEWEST: Final = 3
"""Seeds on either side of a comparison below which it decides nothing."""
POOR: Final = 0.2
"""A success rate below this counts as very poor."""


@dataclass(frozen=True)
class Point:
    """One statement of the paper, and how it is checked."""

    says: str
    where: str
    """Section of the paper."""
    find: Callable[[ResultSet], Finding]
    """Raises LookupError while the numbers for it are missing."""


def finding(point: Point, result: ResultSet | None) -> Finding | None:
    """What a result set says to a point; None while it has not the numbers for it."""
    try:
        return point.find(result) if result is not None else None
    except LookupError:
        return None


def difference(one: Sequence[float], other: Sequence[float]) -> Interval:
    """Interquartile mean of one set of seeds minus that of another, with its bootstrap interval.

    Of fewer than FEWEST seeds a bootstrap pretends to know what it cannot: then the bounds are NaN.

    Raises:
        LookupError: a set is empty.
    """
    if not one or not other:
        raise LookupError("no seed")
    count = len(one)
    interval = bootstrap(
        [one, other], lambda runs: interquartile_mean(runs[..., :count]) - interquartile_mean(runs[..., count:])
    )
    unknown = np.array(np.nan)
    return interval if min(len(one), len(other)) >= FEWEST else Interval(interval.value, unknown, unknown)


def above(interval: Interval, bound: float = 0.0) -> Verdict:
    """Whether a value surely lies above a bound; without an interval nothing is sure."""
    return "yes" if interval.low > bound else "no" if interval.high < bound else "undecided"


def within(interval: Interval, bound: float) -> Verdict:
    """Whether a value surely lies between -bound and bound."""
    if interval.low > -bound and interval.high < bound:
        return "yes"
    return "no" if interval.low > bound or interval.high < -bound else "undecided"


def every(verdicts: Iterable[Verdict]) -> Verdict:
    """Whether all hold."""
    given = set(verdicts)
    return "no" if "no" in given else "undecided" if "undecided" in given else "yes"


def _finals(result: ResultSet, variant: str, task: str = "target") -> list[float]:
    """Success rate of every seed on the reported episodes."""
    return [number.success_rate for number in result.reported(variant, task)]


def _returns(result: ResultSet, variant: str) -> list[float]:
    return [number.mean_return for number in result.reported(variant, "target")]


def _firsts(result: ResultSet, variant: str, task: str) -> list[float]:
    """Success rate of every seed at the first held-out evaluation of a stage: its jump-start."""
    curves = [curve for curve in result.curves if (curve.variant, curve.task) == (variant, task)]
    return [curve.success_rate[0] for curve in curves if curve.success_rate]


def _best_of_all(result: ResultSet) -> Finding:
    ours = _finals(result, "submas")
    others = {v: difference(ours, _finals(result, v)) for v in TRAINED_FOR["table4"][1:] if _finals(result, v)}
    if not others:
        raise LookupError("no other algorithm")
    words = ", ".join(f"{LABELS[variant]} {points_text(interval)}" for variant, interval in others.items())
    return every(above(interval) for interval in others.values()), f"SubMas-RL minus each other: {words}"


def _time_per_task(result: ResultSet) -> Finding:
    chains = [one for one in result.trainings if one.variant == "submas" and one.state == "finished"]
    if not chains:
        raise LookupError("no training")
    clock, core = (median(getattr(one, name) for one in chains) / 60 for name in ("wall_s", "cpu_s"))
    words = f"all four tasks take {core:.0f} min of one core's time ({clock:.0f} min by the clock of a busy machine)"
    return "–", f"{words}, median of {len(chains)} seeds, profile {result.profile}"


def _same_jump_start(result: ResultSet) -> Finding:
    gaps = [difference(_firsts(result, "submas", task), _firsts(result, "wo-pd", task)) for task in CHAIN[1:]]
    words = ", ".join(points_text(gap) for gap in gaps)
    return every(within(gap, CLOSE) for gap in gaps), f"SubMas-RL minus w/oPd at the first evaluation, by task: {words}"


def _lower_without_distillation(result: ResultSet) -> Finding:
    ours, theirs = _finals(result, "submas"), _finals(result, "wo-pd")
    gap = difference(ours, theirs)
    spread = " and ".join(share_text(pstdev(shares)) for shares in (ours, theirs))
    return above(gap), f"target task: SubMas-RL minus w/oPd {points_text(gap)}; standard deviations {spread}"


def _cold_without_reuse(result: ResultSet) -> Finding:
    starts = [difference(_firsts(result, "submas", task), _firsts(result, "wo-pr", task)) for task in CHAIN[2:]]
    easy, hard = (bootstrap([_finals(result, "wo-pr", task)]) for task in ("source-3", "target"))
    poor: Verdict = "yes" if hard.high < POOR else "no" if hard.low > POOR else "undecided"
    words = f"w/oPr ends at {share_text(easy.value)} in source task 3 and {share_text(hard.value)} in the target task; "
    words += "SubMas-RL starts the later tasks higher by " + ", ".join(points_text(start) for start in starts)
    verdicts: list[Verdict] = [poor, *(above(start) for start in starts)]
    return every(verdicts), words


def _decay_is_slower(result: ResultSet) -> Finding:
    gaps = {
        variant: [difference(_finals(result, "submas", t), _finals(result, variant, t)) for t in ("source-3", "target")]
        for variant in ("dec-pd", "dec-pr")
    }
    words = [f"{LABELS[v]} {points_text(easy)}, then {points_text(hard)}" for v, (easy, hard) in gaps.items()]
    early: list[Verdict] = [within(easy, CLOSE) for easy, _ in gaps.values()]
    late: list[Verdict] = [above(hard) for _, hard in gaps.values()]
    return every([*early, *late]), f"SubMas-RL minus it in source task 3, then in the target task: {'; '.join(words)}"


def _only_submas_succeeds(result: ResultSet) -> Finding:
    best = {variant: max(_finals(result, variant)) for variant in BASELINES if _finals(result, variant)}
    ours = _finals(result, "submas")
    if not ours or not best:
        raise LookupError("no seed")
    words = ", ".join(f"{LABELS[variant]} {share_text(share)}" for variant, share in best.items())
    holds = min(ours) > 0.0 and max(best.values()) < 0.01
    verdict: Verdict = "no" if not holds else "yes" if len(best) == len(BASELINES) else "undecided"
    return verdict, f"worst seed of SubMas-RL {share_text(min(ours))}; best seeds: {words}"


def _order_of_returns(result: ResultSet) -> Finding:
    sac, td3, ppo = (_returns(result, variant) for variant in ("sac", "td3", "ppo"))
    gaps = [difference(sac, td3), difference(td3, ppo)]
    words = [f"{LABELS[v]} {interquartile_mean(r):.1f}" for v, r in (("sac", sac), ("td3", td3), ("ppo", ppo))]
    return every(above(gap) for gap in gaps), ", ".join(words)


def _expert_keeps_the_beam(result: ResultSet) -> Finding:
    share = _beam(result, "expert")
    return "yes" if share > 0.5 else "no", f"within 15° of ±90° for {share_text(share)} of the time"


def _submas_keeps_it_too(result: ResultSet) -> Finding:
    expert, ours = _beam(result, "expert"), _beam(result, "submas")
    words = f"within 15° of ±90° for {share_text(ours)} of the time, the expert for {share_text(expert)}"
    return "yes" if ours > 0.5 * expert else "no", words


def _beam(result: ResultSet, variant: str) -> float:
    # An index that is not there is the LookupError that says "not run yet".
    return [flight.beam_share for flight in result.flights if flight.variant == variant][0]  # noqa: RUF015


def _expert_on_target(result: ResultSet) -> Finding:
    number = result.reported("expert", "target")[0]
    low, high = number.success_ci95
    return "yes" if low <= EXPERT_ON_TARGET <= high else "no", success_text(number)


def _submas_above_expert(result: ResultSet) -> Finding:
    pairs = [(result.reported("submas", task)[0], result.reported("expert", task)[0]) for task in CHAIN]
    never_below = all(ours.success_ci95[1] >= expert.success_ci95[0] for ours, expert in pairs)
    above_at_last = pairs[-1][0].success_ci95[0] > pairs[-1][1].success_ci95[1]
    words = ", ".join(f"{100 * (ours.success_rate - expert.success_rate):+.1f}" for ours, expert in pairs)
    return "yes" if never_below and above_at_last else "no", f"points of success above the expert, by task: {words}"


def _harder_tasks(result: ResultSet) -> Finding:
    ends = [[result.reported(v, task)[0] for task in (CHAIN[0], CHAIN[-1])] for v in ("submas", "expert")]
    verdicts: list[Verdict] = [
        "yes" if hard.success_ci95[1] < easy.success_ci95[0]
        else "no" if hard.success_ci95[0] > easy.success_ci95[1] else "undecided"
        for easy, hard in ends
    ]  # fmt: skip
    words = "; ".join(f"{LABELS[easy.variant]} {success_text(easy)}, {success_text(hard)}" for easy, hard in ends)
    return every(verdicts), f"without missiles, then with four: {words}"


POINTS: Final[Mapping[Item, tuple[Point, ...]]] = MappingProxyType(
    {
        "table4": (
            Point("SubMas-RL has the highest success rate of all algorithms", "§4.3", _best_of_all),
            Point(f"one task takes about {HOURS_PER_TASK:.0f} h on 32 cores and two GPUs", "§4.1", _time_per_task),
        ),
        "fig8": (
            Point("without distillation the jump-start is the same", "§4.2", _same_jump_start),
            Point("without distillation seeds spread more and end lower", "§4.2", _lower_without_distillation),
            Point("without reuse it starts cold and ends very poor in the target task", "§4.2", _cold_without_reuse),
            Point("decayed weights are as good in source task 3, slightly worse later", "§4.2", _decay_is_slower),
        ),
        "fig9": (
            Point("only SubMas-RL succeeds; TD3, PPO and SAC stay at 0 %", "§4.3", _only_submas_succeeds),
            Point("SAC gets a higher return than TD3, and TD3 than PPO", "§4.3", _order_of_returns),
        ),
        "fig12": (
            Point("the expert always keeps the closest missile at ±90°", "§4.4", _expert_keeps_the_beam),
            Point("SubMas-RL shows almost the same trend and attempts ±90° too", "§4.4", _submas_keeps_it_too),
        ),
        "fig13": (
            Point(f"the expert succeeds in {share_text(EXPERT_ON_TARGET)} of target tasks", "§4.4", _expert_on_target),
            Point("SubMas-RL surpasses the expert overall", "§4.4", _submas_above_expert),
            Point("both get worse as the task becomes more difficult", "§4.4", _harder_tasks),
        ),
    }
)
"""What the paper says about each of its items."""
