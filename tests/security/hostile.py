"""Texts that are a name to us and something else to a browser, a terminal, a spreadsheet, a shell or a file system."""

from __future__ import annotations

CANARY = "stolen"
"""What a script that runs would set on `window`."""
PRINTABLE = (
    f"<img src=x onerror=window.{CANARY}=1>",
    f"<script>window.{CANARY}=1</script>",
    f"</script><script>window.{CANARY}=1</script>",
    f'"><svg onload=window.{CANARY}=1>',
    f"' onmouseover='window.{CANARY}=1",
    f"javascript:window.{CANARY}=1",
    f"[click](javascript:window.{CANARY}=1)",
    f"<iframe srcdoc='<script>parent.{CANARY}=1</script>'>",
    f"{{{{constructor.constructor('window.{CANARY}=1')()}}}}",
    "{{7*7}}${7*7}#{7*7}<%= 7*7 %>",
    "%s%n{0}{0.__class__}{task.fields}",
    "[bold red]markup[/]",
    '=HYPERLINK("http://evil.example","x")',
    "+1+cmd|' /C calc'!A0",
    "-2+3",
    "@SUM(1,2)",
    "＝1＋1",
    "'; DROP TABLE run; --",
    "../../../etc/passwd",
    "..\\..\\x",
    "/etc/passwd",
    "$(touch stolen)`touch stolen`",
    "--runs=/tmp",
    "@each @words $index $name{custom}",
    "nan",
    "名" * 60,
    "a" * 200,
)
"""What a run may be called: one printable line."""
STEERING = (
    "\x1b[31mred\x1b[0m",
    "\x1b]0;title\x07",
    "\x1b]8;;http://evil.example\x1b\\link\x1b]8;;\x1b\\",
    "\x9b31m",
    "\x9d0;title\x9c",
    "\x1bc",
    "back\b\b\b\bspace",
    "over\rwritten",
    "two\nlines",
    "bell\x07",
    "tab\tbed",
    "zero\x00byte",
    "right\u202eto\u202cleft",
    "isolate\u2066d\u2069",
    "zero\u200bwidth\ufeff",
    "line\u2028separator\u2029",
    "\x7f",
    "\udc80half a pair",
    "\U000e0041tag",
)
"""What steers a terminal, hides or turns round; no run may be called so, but a damaged or foreign file may say it."""
EVERY = (*PRINTABLE, *STEERING, "", "x" * 10_000)


def steers(text: str) -> list[str]:
    """The characters of a terminal's output that are neither printable nor the end of a line."""
    return sorted({c for c in text if not c.isprintable() and c != "\n"})
