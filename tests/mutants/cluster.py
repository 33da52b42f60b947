"""Mutants of clusters and stacks: C1 nothing is lost, C2 results are equal, C3 nobody gets in, C4 stacked is alone."""

from __future__ import annotations

from typing import Final

from tests.mutants.mutant import mutant

ENGINE: Final = "workbench/cluster/ray_engine.py"
AGENT: Final = "workbench/cluster/run_agent.py"
MIRROR: Final = "workbench/cluster/run_mirror.py"
RECEIVER: Final = "workbench/cluster/receiver.py"
CONNECTION: Final = "workbench/cluster/ray_connection.py"
STACKED: Final = "agents/stacked/learner.py"
RUNS: Final = "tests/cluster/test_ray_runs.py::"
COMMAND: Final = "tests/cluster/test_ray_command.py::"
MIRRORED: Final = "tests/cluster/test_run_mirror.py::"
KILLED: Final = RUNS + "test_a_killed_worker_and_a_killed_training_cost_nothing_when_streamed"
REMOVED: Final = RUNS + "test_a_removed_node_costs_nothing_on_shared_storage"
STOPPED: Final = RUNS + "test_stop_pause_and_the_end_at_once_reach_a_node_and_a_paused_run_goes_on_here"
TOGETHER: Final = "tests/agents/stacked/test_learner.py::"

CLUSTER: Final = (
    # C1: workers, nodes and commands may die.
    mutant(
        "C1",
        "a run whose worker died is given up",
        ENGINE,
        "elif state.retries >= self._options.retries:",
        "elif True:",
        KILLED,
    ),
    mutant(
        "C1",
        "a run whose node went away is given up",
        ENGINE,
        "elif state.retries >= self._options.retries:",
        "elif state.node:",
        REMOVED,
    ),
    mutant(
        "C1",
        "a run is begun again for ever",
        ENGINE,
        "elif state.retries >= self._options.retries:",
        "elif False:",
        RUNS + "test_what_a_command_leaves_goes_on_with_the_next_one_and_a_hopeless_run_fails",
        hangs=True,
    ),
    mutant(
        "C1", "a node begins from nothing instead of the last checkpoint", AGENT, "        mirror.fetch()\n", "", KILLED
    ),
    mutant(
        "C1",
        "checkpoints stay on the node",
        MIRROR,
        "            self._send_checkpoints(manifests)\n",
        "            pass\n",
        KILLED,
        hangs=True,
    ),
    mutant(
        "C1",
        "a manifest is sent before the parts it names",
        MIRROR,
        "        for name, data in sorted(manifests.items()):\n",
        "        for name, data in sorted(manifests.items()):\n            self._put(name, data)\n",
        MIRRORED + "test_after_any_message_the_head_can_go_on_and_ends_with_the_same_files",
    ),
    mutant(
        "C1",
        "an attempt that was given up writes on",
        RECEIVER,
        "if self._attempts.get(run_id) != attempt:",
        "if run_id not in self._attempts:",
        MIRRORED + "test_an_attempt_that_was_given_up_writes_nothing_more",
    ),
    mutant(
        "C1",
        "a training outlives the task that holds it",
        AGENT,
        '[sys.executable, *entry, str(folder), "--held"], stdin=subprocess.PIPE',
        "[sys.executable, *entry, str(folder)], stdin=subprocess.PIPE",
        COMMAND + "test_when_the_command_is_killed_everything_dies_and_the_run_is_interrupted",
    ),
    mutant(
        "C1",
        "a call of a study whose task dies is not made again",
        ENGINE,
        "max_calls=1, max_retries=self._options.retries",
        "max_calls=1, max_retries=0",
        RUNS + "test_each_call_of_a_study_is_a_task_and_one_that_dies_is_made_again",
    ),
    # C2: stop works, and results are those of this machine.
    mutant(
        "C2",
        "who asks to stop is not heard on the node",
        AGENT,
        "if streamed and wished:",
        "if streamed and not wished:",
        STOPPED,
        hangs=True,
    ),
    mutant(
        "C2",
        "a run that was stopped while it waited begins",
        RECEIVER,
        'if run.state.state != "queued":',
        'if run.state.state == "finished":',
        MIRRORED + "test_a_run_that_was_stopped_while_it_waited_never_begins",
    ),
    mutant(
        "C2",
        "another version trains too",
        AGENT,
        "    if other:\n",
        "    if not here:\n",
        MIRRORED + "test_a_node_with_another_version_or_without_the_shared_folder_refuses",
    ),
    mutant(
        "C2",
        "the guide does not travel",
        AGENT,
        "            (folder / name).write_bytes(data)\n",
        "            pass\n",
        MIRRORED + "test_a_guide_that_is_a_file_travels_and_the_nodes_folder_is_removed",
    ),
    mutant(
        "C2",
        "every run has the seed of the first",
        ENGINE,
        "        run = self._store.create(config, engine=NAME)\n",
        "        run = self._store.create(dataclasses.replace(config, seed=0), engine=NAME)\n",
        "tests/cluster/test_ray_reproduce.py::test_table4_is_the_same_under_both_engines_also_when_it_was_interrupted",
    ),
    # C3: nobody else is let in.
    mutant(
        "C3",
        "a Ray of one's own listens on the network",
        CONNECTION,
        "    os.environ.update(ON_LOOPBACK | AS_EQUALS)\n",
        "    os.environ.update(AS_EQUALS)\n",
        COMMAND + "test_ray_listens_on_loopback_alone_and_ctrl_c_leaves_nothing_behind",
    ),
    mutant(
        "C3",
        "its dashboard is on",
        CONNECTION,
        "include_dashboard=False",
        "include_dashboard=True",
        COMMAND + "test_ray_listens_on_loopback_alone_and_ctrl_c_leaves_nothing_behind",
    ),
    mutant(
        "C3",
        "a node writes any file",
        RECEIVER,
        '    raise ForeignNameError(f"{name[:60]!r} is no file of a training")\n',
        "    return name\n",
        MIRRORED + "test_only_files_that_a_training_writes_come_in[run.lock]",
    ),
    # C4: S agents stacked are S agents alone.
    mutant(
        "C4",
        "all agents distil with the first one's α",
        STACKED,
        "torch.stack((ones, alpha), dim=1)",
        "torch.stack((ones, alpha[:1].expand_as(alpha)), dim=1)",
        TOGETHER + "test_alpha_is_each_agents_own",
    ),
    mutant(
        "C4",
        "who waits learns with the others",
        STACKED,
        "        with put_back(waiting, [*self.critics.tensors, self.critic_sums]):\n",
        "        with put_back((), [*self.critics.tensors, self.critic_sums]):\n",
        TOGETHER + "test_a_waiting_agent_does_not_change_by_one_bit_and_the_others_learn_as_ever",
    ),
    mutant(
        "C4",
        "the gradient of tanh is forgotten",
        STACKED,
        "slope * (1.0 - action * action)",
        "slope",
        TOGETHER + "test_three_stacked_agents_equal_three_alone_over_many_updates",
    ),
    mutant(
        "C4",
        "the smaller twin is chosen for all agents at once",
        STACKED,
        "lower = self._summed(first, weights) <= self._summed(second, weights)",
        "lower = self._summed(first, weights).mean() <= self._summed(second, weights)",
        TOGETHER + "test_three_stacked_agents_equal_three_alone_over_many_updates",
    ),
)
