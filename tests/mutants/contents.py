"""Mutants of what is read and shown: S9 to S13 and S16 of docs/security.md."""

from __future__ import annotations

from typing import Final

from tests.mutants.mutant import mutant

SECURITY: Final = "tests/security/"
TERMINAL: Final = SECURITY + "test_terminal.py::"
UNSAFE: Final = SECURITY + "test_unsafe_code.py::"
ADDRESSES: Final = SECURITY + "test_addresses.py::"
POLICY: Final = SECURITY + "test_policy_files.py::"
POLICY_SENTENCE: Final = POLICY + "test_a_hostile_file_is_one_sentence"
SCENARIO_SENTENCE: Final = SECURITY + "test_scenario_files.py::test_a_hostile_file_is_one_sentence"
NO_UNSAFE_SOURCE: Final = UNSAFE + "test_no_source_loads_or_runs_what_it_is_given"
SETTINGS: Final = ADDRESSES + "test_a_launch_takes_settings_in_their_ranges_and_nothing_else"
NO_KNOWN_HOLE: Final = SECURITY + "test_dependencies.py::test_no_version_with_a_known_hole_is_taken"
POLICIES: Final = "agents/checkpoint.py"
CONFIG: Final = "agents/config.py"

CONTENTS: Final = (
    # S9: names are inert everywhere.
    mutant("S9", "the terminal obeys what a name says", "workbench/terminal.py",
           '    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)\n',
           "    return text\n", TERMINAL + "test_lines_tables_and_json_steer_nothing"),
    mutant("S9", "a module prints by itself", "workbench/cluster/ray_engine.py",
           "        print_line(f\"workbench: run {task.run.id}: {again}\", error=True)\n",
           "        print(again)\n", TERMINAL + "test_only_one_module_prints"),
    mutant("S9", "a spreadsheet works out what a name says", "workbench/csv_cells.py",
           "    return f\"'{line}\" if line.startswith(FORMULA_STARTS) else line\n", "    return line\n",
           SECURITY + "test_csv.py::test_a_name_stays_a_text"),
    mutant("S9", "the name of a run is markup on its page", "workbench/pages/runs_detail.py",
           "<h2>{html.escape(record.title)}</h2>", "<h2>{record.title}</h2>",
           "tests/browser/test_hostile_names.py::test_no_name_acts[chromium-runs]"),
    mutant("S9", "a refusal repeats an address as markup", "workbench/app.py",
           "    return pmui.Alert(object=html.escape(sentence), severity=severity, margin=24)\n",
           "    return pmui.Alert(object=sentence, severity=severity, margin=24)\n",
           SECURITY + "test_refusals.py::test_what_a_refusal_repeats_is_no_markup"),
    mutant("S9", "a script of a page writes words as markup", "workbench/pages/fly_events.js",
           "cell.textContent = words", "cell.innerHTML = words",
           UNSAFE + "test_scripts_make_text_nodes_and_no_markup_of_what_they_are_told"),
    # S10: nothing that is read is run.
    mutant("S10", "numbers of an address are evaluated", CONFIG, "    return tuple(map(int, parts))\n",
           "    return tuple(map(eval, parts))\n", NO_UNSAFE_SOURCE),
    mutant("S10", "a cache is unpickled", "workbench/comparison/cache.py",
           "            values = json.loads(path.read_bytes())\n",
           "            import pickle\n\n            values = pickle.loads(path.read_bytes())\n", NO_UNSAFE_SOURCE),
    mutant("S10", "a training is started by a shell", "workbench/launcher.py",
           "            [sys.executable, *arguments],\n",
           '            " ".join([sys.executable, *arguments]),\n            shell=True,\n', NO_UNSAFE_SOURCE),
    # S11: a policy file is exactly a policy or a sentence.
    mutant("S11", "a file of any size is read whole", POLICIES, "file.read(SIZE_LIMIT + 1)", "file.read()",
           POLICY + "test_a_huge_file_is_refused_by_its_beginning"),
    mutant("S11", "a header of any length is parsed", POLICIES, "if length > HEADER_LIMIT:\n", "if False:\n",
           POLICY_SENTENCE + "[header of 100 kB]"),
    mutant("S11", "weights may be NaN", POLICIES, "        if not np.isfinite(array).all():\n", "        if False:\n",
           POLICY_SENTENCE + "[NaN]"),
    mutant("S11", "weights may be of any type", POLICIES, "if array.shape != shape or array.dtype != np.float32:",
           "if array.shape != shape:", POLICY_SENTENCE + "[weights of double precision]"),
    mutant("S11", "tensors too many are passed over", POLICIES, "    if set(tensors) != set(expected):\n",
           "    if set(expected) - set(tensors):\n", POLICY_SENTENCE + "[a tensor too many]"),
    mutant("S11", "a key may occur twice", POLICIES, "    if len(values) < len(pairs):\n", "    if False:\n",
           POLICY_SENTENCE + "[a card with a key twice]"),
    mutant("S11", "numbers of a scenario may be NaN", "sim/scenario_file.py", "    if not low <= value <= high:  # NaN",
           "    if value < low or value > high:  # NaN",
           SECURITY + "test_scenario_files.py::test_no_number_of_a_scenario_may_be_anything_but_a_number"),
    mutant("S11", "keys of a scenario that nobody knows are passed over", "sim/scenario_file.py", "    if unknown:\n",
           "    if False:\n", SCENARIO_SENTENCE + "[an unknown key]"),
    # S12: a launch takes settings and no command.
    mutant("S12", "keys that nobody knows are passed over", CONFIG, "        if unknown:\n            raise",
           "        values = {name: value for name, value in values.items() if name in known}\n"
           "        if False:\n            raise", ADDRESSES + "test_a_launch_takes_no_other_key"),
    mutant("S12", "numbers have no range", CONFIG, "    if name in _RANGES and not", "    if False and not",
           SETTINGS + "[seed]"),
    mutant("S12", "a name may be any text", CONFIG,
           "if len(self.name) > 200 or not self.name.isprintable():", "if False:",
           SETTINGS + "[name]"),
    mutant("S12", "a training gets every variable of who launches it", "workbench/launcher.py",
           "    kept = {name: os.environ[name] for name in INHERITED if name in os.environ}\n",
           "    kept = dict(os.environ)\n",
           "tests/reliability/test_training_process.py::test_a_training_process_gets_few_variables_and_one_thread"),
    # S13: what is typed is never worked out.
    mutant("S13", "what is searched for is put into the statement", "workbench/run_index/query.py",
           '        parts.append("instr(haystack, ?) = 0" if absent else "instr(haystack, ?) > 0")\n'
           "        values.append(word[1:] if absent else word)\n",
           "        parts.append(f\"instr(haystack, '{word}') > 0\")\n", ADDRESSES + "test_a_search_works_nothing_out"),
    mutant("S13", "a percent sign finds everything", "workbench/run_index/query.py",
           '"instr(haystack, ?) = 0" if absent else "instr(haystack, ?) > 0"',
           "\"instr(haystack, ?) = 0\" if absent else \"haystack LIKE '%' || ? || '%'\"",
           ADDRESSES + "test_a_search_works_nothing_out"),
    # S16: no version with a known hole.
    mutant("S16", "a Bokeh that takes look-alike origins is allowed", "pyproject.toml", '"bokeh>=3.9.2",',
           '"bokeh>=3.7",', NO_KNOWN_HOLE + "[bokeh]"),
    mutant("S16", "a viser that serves any file is allowed", "pyproject.toml", '"viser>=1.1.1,<1.2",',
           '"viser>=1.0,<1.2",', NO_KNOWN_HOLE + "[viser]"),
    mutant("S16", "a library is used that nobody declared", "workbench/csv_cells.py",
           "from workbench.terminal import printable\n", "import yaml\n\nfrom workbench.terminal import printable\n",
           SECURITY + "test_dependencies.py::test_nothing_is_imported_that_is_not_declared"),
)  # fmt: skip
