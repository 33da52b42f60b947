"""Mutants of the front door and what stands behind it: S1 to S8, S14, S15 and S17 of docs/security.md."""

from __future__ import annotations

from typing import Final

from tests.mutants.mutant import mutant

SECURITY: Final = "tests/security/"
TOKEN: Final = SECURITY + "test_token.py::"
VIEWERS: Final = SECURITY + "test_viewers.py::"
HOSTS: Final = SECURITY + "test_hosts.py::"
ORIGINS: Final = SECURITY + "test_origins.py::"
HEADERS: Final = SECURITY + "test_headers.py::"
BOUNDS: Final = SECURITY + "test_bounds.py::"
TRAVERSAL: Final = SECURITY + "test_traversal.py::test_no_address_leads_out"
EVERY_PAGE_OPEN: Final = VIEWERS + "test_with_every_page_open_only_this_machine_can_reach_anything"
WEBSOCKETS: Final = ORIGINS + "test_websockets_of_other_pages_are_refused"
EXCHANGED: Final = TOKEN + "test_the_token_is_exchanged_for_a_cookie_and_leaves_the_address"
GUARD: Final = "workbench/guard.py"
PROXY: Final = "workbench/viser_proxy.py"
SERVE: Final = "workbench/server.py"

DOOR: Final = (
    # S1: only this machine can reach anything.
    mutant("S1", "the pages listen on every address", SERVE, "            address=HOST,\n",
           '            address="0.0.0.0",\n',
           SECURITY + "test_listening.py::test_every_listening_socket_of_the_process_tree_is_loopback"),
    mutant("S1", "scenes listen on every address", PROXY, 'PrivateServer(host="127.0.0.1", port=0',
           'PrivateServer(host="0.0.0.0", port=0', EVERY_PAGE_OPEN),
    mutant("S1", "the viewer is taken out of its wheel in view of the network", "workbench/viewer_files.py",
           '"--serve-web", "--bind", "127.0.0.1"]', '"--serve-web"]',
           VIEWERS + "test_the_viewer_is_taken_out_of_its_wheel_on_loopback"),
    # S2: nothing without the token.
    mutant("S2", "the cookie is compared in a time that tells how much of it is right", GUARD,
           "if cookie is not None and hmac.compare_digest(cookie.value.encode(), self._cookie.encode()):",
           "if cookie is not None and cookie.value == self._cookie:",
           TOKEN + "test_secrets_are_compared_in_a_time_that_tells_nothing"),
    mutant("S2", "any cookie of that name lets in", GUARD,
           "if cookie is not None and hmac.compare_digest(cookie.value.encode(), self._cookie.encode()):",
           "if cookie is not None:", TOKEN + "test_no_route_answers_without_the_cookie"),
    mutant("S2", "websockets open without the cookie", GUARD,
           "        return _foreign(request) or self._unknown(request)\n",
           "        return _foreign(request) or (None if _is_websocket(request) else self._unknown(request))\n",
           TOKEN + "test_no_websocket_opens_without_the_cookie"),
    mutant("S2", "static files are for everybody", GUARD,
           "        return _foreign(request) or self._unknown(request)\n",
           '        open_ = request.path.startswith("/static/")\n'
           "        return _foreign(request) or (None if open_ else self._unknown(request))\n",
           TOKEN + "test_no_route_answers_without_the_cookie"),
    mutant("S2", "the token is short", GUARD,
           "    token: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)\n",
           "    token: str = field(default_factory=lambda: secrets.token_urlsafe(8), repr=False)\n",
           TOKEN + "test_the_token_is_long_and_nowhere_on_disk"),
    mutant("S2", "the cookie is the same at every start", GUARD,
           "    _cookie: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)\n",
           '    _cookie: str = field(default="0123456789abcdef01234567", repr=False)\n',
           TOKEN + "test_every_start_has_secrets_of_its_own"),
    # S3: the token stays secret.
    mutant("S3", "scripts can read the cookie", GUARD, 'httponly=True, samesite="Strict"', 'samesite="Strict"',
           EXCHANGED),
    mutant("S3", "other sites' links carry the cookie", GUARD, 'samesite="Strict"', 'samesite="Lax"', EXCHANGED),
    mutant("S3", "the token stays in the address", GUARD, ' if key != "token"]', "]", EXCHANGED),
    mutant("S3", "the lock file holds the token", SERVE, 'f"{address} (process', 'f"{address}?token={token} (process',
           TOKEN + "test_the_token_is_long_and_nowhere_on_disk"),
    mutant("S3", "the log holds the addresses of what failed", GUARD,
           "request.method, handler.request.path, handler", "request.method, handler.request.uri, handler",
           TOKEN + "test_what_fails_is_logged_without_its_query"),
    mutant("S3", "a websocket's address may hold the token and is logged when it fails", GUARD,
           "        if offered and _is_websocket(request):\n", "        if False:\n",
           TOKEN + "test_a_websocket_takes_no_token_in_its_address"),
    # S4: our own names alone are answered.
    mutant("S4", "a name that begins like ours is ours", GUARD, "OUR_HOST.fullmatch(host)", "OUR_HOST.match(host)",
           HOSTS + "test_other_names_are_refused"),
    mutant("S4", "hosts are compared for pages and not for websockets", GUARD,
           "    if not OUR_HOST.fullmatch(host) or",
           "    if not (_is_websocket(request) or OUR_HOST.fullmatch(host)) or",
           HOSTS + "test_other_names_are_refused"),
    mutant("S4", "an absolute address names its own host", GUARD, ' or not (request.uri or "").startswith("/")', "",
           HOSTS + "test_an_absolute_address_is_refused"),
    # S5: a websocket opens for a page of this server only.
    mutant("S5", "a websocket without an origin opens", GUARD,
           'own = origin is not None and origin.lower() == f"http://{host}".lower()',
           'own = origin is None or origin.lower() == f"http://{host}".lower()', WEBSOCKETS),
    mutant("S5", "an origin that begins like ours is ours", GUARD,
           'own = origin is not None and origin.lower() == f"http://{host}".lower()',
           'own = origin is not None and origin.lower().startswith(f"http://{host}".lower())', WEBSOCKETS),
    mutant("S5", "a scene opens for every origin", PROXY, "functools.partial(plain, origins=[Origin(origin)])",
           "functools.partial(plain)", EVERY_PAGE_OPEN),
    # S6: no request changes anything.
    mutant("S6", "DELETE is forgotten", GUARD, 'if request.method not in ("GET", "HEAD"):',
           'if request.method in ("POST", "PUT", "PATCH"):', ORIGINS + "test_nothing_can_be_changed_by_a_request"),
    mutant("S6", "pages of another port may read", GUARD, 'site in ("cross-site", "same-site")', 'site == "cross-site"',
           ORIGINS + "test_other_pages_cannot_embed_what_we_serve"),
    mutant("S6", "an address deletes a run", "workbench/pages/runs.py",
           "        self.settings = self._opened = read_settings(read_query())\n",
           "        self.settings = self._opened = read_settings(read_query())\n"
           '        if doomed := read_query().get("delete"):\n            self._store.delete(doomed)\n',
           BOUNDS + "test_no_address_changes_anything"),
    # S7: every answer carries the headers.
    mutant("S7", "errors and refusals carry no headers", GUARD,
           "        for name, value in HEADERS.items():\n",
           "        for name, value in HEADERS.items() if status_code < 400 else ():\n",
           HEADERS + "test_every_refusal_carries_the_headers"),
    mutant("S7", "other sites may frame the pages", GUARD, "    \"frame-ancestors 'self'; \"\n", '    ""\n',
           HEADERS + "test_every_answer_carries_the_headers"),
    mutant("S7", "pages may ask other machines", GUARD, "\"connect-src 'self' data: blob:;",
           "\"connect-src 'self' https: data: blob:;", HEADERS + "test_every_answer_carries_the_headers"),
    # S8: no address leads out of the folder it stands for.
    mutant("S8", "any name is taken for a recording's", "workbench/file_routes.py",
           r'(r"/rrd/([A-Za-z0-9][A-Za-z0-9._-]{0,150}\.rrd)"', '(r"/rrd/(.+)"', TRAVERSAL),
    mutant("S8", "what begins like the id of a run is one", "workbench/run_folder.py", "RUN_ID.fullmatch(text)",
           "RUN_ID.match(text)", "tests/reliability/test_runs.py::test_only_an_id_ever_becomes_a_path"),
    # S14: going remote is refused.
    mutant("S14", "only 0.0.0.0 counts as remote", SERVE, "    if host not in OWN_NAMES:\n",
           '    if host == "0.0.0.0":\n', BOUNDS + "test_remote_is_refused_with_the_way_to_do_it"),
    # S15: what comes in has bounds.
    mutant("S15", "bodies are waited for for an hour", SERVE, '"body_timeout": 10.0', '"body_timeout": 3600.0',
           BOUNDS + "test_nobody_is_waited_for_without_end"),
    mutant("S15", "the limits of requests are not given to the server", SERVE,
           "            http_server_kwargs=dict(REQUEST_LIMITS),\n", "",
           BOUNDS + "test_nobody_is_waited_for_without_end"),
    # S17: viewers cannot act.
    mutant("S17", "a scene's page may press buttons", PROXY,
           'LOOKS = frozenset({"ViewerCameraMessage", "GetRenderResponseMessage"})',
           'LOOKS = frozenset({"ViewerCameraMessage", "GetRenderResponseMessage", "GuiUpdateMessage"})',
           VIEWERS + "test_of_all_messages_only_looks_are_passed_on"),
    mutant("S17", "every message of a scene's page is passed on", PROXY,
           "if self._upstream is not None and only_looks(message):", "if self._upstream is not None:",
           VIEWERS + "test_the_camera_of_a_scene_is_heard_through_the_door_and_a_press_is_not"),
    mutant("S17", "a scene has a button", "layouts/scene.py", "    server.scene.reset()\n",
           '    server.scene.reset()\n    server.gui.add_button("Train")\n',
           VIEWERS + "test_no_scene_has_anything_to_press"),
    mutant("S17", "Rerun serves its recordings itself", "workbench/recordings.py", "    recording.flush()\n",
           "    recording.serve_grpc()\n    recording.flush()\n",
           VIEWERS + "test_no_viewer_of_rerun_is_served_by_rerun"),
)  # fmt: skip
