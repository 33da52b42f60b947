"""The world in NVIDIA Warp: compiled to vector instructions on a CPU, and for CUDA from the same source.

`lane` says what a group of lanes holds, `physics` how one body flies, `formation` moves whole groups, `step` and
`restart` are the two kernels. `sim.reference` says the same to people, in float64 NumPy.
"""
