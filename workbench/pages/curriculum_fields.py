"""The fields of the launch form, filled from the address as far as it says something legal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import panel_material_ui as pmui

from workbench.pages.curriculum_set import CHAIN, STAGE
from workbench.policies import policy_choices
from workbench.runs import RunStore

VARIANTS = {
    "SubMas-RL": "submas",
    "W/o-PD": "wo-pd",
    "W/o-PR": "wo-pr",
    "Dec-PD": "dec-pd",
    "Dec-PR": "dec-pr",
    "TD3": "td3",
    "SAC": "sac",
    "PPO": "ppo",
}
"""Table 3's variants and the baselines, as the paper calls them."""
VARIANT_HELP = (
    "W/o-PD: without policy distillation. W/o-PR: without policy reuse. Dec-PD, Dec-PR: their weight decays by a "
    "schedule. TD3, SAC, PPO: the task alone, from scratch, without guide or chain."
)
PROFILES = {
    "fast: minutes a stage": "fast",
    "paper: Table 2, hours": "paper",
    "smoke: seconds, to try": "smoke",
}
NATURAL = "the usual one"
PLAIN = {"& .MuiToggleButton-root": {"textTransform": "none"}}
"""Words on buttons as they are written."""


def make_fields(query: Mapping[str, str], store: RunStore) -> dict[str, Any]:
    """The widgets by name; what the address says of them is taken where it is one of the choices."""
    guides = {NATURAL: "", **policy_choices(store)}
    what = CHAIN if query.get("what", "chain") == "chain" else STAGE
    variants = [name for name in query.get("variant", "").split(",") if name in VARIANTS.values()]
    return {
        "what": pmui.RadioButtonGroup(
            options=[CHAIN, STAGE], value=what, color="primary", size="small", margin=0, width=330, sizing_mode="fixed",
            sx=PLAIN,
        ),
        "variant": pmui.CheckButtonGroup(
            options=VARIANTS, value=variants or ["submas"], color="primary", size="small", margin=0,
            sizing_mode="stretch_width", sx=PLAIN,
        ),
        "profile": _select("Profile", PROFILES, query.get("profile", ""), 200),
        "guide": _select("Guide of the first stage", guides, query.get("guide", ""), 260),
        "seeds": _text("Seeds: 0 or 0,1,2 or 0-4", query.get("seeds", "0")[:200], 190),
        "name": _text("Name (optional)", "", 200),
    }  # fmt: skip


def _select(label: str, options: Mapping[str, str], wanted: str, width: int) -> pmui.Select:
    value = wanted if wanted in options.values() else next(iter(options.values()))
    return pmui.Select(
        label=label, options=dict(options), value=value, size="small", margin=0, width=width, sizing_mode="fixed"
    )


def _text(label: str, value: str, width: int) -> pmui.TextInput:
    return pmui.TextInput(
        label=label, value=value, max_length=200, size="small", margin=0, width=width, sizing_mode="fixed"
    )
