"""A web server for the files of one folder, for the browser of this machine alone."""

from __future__ import annotations

import os
import secrets
import threading
import weakref
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote

from .errors import FileError

_KINDS = {
    ".html": "text/html; charset=utf-8", ".css": "text/css", ".js": "text/javascript", ".wasm": "application/wasm",
    ".json": "application/json",
}  # fmt: skip


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    # A port that is still closing is not taken.
    allow_reuse_address = False

    def __init__(self, folder: Path) -> None:
        self.headers = _headers_of(folder)
        self.thread: threading.Thread | None = None
        # The page cannot be found by programs that do not know its address.
        self.secret = secrets.token_urlsafe(16)
        self.files = {f"/{self.secret}/{p.relative_to(folder).as_posix()}": p for p in folder.rglob("*") if p.is_file()}
        super().__init__(("127.0.0.1", 0), _Answer)

    def handle_error(self, request: object, client_address: object) -> None:
        """A browser that goes away in the middle of an answer is no error of the notebook."""


class _Answer(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: _Server

    def do_GET(self) -> None:
        self._answer(True)

    def do_HEAD(self) -> None:
        self._answer(False)

    def _answer(self, with_body: bool) -> None:
        path = unquote(self.path.split("?")[0].split("#")[0])
        file = self.server.files.get(path)
        try:
            body = None if file is None else file.read_bytes()
        except OSError:
            body = None
        self.send_response(404 if body is None else 200)
        self.send_header("Content-Length", str(len(body or b"")))
        if file is not None and body is not None:
            self.send_header("Content-Type", _KINDS.get(file.suffix, "application/octet-stream"))
            self.send_header("Cache-Control", "no-store")
            for name, value in self.server.headers:
                self.send_header(name, value)
        self.end_headers()
        if with_body and body is not None:
            self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Says nothing: the notebook is no log."""


class Serving:
    """Serves the files that a folder holds now, at a random address of 127.0.0.1, until it is closed or forgotten."""

    def __init__(self, folder: Path) -> None:
        try:
            server = _Server(folder)
        except OSError as error:
            raise FileError(f"no page can be shown from 127.0.0.1: {error.strerror or error}; write it with scene.pack(folder) instead") from error
        self.port: int = server.server_address[1]
        self.path = f"/{server.secret}/index.html"
        self.url = f"http://127.0.0.1:{self.port}{self.path}"
        server.thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.1}, name="belvedere page", daemon=True)
        server.thread.start()
        self.close = weakref.finalize(self, _close, server, os.getpid())


def _headers_of(folder: Path) -> list[tuple[str, str]]:
    """Those of the page's file `_headers`: its content security policy is one."""
    lines = (folder / "_headers").read_text(encoding="utf-8").splitlines()[1:]
    pairs = (line.strip().partition(": ") for line in lines if line.strip())
    return [(name, value) for name, _, value in pairs]


def _close(server: _Server, owner: int) -> None:
    # A forked process has no thread that serves, so that waiting for it would not end.
    if os.getpid() == owner and server.thread is threading.current_thread():
        # The collector of garbage may run in the thread that serves, which cannot wait for itself.
        threading.Thread(target=_close, args=(server, owner), daemon=True).start()
        return
    if os.getpid() == owner:
        server.shutdown()
    server.server_close()
