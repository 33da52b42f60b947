"""Mutants of what is saved and resumed: R1 to R4, R7, R8 and R14 of docs/reliability.md."""

from __future__ import annotations

from typing import Final

from tests.mutants.mutant import mutant

RELIABILITY: Final = "tests/reliability/"
KILL: Final = RELIABILITY + "test_kill.py::test_a_killed_and_resumed_training_is_the_uninterrupted_one"
CRASH: Final = RELIABILITY + "test_crash_points.py::"
DAMAGED: Final = RELIABILITY + "test_damaged_checkpoints.py::"
LAUNCHER: Final = RELIABILITY + "test_launcher.py::"
SNAPSHOT: Final = "tests/reliability/test_snapshot.py::"
SERVER: Final = RELIABILITY + "test_server.py::"
ANY_STEP: Final = CRASH + "test_a_crash_at_any_step_of_a_run_leaves_a_run_that_goes_on"
REFUSED: Final = CRASH + "test_a_step_that_is_refused_is_an_error_and_never_silence"
FALLBACK: Final = DAMAGED + "test_a_damaged_checkpoint_is_refused_by_name_and_the_one_before_is_taken"
WEIGHTS: Final = SNAPSHOT + "test_the_weights_of_transfer_go_on_where_they_were"
CURRICULUM: Final = SNAPSHOT + "test_a_curriculum_goes_on_from_every_epoch_of_every_stage"

