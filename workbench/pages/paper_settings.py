"""Tables 1 to 3 of the paper beside what the code holds: state spaces, hyperparameters, variants."""

from __future__ import annotations

import dataclasses
from typing import Any

from agents.config import PROFILES, VARIANTS
from layouts.theme import NEUTRAL, missile_colour
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.pages.paper_sheet import Block, Part, heading, part, table, words
from workbench.reproduce.paper_numbers import TABLE_1, TABLE_2, TABLE_3
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import LABELS, SCENARIO, TASK_LABELS
from workbench.reproduce.setting_reasons import FAST_BECAUSE

SYMBOLS = {"psi": "ψ", "theta_AA": "θ_AA", "theta_ATA": "θ_ATA", "phi_exit": "φ_Exit"}


def table1_blocks() -> list[Block]:
    """State spaces of all tasks (Table 1): kept columns, and struck out those that Ψ takes."""
    scenario = load_scenario(SCENARIO)
    target = Task(scenario)
    rows = []
    for task_name in reversed(CHAIN):
        missiles = CHAIN.index(task_name)
        task = Task(scenario, frozenset(range(missiles + 1, scenario.launch.missiles + 1)))
        kept = task.layout.names
        chips = [_column(name, name in kept) for name in target.layout.names]
        same = part("as in the paper") if kept == TABLE_1[task_name] else part("differs", tone="differs")
        mask = ",".join(map(str, sorted(task.masked)))
        see = part("on Curriculum", href=f"/curriculum?mask={mask}" if mask else "/curriculum")
        rows.append([[part(TASK_LABELS[task_name])], chips, [part(f"{len(kept)}")], [same], [see]])
    columns = ["task", ("state space", "kept by Ξ (Eq. 5, 6); struck out: masked, Ψ"), "numbers", "paper", ""]
    return [
        table(columns, rows),
        words(
            "Read from the code as it runs (sim/observation.py, sim/task.py). x, y: place of the evader; ψ: its yaw; "
            "l: distance to the interceptor; θ_AA, θ_ATA: aspect and antenna train angle; φ_Exit: azimuth of the exit; "
            "r_k, φ_k: distance and azimuth of missile k, (−1, −π) while it does not fly.",
            "quiet",
        ),
    ]


def table2_blocks() -> list[Block]:
    """Hyperparameters (Table 2), the paper's beside both profiles, and what else `fast` changes."""
    paper, fast = PROFILES["paper"], PROFILES["fast"]
    rows = []
    for name, (label, symbol, value) in TABLE_2.items():
        ours, quick = getattr(paper, name), getattr(fast, name)
        rows.append([[part(label, sub=symbol)], [part(_text(value))], [_against(ours, value)], [_against(quick, value)],
                     [part(FAST_BECAUSE.get(name, ""))]])  # fmt: skip
    silent = [
        [[part(name)], [part(_text(getattr(paper, name)))], [_against(getattr(fast, name), getattr(paper, name))],
         [part(why)]]
        for name, why in FAST_BECAUSE.items()
        if name not in TABLE_2
    ]  # fmt: skip
    return [
        table(["hyperparameter", "the paper", "profile paper", "profile fast", "why fast differs"], rows),
        heading("Where Table 2 is silent", "the paper follows OpenAI SpinningUp there; what the profile fast changes"),
        table(["setting", "profile paper", "profile fast", "why"], silent),
        words(
            "Read from the code as it runs (agents/hyperparameters.py); marked values differ from the paper.", "quiet"
        ),
    ]


def table3_blocks() -> list[Block]:
    """Ablations (Table 3), and the baselines of §4.3 in the same terms."""
    rows = []
    for name, row in TABLE_3.items():
        variant = VARIANTS[name]
        ours = (variant.distillation, variant.reuse, variant.alpha if variant.distillation else "",
                variant.epsilon if variant.reuse else "")  # fmt: skip
        cells = [[part(_mark(value))] for value in ours]
        same = part("as in the paper") if ours == row else part("differs", tone="differs")
        train = part("train it", href=f"/curriculum?variant={name}")
        rows.append([[part(LABELS[name], sub=name)], *cells, [same], [train]])
    learners = {"td3": "TD3", "sac": "SAC (Stable-Baselines3)", "ppo": "PPO (Stable-Baselines3)"}
    baselines = [
        [[part(LABELS[name], sub=name)], [part(learners[VARIANTS[name].algorithm])], [part("no guide, no curriculum")],
         [part("train it", href=f"/curriculum?variant={name}&what=stage")]]
        for name in ("td3", "ppo", "sac")
    ]  # fmt: skip
    return [
        table(["algorithm", "Pd", "Pr", "α", "ε", "paper", ""], rows),
        words(
            "Pd: policy distillation (Eq. 14, 15); Pr: policy reuse (Eq. 17, 18). Read from agents/config.py.", "quiet"
        ),
        heading("The baselines of §4.3", "they learn the target task from scratch"),
        table(["algorithm", "learner", "knowledge transfer", ""], baselines),
    ]


def differing_settings() -> int:
    """Settings of Table 2 in which `fast` differs from the paper."""
    fast = dataclasses.asdict(PROFILES["fast"])
    return sum(fast[name] != value for name, (_, _, value) in TABLE_2.items())


def _column(name: str, kept: bool) -> Part:
    kind, _, number = name.rpartition("_")
    missile = number.isdigit()
    text = f"{'φ' if kind == 'phi' else kind}{_subscript(number)}" if missile else SYMBOLS.get(name, name)
    ink = missile_colour(int(number)) if missile else NEUTRAL
    return part(text, ink=ink, strike=not kept, tone="" if kept else "waiting")


def _subscript(number: str) -> str:
    return "".join("₀₁₂₃₄₅₆₇₈₉"[int(digit)] for digit in number)


def _against(value: Any, paper: Any) -> Part:
    return part(_text(value), tone="" if value == paper else "differs")


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ",\u00a0".join(map(str, value)) + "]"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}".replace(",", "\u202f") if isinstance(value, int) else f"{value:.6g}"


def _mark(value: bool | str) -> str:
    return {True: "✓", False: "✗", "": "–"}.get(value, str(value))
