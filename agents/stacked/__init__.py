"""Many trainings in one process: S agents (seeds × variants) side by side in stacked tensors, on a CPU or a GPU.

What an agent learns does not depend on who is stacked with it. Each has its own networks, moments, replay, draws, α, ε
and β; they share only the order of their steps. `docs/gpu.md` says how to run it.
"""
