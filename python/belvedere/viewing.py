"""Scenes in a browser: a page that can be moved in, in a cell of a notebook or in a folder for a web server."""

from __future__ import annotations

import base64
import html
import json
import os
import webbrowser
from collections import deque
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._ask import Progress, asked
from ._folder import Folder, Named
from ._json import size as size_of
from ._serving import Serving
from .errors import FileError, InputError

if TYPE_CHECKING:
    from .scene import Scene

__all__ = ["View", "view", "pack"]

#: Pages that notebooks have shown and that nobody else holds: so many stay open.
_SHOWN: deque[View] = deque(maxlen=8)
_REMEDY = (
    "set BELVEDERE_WEB_APP to the folder that holds it; in a copy of the repository apps/viewer/web/build python/belvedere/web "
    "builds it, and wheels that are built afterwards bring it"
)


class View:
    """A scene as a page of this machine, which can be moved in. In a notebook it shows itself.

    The page comes from a server of this object at a random address of 127.0.0.1; it loads nothing from elsewhere, and its content security policy
    forbids it. The server ends with :meth:`close`, at the end of a ``with`` block, with the process, or when the object is forgotten; the last
    eight that a notebook has shown are not forgotten. Where the server cannot be reached, as from a saved notebook, a still picture is shown.
    """

    def __init__(self, folder: Folder, page: Path, title: str, size: tuple[int, int], still: bytes | None, address: str | None) -> None:
        self._folder, self._title, self._still, self._address = folder, title, still, address
        self._serving: Serving | None = Serving(page)
        #: Width and height in the notebook, pixels.
        self.size = size

    @property
    def url(self) -> str:
        """Address of the page. Raises :class:`belvedere.InputError` after :meth:`close`."""
        if self._serving is None:
            raise InputError("the page was closed; call view() again")
        if self._address is None:
            return self._serving.url
        return self._address.replace("{port}", str(self._serving.port)).rstrip("/") + self._serving.path

    def open(self) -> bool:
        """Opens the page in the browser of this machine; whether there is one."""
        return webbrowser.open(self.url)

    def close(self) -> None:
        """Ends the server and removes the files of the page."""
        if self._serving is not None:
            self._serving.close()
            self._serving = None
            self._folder.close()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<belvedere.View {self._title!r}, {'closed' if self._serving is None else 'open'}>"

    def _repr_html_(self) -> str:
        width, height = self.size
        name = html.escape(self._title or "Belvedere", quote=True)
        inner = f"<p>{name}: the page is not reachable; run the cell again.</p>"
        if self._still is not None:
            inner = f'<img alt="{name}" style="display:block;width:100%" src="data:image/png;base64,{base64.b64encode(self._still).decode()}">'
        if self._serving is not None:
            if self not in _SHOWN:
                _SHOWN.append(self)
            # An object shows what it holds where its page cannot be loaded, which an iframe does not.
            url = html.escape(self.url, quote=True)
            inner = f'<object type="text/html" data="{url}" aria-label="{name}" style="display:block;width:100%;height:100%">{inner}</object>'
        return f'<div style="width:100%;max-width:{width}px;aspect-ratio:{width}/{height}">{inner}</div>'

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {"text/html": self._repr_html_(), "text/plain": repr(self)}


def view(
    scene: Scene,
    *,
    size: tuple[int, int] = (960, 540),
    still: bool | tuple[int, int] = True,
    address: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> View:
    """A scene as a page that can be moved in: in a cell of a notebook, or in a browser by ``view(scene).open()``.

    * ``size``: width and height of the cell's page, pixels.
    * ``still``: the picture for where the page cannot be loaded, such as saved notebooks: ``True``, its size in pixels, or ``False``.
    * ``address``: where the browser of a notebook on another machine reaches ports of this one, with ``{port}`` in place of its number, such as
      ``"/user/me/proxy/{port}"`` of jupyter-server-proxy; ``None``: 127.0.0.1.
    * ``threads``, ``progress``: see :func:`belvedere.reveal`.

    Raises :class:`belvedere.FileError` where the application for browsers is missing, with what brings it.
    """
    width, height = size_of(size) or (960, 540)
    if address is not None and "{port}" not in address:
        raise InputError(f"address={address!r} has no {{port}}; give one such as '/proxy/{{port}}'")
    folder = Folder()
    page = pack(scene, folder.file("page"), threads=threads, progress=progress)
    picture = None
    if still is not False:
        # Half the pixels each way: a notebook keeps it with its outputs.
        picture = scene.render(size=(max(width // 2, 1), max(height // 2, 1)) if still is True else still, threads=threads).png()
    title = json.loads((page / "bundle.json").read_text(encoding="utf-8"))["title"]
    return View(folder, page, str(title), (width, height), picture, address)


def pack(
    scene: Scene,
    out: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Path:
    """Writes a scene as a folder that any web server can host, as ``belvedere pack`` does: the application, the scene, and every file that it takes.
    Returns the folder.

    Raises :class:`belvedere.FileError` where the application for browsers is missing, or files exist without ``overwrite``.
    """
    application = _application()
    folder = Folder()
    file = scene._file
    if file is None or scene._seed is not None:
        file = scene.save(folder.file("scene.json"))
    with asked(threads, progress) as ask, Named(os.fspath(folder.path)):
        _native.pack(os.fspath(file), scene._roots, os.fspath(application), _REMEDY, os.fspath(out), overwrite, ask)
    return Path(os.fspath(out))


def _application() -> Path:
    """The folder of the application for browsers: named by the environment, or in the package."""
    named = os.environ.get("BELVEDERE_WEB_APP")
    folder = Path(named) if named else Path(str(resources.files("belvedere").joinpath("web")))
    if not (folder / "index.html").is_file():
        what = f"BELVEDERE_WEB_APP={named} holds" if named else "this package holds"
        raise FileError(f"{what} no application for browsers; {_REMEDY}")
    return folder