SAVING: Final = (
    # R1: killed at any moment and resumed, a run is the one that was never interrupted.
    mutant("R1", "a resumed run draws its exploration anew", "agents/resume.py",
           '    state.generator.bit_generator.state = values["generator"]\n', "", KILL + "[td3]"),
    mutant("R1", "a resumed run counts its episodes anew", "agents/resume.py",
           '    state.world.next_episode = values["next_episode"]\n', "", KILL + "[td3]"),
    mutant("R1", "a resumed SAC keeps its library's generators as they are", "agents/baselines_state.py",
           "    _load_generators(arrays)\n", "", KILL + "[sac]"),
    mutant("R1", "a curriculum begins every stage with the checkpoint of another", "agents/submas.py",
           "resumed = snapshot if number == first else None", "resumed = None", CURRICULUM),
    mutant("R1", "metrics written after the checkpoint stay and are written again", "workbench/recorder.py",
           "cut_back(self.run.path / name, int(facts[name]))", "int(facts[name])", ANY_STEP + "[KilledDisk]"),
    # R2: a crash at any step of a save is safe.
    mutant("R2", "a file is renamed before its content is synced", "agents/disk.py",
           "            disk.write(descriptor, data)\n            disk.sync(descriptor)\n        finally:",
           "            disk.write(descriptor, data)\n        finally:", ANY_STEP + "[PowerCutDisk]"),
    mutant("R2", "the folder of a renamed file is not synced", "agents/disk.py",
           "        raise\n    sync_folder(path.parent)\n", "        raise\n", ANY_STEP + "[ReorderingDisk]"),
    mutant("R2", "a line of metrics is not synced", "agents/disk.py",
           "            disk.write(descriptor, data)\n            disk.sync(descriptor)\n        except",
           "            disk.write(descriptor, data)\n        except", ANY_STEP + "[PowerCutDisk]"),
    mutant("R2", "files are written in place", "agents/disk.py",
           "        disk.replace(temporary, path)\n",
           "        disk.remove(temporary)\n"
           "        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)\n"
           "        disk.write(descriptor, data)\n        os.close(descriptor)\n", ANY_STEP + "[KilledDisk]"),
    mutant("R2", "what a crash left half written is never swept away", "workbench/recorder.py",
           "            sweep(self.run.path / folder)\n", "            pass\n", ANY_STEP + "[KilledDisk]"),
    mutant("R2", "old checkpoints are removed before the new one is written", "workbench/checkpoints.py",
           "            self.folder.mkdir(exist_ok=True)\n            parts",
           "            self.clear()\n            self.folder.mkdir(exist_ok=True)\n            parts",
           ANY_STEP + "[KilledDisk]"),
    # R3: nothing that learning depends on is missing from a checkpoint.
    mutant("R3", "torch's generator is not restored", "agents/td3.py",
           '        load_generator(self.generator, arrays["generator"])\n', "", CURRICULUM),
    mutant("R3", "the generators of the worlds' lanes are not restored", "agents/resume.py",
           '    state.world.restore(below("world", arrays))\n', "", CURRICULUM),
    mutant("R3", "the moments of the optimisers are not restored", "agents/td3.py",
           "            load_optimizer(getattr(self, name), below(name, arrays))\n", "            pass\n", CURRICULUM),
    mutant("R3", "the replay is restored without its cursor", "agents/replay.py",
           "        self._count(stored.added)\n", "        self.filled = min(stored.added, self.slots)\n",
           SNAPSHOT + "test_so_does_one_whose_replay_came_round[td3]"),
    mutant("R3", "the window of training episodes is empty after a resume", "agents/resume.py",
           '    state.finished.extend(FinishedEpisode(*one) for one in values["finished"])\n', "", CURRICULUM),
    mutant("R3", "α starts anew after a resume", "agents/resume.py",
           "        setattr(state, name, values[name])\n",
           '        setattr(state, name, values[name] if name != "alpha" else state.alpha)\n', WEIGHTS),
    mutant("R3", "ε starts anew after a resume", "agents/resume.py",
           "        setattr(state, name, values[name])\n",
           '        setattr(state, name, values[name] if name != "epsilon" else state.epsilon)\n', WEIGHTS),
    mutant("R3", "the noise of the lanes is forgotten", "agents/resume.py",
           'LANES = ("observation", "features", "reused", "noise", "restarted", "lane_return")',
           'LANES = ("observation", "features", "reused", "restarted")', CURRICULUM),
    # R4: a damaged checkpoint is refused by name, and the one before is taken.
    mutant("R4", "the digests of a checkpoint's parts are not compared", "workbench/checkpoint_manifest.py",
           "if hashlib.file_digest(file, \"sha256\").hexdigest() != part.sha256:", "if not part.sha256:",
           FALLBACK + "[state-000003.safetensors-a bit at 90%]"),
    mutant("R4", "the manifest's own digest is not compared", "workbench/checkpoint_manifest.py",
           'if content.get("sha256") != _digest(checkpoint):', 'if not content.get("sha256"):',
           FALLBACK + "[manifest-000003.json-a bit at 90%]"),
    mutant("R4", "a damaged newest checkpoint ends the resume", "workbench/checkpoints.py",
           '                refused.append(f"checkpoint {number} cannot be used: {error}")\n                continue\n',
           "                raise error\n", FALLBACK + "[state-000003.safetensors-empty]"),
    mutant("R4", "a checkpoint of another run is taken", "workbench/checkpoint_manifest.py",
           "if manifest.run != run or manifest.number != number:", "if manifest.number != number:",
           DAMAGED + "test_parts_of_another_run_are_refused"),
    mutant("R4", "a checkpoint of a later version is read as if it were ours", "workbench/checkpoint_manifest.py",
           'if checkpoint.get("schema") != SCHEMA:', 'if not checkpoint.get("schema"):',
           DAMAGED + "test_a_checkpoint_of_a_later_version_says_so"),
    mutant("R4", "the reason does not name the file", "workbench/checkpoint_manifest.py",
           'raise CheckpointError(f"{part.name} is {size} bytes long, {part.bytes} were written")',
           'raise CheckpointError("a part has the wrong length")', FALLBACK + "[state-000003.safetensors-half]"),
    # R7: a full disk ends a run in a sentence, and space lets it go on.
    mutant("R7", "half a line stays when the disk is full", "agents/disk.py",
           "                disk.cut(descriptor, size)\n", "                pass\n",
           CRASH + "test_a_full_disk_fails_the_run_and_space_lets_it_go_on"),
    mutant("R7", "temporary files stay when the disk is full", "agents/disk.py",
           "        with contextlib.suppress(OSError):\n            disk.remove(temporary)\n", "",
           CRASH + "test_a_full_disk_fails_the_run_and_space_lets_it_go_on"),
    mutant("R7", "a server that cannot write its address into the lock does not start", "workbench/server.py",
           "    with contextlib.suppress(OSError):  # a full disk", "    with contextlib.nullcontext():  # a full disk",
           SERVER + "test_a_full_disk_keeps_no_page_shut"),
    # R8: a save that did not happen is an error.
    mutant("R8", "a checkpoint that cannot be written is passed over", "workbench/checkpoints.py",
           "            if isinstance(error, OSError):\n                raise",
           "            if isinstance(error, (OSError, RunFileError)):\n                return\n"
           "            if isinstance(error, OSError):\n                raise", REFUSED),
    mutant("R8", "a row that cannot be written is passed over", "workbench/run_files.py",
           '        append(path, line.encode())\n    except OSError as error:\n'
           '        raise RunFileError(f"cannot save {path}: {error.strerror}") from error\n',
           "        append(path, line.encode())\n    except OSError:\n        return\n", REFUSED),
    # R14: divergence is a reason, and never a zero.
    mutant("R14", "losses that are not finite are not looked at", "workbench/recorder.py",
           "            if value is not None and not math.isfinite(value):\n", "            if False:\n",
           LAUNCHER + "test_divergence_is_reported_and_never_plotted_as_zero"),
    mutant("R14", "weights that are not finite are saved", "workbench/recorder.py",
           "        _refuse_divergence(snapshot, self.state)\n", "",
           DAMAGED + "test_weights_that_are_not_finite_end_the_run_and_are_never_saved"),
    mutant("R14", "a number that is not finite is written as 0", "workbench/run_files.py",
           "    if isinstance(value, float) and not math.isfinite(value):\n        return None\n",
           "    if isinstance(value, float) and not math.isfinite(value):\n        return 0.0\n",
           LAUNCHER + "test_divergence_is_reported_and_never_plotted_as_zero"),
)  # fmt: skip
