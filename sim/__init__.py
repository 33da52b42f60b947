"""The evader's world: physics, tasks, observations, rewards, environments; knows nothing of learning or screens."""
