"""The evader's world: physics, tasks, observations, rewards, environments; knows nothing of learning or screens.

Importing it tells Gymnasium where `SubMas/Evasion-v0` is: since 1.0 Gymnasium reads no entry points, and packages
register their environments when they are imported. `gymnasium.make("sim:SubMas/Evasion-v0")` imports it by itself.
"""

import gymnasium

if "SubMas/Evasion-v0" not in gymnasium.registry:
    gymnasium.register(
        "SubMas/Evasion-v0",
        entry_point="sim.environment:EvasionEnv",
        vector_entry_point="sim.environment:EvasionVectorEnv",
    )
