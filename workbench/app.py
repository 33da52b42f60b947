"""The pages put together: one frame with the navigation around each page of `workbench.pages`."""

from __future__ import annotations

import html
import importlib
import logging
from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.io.resources import LOCAL_DIST
from panel.util.parameters import edit_readonly

from layouts import theme
from sim.errors import SubMasError
from workbench.connection_bar import connection_bar
from workbench.context import AppContext
from workbench.file_routes import scripts
from workbench.history_steps import history_steps
from workbench.navigation import Navigation
from workbench.pending_messages import leave_no_message_behind
from workbench.session_end import ask_no_longer_whether_busy, forget_views, give_memory_back
from workbench.tour import tour

PAGES = {
    "fly": "Fly",
    "curriculum": "Curriculum",
    "live": "Live",
    "runs": "Runs",
    "compare": "Compare",
    "paper": "Paper",
}
"""Address and title of each page, in the order of the navigation; the first one is where `/` leads."""
TITLE = "SubMas workbench"
SPACERS = {
    "defaultProps": {"variantMapping": {"h1": "h1", "h2": "h2", "h3": "h1", "h4": "h4", "h5": "div", "h6": "h6"}}
}
"""The frame's title is the page's first heading; what it takes for headings of the fifth level are spacers."""

log = logging.getLogger(__name__)


def applications(context: AppContext) -> dict[str, Callable[[], pmui.Page]]:
    """One application per page, by its address, for Panel's server."""
    pn.extension(notifications=True, reconnect=True, sizing_mode="stretch_width", js_files=scripts())
    pn.config.exception_handler = _show_problem
    leave_no_message_behind()
    # Panel calls plain functions once per session; a functools.partial it would print.
    return {name: lambda name=name: framed(context, name) for name in PAGES}


def framed(context: AppContext, name: str) -> pmui.Page:
    """The page `name` in its frame, dark unless the address says `theme=default`."""
    if pn.state.curdoc is not None:
        # A page that reconnects after its session has ended gets a new one without the request that would say where
        # Panel's files are; Panel would then look for them on the internet.
        pn.state.curdoc.template_variables.setdefault("dist_url", LOCAL_DIST)
        pn.state.on_session_destroyed(forget_views)
        pn.state.on_session_destroyed(give_memory_back)
    light = pn.state.session_args.get("theme", [b""])[0] == b"default"
    setattr(pn.config, "theme", "default" if light else "dark")  # noqa: B010 - Panel hides the setter from type checkers
    links = Navigation(PAGES, name, dark=not light)
    bar = connection_bar()
    page = pmui.Page(
        title=TITLE,
        meta_title=f"{PAGES[name]} · {TITLE}",
        site_url=f"/{next(iter(PAGES))}",
        header=[links.pane, tour(name, PAGES), *history_steps(name), bar],
        dark_theme=not light,
        theme_config={"dark": _look("dark"), "light": _look("light")},
        busy_indicator=None,
        sx={"& > .header": {"backgroundColor": theme.hexadecimal(theme.DARK.field), "backgroundImage": "none"}},
        main=[_content(context, name)],
    )
    # The frame hears of every event that Python begins and ends, and each time Panel walks over all models of the page,
    # some 50 ms: the clock of Fly, the search of Runs would wait for that. Its bar is not shown, so it need not hear.
    with edit_readonly(page):
        page.busy = False
    ask_no_longer_whether_busy(page)
    page.param.watch(lambda event: _keep_theme(links, dark=event.new), "dark_theme")
    if light:
        _keep_theme(links, dark=False)
    return page


def _look(mode: theme.Mode) -> dict[str, Any]:
    """Colours of the frame and its widgets, with enough contrast for words, and what they are to a listener."""
    background = theme.hexadecimal(theme.ground(mode).background)
    filled = {"backgroundColor": theme.FILLED, "color": "#ffffff"}
    button = {"props": {"variant": "contained", "color": "primary"}, "style": filled}
    return {
        "palette": {
            "primary": {"main": theme.POLICY_A if mode == "dark" else theme.FILLED, "contrastText": "#ffffff"},
            "background": {"default": background, "paper": background},
        },
        "components": {
            "MuiTypography": SPACERS,
            "MuiLinearProgress": {"defaultProps": {"aria-label": "Progress"}},
            "MuiButton": {"styleOverrides": {"root": {"variants": [button]}}},
            # Each "&" outweighs one class of the rule that Panel Material UI writes into the group.
            "MuiToggleButton": {"styleOverrides": {"root": {"&&&&.Mui-selected": filled}}},
        },
    }


def _keep_theme(links: Navigation, dark: bool) -> None:
    """The other pages and a reload come up in the colours of this one."""
    links.keep_theme(dark)
    if pn.state.location is not None:
        pn.state.location.update_query(theme="dark" if dark else "default")  # pyright: ignore[reportArgumentType]


def _content(context: AppContext, name: str) -> Any:
    try:
        return importlib.import_module(f"workbench.pages.{name}").page(context)
    except SubMasError as error:
        return _problem(str(error), "warning")
    except Exception as error:
        log.exception("the %s page failed", PAGES[name])
        return _problem(
            f"The {PAGES[name]} page cannot be shown: {_brief(error)}. The terminal has the details.", "error"
        )


def _problem(sentence: str, severity: str) -> pmui.Alert:
    return pmui.Alert(object=html.escape(sentence), severity=severity, margin=24)


def _brief(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__


def _show_problem(error: Exception) -> None:
    """An event that failed becomes a notification on its page; what was not foreseen is also logged."""
    known = isinstance(error, SubMasError)
    if not known:
        log.error("an event failed", exc_info=error)
    if pn.state.notifications is not None:
        sentence = str(error) if known else f"That did not work: {_brief(error)}. The terminal has the details."
        pn.state.notifications.error(html.escape(sentence), duration=8000)
