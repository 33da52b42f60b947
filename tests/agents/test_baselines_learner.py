"""SAC and PPO have the numbers they are said to have, and their policies are ours to the last digit that counts."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from safetensors.numpy import save

from agents.baselines_learner import LEARNERS, BaselineLearner, Ppo, Sac
from agents.baselines_world import TaskVecEnv
from agents.checkpoint import PolicyFileError, card_from_json, load_policy, save_policy
from agents.config import PROFILES, Hyperparameters
from agents.evasion import EVASION
from agents.policy import NetworkPolicy
from sim.task import task_for
from tests.agents.test_checkpoint import CARD
from tests.agents.test_policy import observations

TASK = task_for()
FEATURES = EVASION.features(TASK.layout)


def learner_of(name: str, hyper: Hyperparameters = PROFILES["smoke"], literal: bool = False, seed: int = 0) -> Any:
    env = TaskVecEnv(EVASION, TASK, 4, seed, hyper.reward_scale)
    return LEARNERS[name](env, hyper, seed, literal)


def policy_of(learner: BaselineLearner) -> NetworkPolicy:
    bends = {"activation": learner.activation, "squash": learner.squash}
    return NetworkPolicy("made", FEATURES, learner.layers(), EVASION.action_limit, **bends)  # type: ignore[arg-type]


def loud(learner: Any, factor: float = 30.0, bias: float = 0.0) -> Any:
    """The same learner with a larger output; with a bias actions run into their limit."""
    head = learner.model.actor.mu if isinstance(learner, Sac) else learner.model.policy.action_net
    head.weight.data *= factor
    head.bias.data += bias
    return learner


@pytest.mark.parametrize("name", LEARNERS)
@pytest.mark.parametrize(("factor", "bias"), [(1.0, 0.0), (30.0, 0.0), (30.0, 5.0)])
def test_the_librarys_action_is_ours(name: str, factor: float, bias: float) -> None:
    learner = loud(learner_of(name), factor, bias)
    policy, seen = policy_of(learner), observations(TASK.layout, 300)
    expected, _ = learner.model.predict(FEATURES.encode(seen), deterministic=True)
    np.testing.assert_allclose(policy.act(seen, TASK.layout), expected, atol=1e-5)
    assert (np.abs(expected) > 0.999 * EVASION.action_limit).any() == (bias > 0.0)


def test_with_the_other_networks_bends_the_actions_differ() -> None:
    for name, wrong in (("sac", {"squash": "clip"}), ("ppo", {"activation": "relu"})):
        learner, seen = loud(learner_of(name)), observations(TASK.layout)
        policy = NetworkPolicy("wrong", FEATURES, learner.layers(), EVASION.action_limit, **wrong)  # type: ignore[arg-type]
        expected, _ = learner.model.predict(FEATURES.encode(seen), deterministic=True)
        assert np.abs(policy.act(seen, TASK.layout) - expected).max() > 1e-3


@pytest.mark.parametrize("name", LEARNERS)
def test_a_baselines_policy_file_comes_back_as_it_was(name: str, tmp_path: Path) -> None:
    policy = policy_of(loud(learner_of(name)))
    digests = {"layout_digest": policy.layout.digest, "features_digest": FEATURES.digest}
    bends = {"activation": policy.activation, "squash": policy.squash}
    card = dataclasses.replace(CARD, missiles=TASK.missiles, hidden=(64, 64), **digests, **bends)
    save_policy(tmp_path / "p.safetensors", policy, card)
    loaded, seen = load_policy(tmp_path / "p.safetensors"), observations(TASK.layout)
    assert loaded.card == card
    np.testing.assert_array_equal(loaded.act(seen, TASK.layout), policy.act(seen, TASK.layout))


def test_a_card_of_before_ppo_is_read_as_it_was_meant(tmp_path: Path) -> None:
    policy = policy_of(learner_of("sac"))
    digests = {"layout_digest": policy.layout.digest, "features_digest": FEATURES.digest}
    values = dataclasses.replace(CARD, missiles=TASK.missiles, hidden=(64, 64), **digests).to_json()
    del values["activation"], values["squash"]
    tensors = {}
    for index, (weight, bias) in enumerate(policy.layers):
        tensors[f"layers.{index}.weight"], tensors[f"layers.{index}.bias"] = weight, bias
    path = tmp_path / "old.safetensors"
    path.write_bytes(save(tensors, metadata={"card": json.dumps(values)}))
    loaded, seen = load_policy(path), observations(TASK.layout)
    assert (loaded.activation, loaded.squash) == ("relu", "tanh")
    np.testing.assert_array_equal(loaded.act(seen, TASK.layout), policy.act(seen, TASK.layout))


@pytest.mark.parametrize("change", [{"activation": "elu"}, {"squash": "none"}, {"squash": 1}, {"activation": None}])
def test_an_unknown_bend_is_refused(change: dict[str, object]) -> None:
    values = json.loads(json.dumps(CARD.to_json()))
    assert card_from_json(values, "it") == CARD
    with pytest.raises(PolicyFileError, match=f"it has a card whose {next(iter(change))} is"):
        card_from_json({**values, **change}, "it")


def test_sac_of_the_papers_profile_is_table_2_and_spinningup() -> None:
    hyper = PROFILES["paper"]
    model = learner_of("sac", dataclasses.replace(hyper, replay_size=2_000), literal=True).model
    widths = [layer.out_features for layer in model.actor.latent_pi if hasattr(layer, "out_features")]
    assert widths == [256, 256]
    assert model.actor.optimizer.param_groups[0]["lr"] == model.critic.optimizer.param_groups[0]["lr"] == 3e-4
    assert (model.batch_size, model.gamma, model.tau, model.n_steps) == (128, 0.99, 0.005, 1)
    assert (model.learning_starts, model.gradient_steps, model.train_freq.frequency) == (10_000, 50, 1)
    assert float(model.ent_coef_tensor) == pytest.approx(0.2) and model.ent_coef_optimizer is None


def test_sac_of_the_fast_profile_learns_its_entropy_weight_from_the_same_start() -> None:
    hyper = PROFILES["fast"]
    model = learner_of("sac", dataclasses.replace(hyper, replay_size=2_000)).model
    assert model.log_ent_coef.exp().item() == pytest.approx(0.2 * hyper.reward_scale)
    assert model.ent_coef_optimizer is not None
    assert (model.gamma, model.n_steps) == (hyper.gamma, hyper.return_steps)
    assert (model.batch_size, model.gradient_steps) == (hyper.batch_size, hyper.updates_per_lane_step)


def test_ppo_of_the_papers_profile_is_table_2_and_spinningup() -> None:
    model = learner_of("ppo", PROFILES["paper"], literal=True).model
    nets = model.policy.mlp_extractor
    for net in (nets.policy_net, nets.value_net):
        assert [type(layer).__name__ for layer in net] == ["Linear", "Tanh", "Linear", "Tanh"]
        assert [layer.out_features for layer in net if hasattr(layer, "out_features")] == [256, 256]
    (group,) = model.policy.optimizer.param_groups
    assert (group["lr"], group["eps"]) == (3e-4, 1e-8)
    assert (model.batch_size, model.gamma, model.gae_lambda, model.clip_range(1.0)) == (128, 0.99, 0.97, 0.2)
    assert model.n_steps * 4 == 10_000 and float(model.policy.log_std.detach()) == -0.5
    assert (model.ent_coef, model.target_kl, model.normalize_advantage) == (0.0, None, True)


@pytest.mark.parametrize("name", LEARNERS)
def test_gradient_steps_and_environment_steps_are_counted(name: str) -> None:
    hyper = dataclasses.replace(PROFILES["smoke"], hidden=(8,), steps_per_epoch=256, batch_size=16, return_steps=1)
    learner = learner_of(name, hyper)
    assert learner.take_statistics().critic_loss is None
    assert learner.learn(256) == 256
    # PPO passes ten times over 16 minibatches; SAC has taken its random steps and learns from now on.
    assert learner.updates == (10 * 16 if isinstance(learner, Ppo) else 0)
    assert learner.learn(64) == (320 if isinstance(learner, Sac) else 512)
    assert learner.updates == (2 * 10 * 16 if isinstance(learner, Ppo) else 64 // 4 * 4)
    statistics = learner.take_statistics()
    assert statistics.critic_loss is not None and statistics.critic_loss > 0.0 and statistics.actor_loss is not None
    assert learner.take_statistics().critic_loss is None


@pytest.mark.parametrize("name", LEARNERS)
def test_a_seed_makes_a_learner_and_another_makes_another(name: str) -> None:
    first, again, other = (learner_of(name, seed=seed).layers()[0][0] for seed in (2**42 + 5, 2**42 + 5, 2**42 + 6))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)
