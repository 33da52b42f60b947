"""S10, S13: nothing in the code can run what it reads, and nothing that a person types is ever worked out.

The bans are read from the syntax tree, so that a comment or a word may name what is banned.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.security.sources import PACKAGES, ROOT, trees

PAGES = sorted([*ROOT.glob("workbench/**/*.js"), *ROOT.glob("workbench/**/*.html")])
BANNED_IMPORTS = {
    "pickle", "cPickle", "_pickle", "dill", "joblib", "cloudpickle", "shelve", "marshal", "yaml", "telnetlib", "ftplib",
    "xmlrpc", "code", "codeop", "pty", "crypt",
}  # fmt: skip
BANNED_CALLS = {
    "eval", "exec", "compile", "__import__", "os.system", "os.popen", "os.spawnl", "os.execv", "os.execve", "os.fork",
    "tempfile.mktemp", "yaml.load", "pickle.load", "pickle.loads", "torch.save", "pd.read_pickle", "pandas.read_pickle",
    "pd.eval", "pandas.eval", "subprocess.getoutput", "subprocess.getstatusoutput", "asyncio.create_subprocess_shell",
    "random.seed", "np.random.seed", "shutil.unpack_archive",
}  # fmt: skip
BANNED_NAMES = {"eval", "exec", "compile", "__import__"}
"""Also where they are handed to something that calls them."""
BANNED_METHODS = {"extractall", "read_pickle", "to_pickle", "allow_pickle"}
"""Whatever they are called on."""
WRITES_MARKUP = re.compile(r"\b(?:inner|outer)HTML\s*=(?!=)|insertAdjacentHTML|document\.write|\beval\(|new Function")
CONSTANT_MARKUP = re.compile(
    r"innerHTML\s*=\s*(?:\"[^\"$]*\"|'[^'$]*'|PIN$|PIN\b|picture\(number\)|`(?:[^`$]|\$\{SHAPES\[shape\]\})*`)"
)
"""Markup of the program's own: literals, and shapes from a table of the same file."""


def findings(tree: ast.Module) -> Iterator[str]:
    """Every banned thing in a Python source."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
            yield from (f"line {node.lineno} imports {name}" for name in names if name.split(".")[0] in BANNED_IMPORTS)
        elif isinstance(node, ast.Call):
            yield from _call_findings(node)
        elif isinstance(node, ast.Name) and node.id in BANNED_NAMES:
            yield f"line {node.lineno} names {node.id}"


def _call_findings(node: ast.Call) -> Iterator[str]:
    name = ast.unparse(node.func)
    where = f"line {node.lineno} calls {name}"
    given = {keyword.arg: ast.unparse(keyword.value) for keyword in node.keywords}
    if name in BANNED_CALLS or name.rpartition(".")[2] in BANNED_METHODS:
        yield where
    if given.get("shell", "False") != "False":
        yield f"{where} with a shell"
    if given.get("allow_pickle", "False") != "False":
        yield f"{where} with allow_pickle"
    if name.endswith("torch.load") and given.get("weights_only") != "True":
        yield f"{where} without weights_only"
    if name.endswith(".query") and name.split(".")[0] in ("pd", "df", "frame", "table"):
        yield f"{where}, which works out a text"


def test_no_source_loads_or_runs_what_it_is_given() -> None:
    sources = trees(*PACKAGES)
    assert len(sources) > 200
    found = {path.relative_to(ROOT): list(findings(tree)) for path, tree in sources.items()}
    assert {path: lines for path, lines in found.items() if lines} == {}


@pytest.mark.parametrize(
    "source",
    [
        "import pickle", "from pickle import loads", "import numpy as np\nnp.load(p, allow_pickle=True)", "eval(x)",
        "import torch\ntorch.load(p)", "torch.load(p, weights_only=False)", "subprocess.run(c, shell=True)",
        "subprocess.run(c, shell=flag)", "os.system(c)", "archive.extractall(p)", "yaml.load(t)", "tempfile.mktemp()",
        "def f():\n    exec('x')", "os.fork()", "df.query(text)", "map(eval, x)",
    ],
)  # fmt: skip
def test_the_search_finds_what_it_bans(source: str) -> None:
    assert list(findings(ast.parse(source)))


@pytest.mark.parametrize(
    "source", ["# pickle\nx = 'eval(1)'", "torch.load(p, weights_only=True)", "policy.evaluate(t)"]
)
def test_the_search_leaves_words_alone(source: str) -> None:
    assert not list(findings(ast.parse(source)))


def test_scripts_make_text_nodes_and_no_markup_of_what_they_are_told() -> None:
    assert len(PAGES) > 20
    lines = [(path.name, line.strip()) for path in PAGES for line in path.read_text("utf-8").splitlines()]
    writing = [(name, line) for name, line in lines if WRITES_MARKUP.search(line)]
    assert [(name, line) for name, line in writing if not CONSTANT_MARKUP.search(line)] == []


def test_sql_is_made_of_our_own_words() -> None:
    # S13: whatever is put into a statement by a format is a constant of the module or one of `order` and `where`.
    allowed = {
        "condition", "order(search.sort)", "column", "_SELECT", "SCHEMA", "VERSION", "int(1000 * BUSY_S)",
        "', '.join(COLUMNS)", "', '.join(FIELDS)", "', '.join('?' * len(COLUMNS))",
    }  # fmt: skip
    found: set[str] = set()
    for path in ROOT.glob("workbench/run_index*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.JoinedStr) and re.search(
                r"SELECT|INSERT|DELETE|UPDATE|PRAGMA|BEGIN", ast.unparse(node)
            ):
                found |= {ast.unparse(part.value) for part in node.values if isinstance(part, ast.FormattedValue)}
    assert found <= allowed, found - allowed


READS = """
import sys
seen = []
sys.addaudithook(lambda event, args: seen.append(event) if event in ("pickle.find_class", "os.system") else None)
from agents.config import TrainingConfig
from sim.scenario_file import load_scenario, scenario_names
from workbench.policies import resolve_policy, shipped_policies
from workbench.run_index.index import RunIndex
from workbench.runs import RunStore
policies = [resolve_policy(name) for name in shipped_policies()]
scenarios = [load_scenario(name) for name in scenario_names()]
store = RunStore(sys.argv[1])
store.create(TrainingConfig(profile="smoke"))
store.list()
RunIndex(store.root).look()
if "control" in sys.argv:
    import pickle
    pickle.loads(b"cbuiltins\\nprint\\n.")
print(len(policies), len(scenarios), seen)
"""


@pytest.mark.parametrize(("control", "heard"), [([], "[]"), (["control"], "['pickle.find_class']")])
def test_nothing_is_unpickled_while_policies_scenarios_and_runs_are_read(
    tmp_path: Path, control: list[str], heard: str
) -> None:
    # The interpreter itself tells what it unpickles, whichever library does it.
    command = [sys.executable, "-c", READS, str(tmp_path), *control]
    told = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    policies, scenarios, events = told.split(maxsplit=2)
    assert int(policies) >= 4 and int(scenarios) >= 6
    assert events.strip() == heard
