"""Pages in cells of notebooks: what is packed, who may read it, and when it ends. The application is made of stand-ins: these tests read no page."""

from __future__ import annotations

import gc
import http.client
import json
import os
import re
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import pytest

import belvedere

PAGE = ["index.html", "page.css", "page.js", "kept.js", "mirror.js", "LICENCES.txt", "belvedere.js", "belvedere_bg.wasm"]
POLICY = "default-src 'none'; script-src 'self'"


@pytest.fixture
def application(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "application"
    folder.mkdir()
    for name in PAGE:
        (folder / name).write_text(f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">' if name == "index.html" else name)
    monkeypatch.setenv("BELVEDERE_WEB_APP", str(folder))
    return folder


def answer(url: str) -> http.client.HTTPResponse:
    return urllib.request.urlopen(url, timeout=10)  # type: ignore[no-any-return]


def test_the_page_of_a_scene_of_arrays(scene: belvedere.Scene, application: Path) -> None:
    with scene.view(size=(320, 180)) as shown:
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{22}/index\.html", shown.url)
        page = answer(shown.url)
        assert page.headers["Content-Security-Policy"] == POLICY and page.headers["Content-Type"].startswith("text/html")
        near = shown.url.removesuffix("index.html")
        assert answer(near + "belvedere_bg.wasm").headers["Content-Type"] == "application/wasm"
        bundle = json.load(answer(near + "bundle.json"))
        assert bundle["title"] == "Hills" and len(bundle["files"]) == 3
        for file in bundle["files"]:
            assert len(answer(near + file["path"]).read()) == file["bytes"]
        bundle_of_shell = shown._repr_mimebundle_()
        assert f'data="{shown.url}"' in bundle_of_shell["text/html"] and "data:image/png;base64," in bundle_of_shell["text/html"]
    with pytest.raises(urllib.error.URLError):
        answer(near + "index.html")
    assert "<object" not in shown._repr_html_() and "<img" in shown._repr_html_()
    with pytest.raises(belvedere.InputError, match="closed"):
        _ = shown.url


def test_nothing_else_is_served(scene: belvedere.Scene, application: Path) -> None:
    with scene.view(still=False) as shown:
        secret = shown.url.split("/")[3]
        connection = http.client.HTTPConnection("127.0.0.1", int(shown.url.split(":")[2].split("/")[0]), timeout=10)
        for path in ("/", "/index.html", f"/{secret}", f"/{secret}/", f"/{secret}/../page.js", f"/{secret}/%2e%2e/page", "//etc/passwd", f"/{secret}/..%2f..%2fetc/passwd"):
            connection.request("GET", path)
            response = connection.getresponse()
            assert (response.status, response.read()) == (404, b""), path
        connection.request("HEAD", f"/{secret}/page.js")
        response = connection.getresponse()
        assert response.status == 200 and response.read() == b""
        connection.request("POST", f"/{secret}/page.js", b"x")
        assert connection.getresponse().status == 501
        connection.close()
        assert "<img" not in shown._repr_html_()


def test_a_forgotten_view_ends_and_its_files_go(scene: belvedere.Scene, application: Path) -> None:
    shown = scene.view(still=False)
    url, folder = shown.url, shown._folder.path
    assert folder.is_dir() and answer(url).status == 200
    del shown
    gc.collect()
    assert not folder.exists()
    with pytest.raises(urllib.error.URLError):
        answer(url)


def test_the_last_views_that_were_shown_stay(scene: belvedere.Scene, application: Path) -> None:
    urls = []
    for _ in range(9):
        shown = scene.view(still=False)
        shown._repr_html_()
        urls.append(shown.url)
        del shown
    gc.collect()
    with pytest.raises(urllib.error.URLError):
        answer(urls[0])
    assert all(answer(url).status == 200 for url in urls[1:])


def test_another_address_for_notebooks_elsewhere(scene: belvedere.Scene, application: Path) -> None:
    with scene.view(still=False, address="/user/me/proxy/{port}") as shown:
        assert re.fullmatch(r"/user/me/proxy/\d+/[\w-]{22}/index\.html", shown.url)
    with pytest.raises(belvedere.InputError, match="port"):
        scene.view(address="/proxy")


def test_the_title_is_no_markup(application: Path) -> None:
    scene = belvedere.Scene(title='<b onload="x">', crs="local").add_atoms(["C"], [[0, 0, 0]])
    with scene.view(size=(64, 48)) as shown:
        assert "<b " not in shown._repr_html_()


def test_without_the_application_it_says_what_brings_it(scene: belvedere.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BELVEDERE_WEB_APP", str(tmp_path))
    with pytest.raises(belvedere.FileError, match="holds no application for browsers.*apps/viewer/web/build"):
        scene.view()


def test_pack_writes_what_the_program_writes(tmp_path: Path, application: Path) -> None:
    scene = belvedere.Scene.builtin("dna")
    site = scene.pack(tmp_path / "site")
    assert {p.name for p in site.iterdir()} == {*PAGE, "_headers", "bundle.json", "scene"}
    with pytest.raises(belvedere.FileError, match="exist"):
        scene.pack(site)
    scene.pack(site, overwrite=True)
    file = scene.save(tmp_path / "scene.json")
    subprocess.run([sys.executable, "-m", "belvedere", "pack", file, "-o", tmp_path / "other", "-q"], check=True, env={**os.environ})
    assert (site / "bundle.json").read_bytes() == (tmp_path / "other" / "bundle.json").read_bytes()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_forked_process_ends(scene: belvedere.Scene, application: Path) -> None:
    with scene.view(still=False) as shown:
        child = os.fork()
        if child == 0:
            shown.close()
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        assert answer(shown.url).status == 200
