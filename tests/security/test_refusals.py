"""S9: what a refusal repeats of an address, a file or a name is no markup, on a page and at the door."""

from __future__ import annotations

import pytest

from tests.conftest import Served
from tests.security.hostile import PRINTABLE
from workbench.app import _problem


@pytest.mark.parametrize("text", PRINTABLE, ids=range(len(PRINTABLE)))
def test_what_a_refusal_repeats_is_no_markup(text: str) -> None:
    shown = _problem(f"no run {text}", "warning").object
    assert not {"<", ">", '"', "'"} & set(shown)


@pytest.mark.parametrize("path", ["/%3Cscript%3Ealert(1)%3C/script%3E", "/fly%3Cimg%20src=x%3E", "/rrd/%3Cb%3E.rrd"])
def test_an_address_that_is_none_is_not_repeated(served: Served, path: str) -> None:
    reply = served.ask(path)
    assert reply.status == 404
    assert not [markup for markup in (b"<script>alert", b"<img", b"<b>") if markup in reply.body]
