"""Mutants of how runs live, end, are read and kept: the other bars of docs/reliability.md."""

from __future__ import annotations

from typing import Final

from tests.mutants.mutant import mutant

RELIABILITY: Final = "tests/reliability/"
LAUNCHER: Final = RELIABILITY + "test_launcher.py::"
READERS: Final = RELIABILITY + "test_readers.py::"
PROCESS: Final = RELIABILITY + "test_training_process.py::"
RESUME: Final = RELIABILITY + "test_resume.py::"
SERVER: Final = RELIABILITY + "test_server.py::"
OLD: Final = RELIABILITY + "test_old_runs.py::"
RUNS: Final = "tests/reliability/test_runs.py::"
INDEX: Final = "tests/reliability/test_run_index.py::"
LAWS: Final = "tests/reliability/test_determinism.py::"
HARMED_INDEX: Final = INDEX + "test_a_harmed_index_is_made_anew_and_nothing_is_lost"
CLOCK: Final = RESUME + "test_jumps_of_the_clock_neither_stall_a_run_nor_turn_its_times_round"

RUNNING: Final = (
    # R5: the index is rebuilt from the folders.
    mutant("R5", "an index of another version is used", "workbench/run_index/file.py",
           "if self._version() != VERSION:", "if self._version() < 0:", HARMED_INDEX + "[of another version]"),
    mutant("R5", "rows of the index are not checked", "workbench/run_index/file.py",
           "if row[-1] != _checksum(row[:-1]):", "if not row:", HARMED_INDEX + "[a cell was changed]"),
    mutant("R5", "a file that is no database is an error instead of a new index", "workbench/run_index/index.py",
           "        except IndexDamaged as error:\n            self._rebuild(str(error))\n",
           "        except IndexDamaged:\n            raise\n", HARMED_INDEX + "[no database]"),
    mutant("R5", "an index is rebuilt without a word", "workbench/run_index/index.py",
           'self.notice = f"The index of the runs was not usable ({reason}) and is rebuilt from the run folders."',
           'self.notice = ""', HARMED_INDEX + "[no database]"),
    mutant("R5", "a locked index is not waited for", "workbench/run_index/file.py",
           "BUSY_S = 5.0", "BUSY_S = 0.0", INDEX + "test_a_lock_is_waited_for"),
    # R6: one bad run never hides the others.
    mutant("R6", "a configuration of deep nests is an error of the whole list", "workbench/run_files.py",
           "        value = json.loads(data, parse_constant=_no_constant)\n"
           "    except (ValueError, RecursionError) as error:",
           "        value = json.loads(data, parse_constant=_no_constant)\n    except ValueError as error:",
           RUNS + "test_one_bad_run_never_hides_the_others[state is deeply nested]",
           INDEX + "test_one_bad_run_never_hides_the_others[state is deeply nested]"),
    mutant("R6", "a list asks every run and minds if one cannot answer", "workbench/run_folder.py",
           "        _ = run.config, run.state\n    except RunFileError as error:",
           "        _ = run.config, run.state\n    except FileNotFoundError as error:",
           RUNS + "test_one_bad_run_never_hides_the_others[config is not JSON]",
           INDEX + "test_one_bad_run_never_hides_the_others[config is not JSON]"),
    # R9: dead is interrupted, silent is stalled, a reused pid is neither.
    mutant("R9", "a run is taken to live as long as its process number does", "workbench/run_folder.py",
           '        return is_locked(self.path / "run.lock")\n',
           "        pid = self._state.pid\n        return pid is not None and os.path.exists(f'/proc/{pid}')\n",
           LAUNCHER + "test_a_reused_pid_does_not_bring_a_run_back_to_life"),
    mutant("R9", "what state.json says is believed", "workbench/run_folder.py",
           "        if not written.claimed:\n            return written\n        if self.is_alive():",
           "        if True:", RESUME + "test_a_killed_run_is_interrupted_within_two_seconds"),
    mutant("R9", "a hung training is never called stalled", "workbench/run_state.py",
           "return self.beat_s is not None and now_s - self.beat_s > self.patience_s", "return False",
           RESUME + "test_a_hung_run_is_stalled_and_comes_back_or_is_ended"),
    # R10: pages may die, trainings do not.
    mutant("R10", "trainings hear the Ctrl-C of who launched them", "workbench/launcher.py",
           "            start_new_session=True,\n", "",
           PROCESS + "test_a_ctrl_c_where_it_was_launched_does_not_reach_a_training"),
    mutant("R10", "a training does not inherit its run's lock", "workbench/launcher.py",
           "            pass_fds=tuple(locks),\n", "",
           PROCESS + "test_a_training_outlives_the_process_that_launched_it"),
    # R11: started once, within the limit.
    mutant("R11", "launchers do not take turns", "workbench/launcher.py",
           "        with waiting_lock(store.root / LAUNCHER_LOCK):\n            runs = _good_runs(store)\n",
           "        with contextlib.nullcontext():\n            runs = _good_runs(store)\n",
           LAUNCHER + "test_the_limit_holds_however_many_launch_at_once"),
    mutant("R11", "a run is started without its lock", "workbench/launcher.py",
           "    lock = run.claim()\n    if lock is None:\n        return False\n",
           '    lock = os.open(run.path / "run.lock", os.O_RDWR | os.O_CREAT, 0o644)\n',
           LAUNCHER + "test_a_run_counts_as_running_from_the_moment_it_is_launched"),
    mutant("R11", "the limit counts only what this launcher has started", "workbench/launcher.py",
           'free = limit - sum(states[run.id].active and states[run.id].state != "queued" for run in runs)',
           "free = limit", LAUNCHER + "test_the_limit_on_running_trainings_holds"),
    mutant("R11", "who resumes does not ask whether another has", "workbench/run_folder.py",
           "            if not state.resumable:\n", "            if False:\n",
           RESUME + "test_however_many_resume_it_is_started_once[8]"),
    mutant("R11", "a second click launches again", "workbench/pages/curriculum_launch.py",
           "        if self._button.disabled:\n            return\n", "",
           "tests/workbench/pages/test_curriculum.py::test_a_second_click_launches_nothing"),
    # R12: stopping ends the epoch, saves it and says so.
    mutant("R12", "a signal is not heard at the end of an epoch", "workbench/recorder.py",
           "self.stopped = self.stopped or self._interrupted() or self.run.stop_requested()",
           "self.stopped = self.stopped or self.run.stop_requested()",
           LAUNCHER + "test_the_first_ask_to_stop_ends_the_epoch[SIGTERM]"),
    mutant("R12", "the second signal waits for the epoch too", "workbench/training.py",
           "            raise StopNow\n", "            return\n",
           LAUNCHER + "test_the_second_ask_ends_it_in_the_middle_of_an_epoch"),
    mutant("R12", "a signal interrupts what a training writes at its end", "workbench/training.py",
           "        if self._heard_enough:\n            return\n", "",
           RESUME + "test_signals_at_the_end_do_not_keep_it_from_saying_how_it_ended[epochs=2-finished]"),
    mutant("R12", "a stop does not save its epoch where saving is dear", "workbench/recorder.py",
           "if not (pausing or self.stopped or self._pulse.worth_saving(time.monotonic())):",
           "if not (pausing or self._pulse.worth_saving(time.monotonic())):",
           RESUME + "test_the_last_epoch_is_saved_however_dear_saving_is[stop]"),
    mutant("R12", "a stopped training ends as if it had failed", "workbench/training.py",
           '    recorder.end("stopped" if recorder.stopped else "finished")\n    return 0\n',
           '    recorder.end("stopped" if recorder.stopped else "finished")\n    return int(recorder.stopped)\n',
           LAUNCHER + "test_the_first_ask_to_stop_ends_the_epoch[SIGTERM]"),
    # R13: crash loops stop.
    mutant("R13", "what died is put into the queue again, for ever", "workbench/run_folder.py",
           'return dataclasses.replace(written, state="interrupted") if written.claimed else written',
           'return dataclasses.replace(written, state="queued") if written.claimed else written',
           LAUNCHER + "test_a_killed_training_is_interrupted_and_never_started_again"),
    # R15: a torn last line is not yet, a torn middle line is an error of that run.
    mutant("R15", "a torn last line is read as if it were whole", "workbench/run_files.py",
           '            complete = chunk.rfind(b"\\n") + 1\n', "            complete = len(chunk)\n",
           RUNS + "test_a_torn_last_line_is_not_yet"),
    mutant("R15", "a torn line in the middle is passed over", "workbench/run_files.py",
           '            raise RunFileError(f"{self.path.name}, line {self.rows} is not JSON: {error}") from error\n',
           "            return {}\n", RUNS + "test_a_torn_line_in_the_middle_is_an_error_of_that_run"),
    # R16: a reader never sees half an epoch.
    mutant("R16", "a reader does not notice that rows are made again", "workbench/run_files.py",
           "        if self._inode not in (0, inode):\n", "        if False:\n",
           READERS + "test_a_reader_begins_again_when_rows_are_made_again"),
    mutant("R16", "a reader takes half a row for read", "workbench/run_files.py",
           "            self._offset += complete\n", "            self._offset += len(chunk)\n",
           READERS + "test_readers_beside_a_writer_see_whole_epochs_only"),
    # R17: old runs open for ever.
    mutant("R17", "a key of a later version makes a state unreadable", "workbench/run_state.py",
           'if value.get("state") not in STATES:',
           'if value.get("state") not in STATES or value.keys() - _FIELD_TYPES.keys():',
           OLD + "test_what_a_later_version_adds_to_a_state_is_passed_over"),
    mutant("R17", "checkpoints of the version before are not read", "workbench/checkpoint_manifest.py",
           "SCHEMA = 1\n", "SCHEMA = 2\n", OLD + "test_an_old_checkpoint_is_resumed_to_the_end"),
    # R18: determinism below it all.
    mutant("R18", "a world's episodes depend on those before", "sim/start.py",
           "draws = np.random.Generator(np.random.Philox(key=[seed, episode]))",
           "draws = np.random.default_rng()", LAWS + "test_the_same_seed_flies_the_same_bits"),
    mutant("R18", "lanes feel one another", "sim/world.py",
           "        self._turns[: self.lanes] = np.asarray(actions, dtype=np.float32).reshape(self.lanes)\n",
           "        self._turns[: self.lanes] = np.asarray(actions, dtype=np.float32).reshape(self.lanes)\n"
           "        self._turns[0] += 1e-6 * self._turns[: self.lanes].mean()\n",
           LAWS + "test_the_number_of_lanes_does_not_matter[17]"),
    mutant("R18", "observations share their memory with the world", "sim/world.py",
           "truth = self._host(self._observation)[: self.lanes, self._columns].copy()",
           "truth = self._host(self._observation)[: self.lanes, self._columns]",
           LAWS + "test_an_observation_stays_what_it_was"),
    # R19: no leaks in a day's use.
    mutant("R19", "a page that was left keeps its scene", "workbench/pages/fly.py",
           "        pn.state.on_session_destroyed(lambda _session: self._view.close())\n", "",
           SERVER + "test_pages_that_were_left_leave_nothing_behind"),
    # R20: jumps of the clock are harmless.
    mutant("R20", "durations are taken from the wall clock", "workbench/recorder.py",
           "        return time.monotonic() - self._began_s\n", "        return time.time() - self._began_s\n", CLOCK),
    mutant("R20", "a training is stalled when its last state is old", "workbench/run_folder.py",
           'silent = written.state == "running" and written.silent(time.monotonic())',
           'silent = datetime.fromisoformat(written.updated).year < datetime.now().year',
           CLOCK),
    # R21: a page that lost its server says so.
    mutant("R21", "pages say nothing of a server that was stopped", "workbench/app.py", "*history_steps(name), bar],",
           "*history_steps(name)],",
           "tests/browser/test_reconnect.py::test_a_stopped_server_and_one_that_was_started_again_are_sentences"),
    # R22: every number traces back.
    mutant("R22", "a result set does not tell how often a training was resumed", "workbench/reproduce/result_file.py",
           '    return value != "" and (name != "resumes" or value != 0)\n',
           '    return value != "" and name != "resumes"\n',
           "tests/workbench/reproduce/test_result_file.py::test_how_often_a_training_was_resumed_is_written_and_read"),
    mutant("R22", "a number does not tell which run it came from", "workbench/reproduce/assembly.py",
           "        run=run,\n", '        run="",\n',
           "tests/workbench/reproduce/test_session.py::test_a_training_that_somebody_else_runs_is_waited_for"),
    # R23: deleting can be undone, and is refused while a run is alive.
    mutant("R23", "a running run can be deleted", "workbench/runs.py",
           "                _refuse_while_alive(run)\n", "", RUNS + "test_a_running_run_cannot_be_deleted"),
    mutant("R23", "deleting is for good", "workbench/runs.py",
           "                os.rename(run.path, target)\n        except OSError as error:\n"
           '            raise RunsFolderError(f"run {run_id} cannot be deleted',
           "                shutil.rmtree(run.path)\n        except OSError as error:\n"
           '            raise RunsFolderError(f"run {run_id} cannot be deleted',
           RUNS + "test_a_deleted_run_comes_back_whole"),
)  # fmt: skip
