"""Changes of a page that are gathered once."""

from __future__ import annotations

import panel as pn
import pytest
from bokeh.document import Document
from bokeh.models import Column, Div

from workbench.pages.one_change import one_change


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> Column:
    """The root of a document that is the page's."""
    document, root = Document(), Column()
    document.add_root(root)
    monkeypatch.setattr(type(pn.state), "curdoc", property(lambda _state: document))
    return root


def walks(root: Column, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """A list that grows whenever all models are gathered."""
    document, seen = root.document, []
    assert document is not None
    gather = document.models.recompute
    monkeypatch.setattr(document.models, "recompute", lambda: (seen.append(1), gather())[1])
    return seen


def test_models_are_gathered_once_however_many_come(root: Column, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = walks(root, monkeypatch)
    with one_change():
        for _ in range(5):
            root.children = [*root.children, Div()]
    assert len(seen) == 1
    assert root.document is not None
    assert {type(model) for model in root.document.models} >= {Div}
    for _ in range(5):  # what it is good for
        root.children = [*root.children, Div()]
    assert len(seen) == 6


def test_an_error_goes_through_and_the_page_lives_on(root: Column) -> None:
    with pytest.raises(ValueError, match="odd"), one_change():
        root.children = [Div(text="before")]
        raise ValueError("odd")
    root.children = [Div(text="after")]
    assert root.document is not None
    assert [model.text for model in root.document.models if isinstance(model, Div)] == ["after"]


def test_without_a_page_nothing_is_gathered() -> None:
    with one_change():
        pass
