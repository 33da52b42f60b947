"""Learning: policies, TD3, knowledge transfer, curriculum, evaluation and policy files."""
