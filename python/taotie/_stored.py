"""A collection on any file system that fsspec can list and write: S3, Google Cloud, another machine.

The planning process holds no asset. It has a separate folder with the names, sizes and times of all files: sparse
files that take no disk space, except for the few that it reads. Each job fetches its scan and the models that its
settings name, with the files that these reference, or all files next to its photographs, and uploads its results.
"""

from __future__ import annotations

import json
import os
import posixpath
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from datetime import datetime, timezone
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import unquote

from ._jobs import work

__all__ = ["Keeper", "Stored", "is_url"]

#: Formats whose text or bytes name other files, and how many of their bytes can; OBJ and glTF are read otherwise.
_NAMING = {".mtl": -1, ".fbx": -1, ".ply": 1 << 20}
_MODELS = {".gltf", ".glb", ".obj", ".ply", ".stl", ".fbx"}
#: Lists and records, which the planning process reads.
_BOOKS = {".toml", ".csv", ".jsonl", ".ndjson"}
#: What `_plain` makes of each byte.
_PLAIN = bytes(byte if byte >= 128 or chr(byte).isalnum() or chr(byte) in "._-" else ord("/") for byte in range(256)).lower()
#: Seconds between uploads of the manifest.
_EVERY = 60.0


def is_url(collection: object) -> bool:
    """Return true if a collection is given as the URL of a file system rather than as a path."""
    return "://" in str(collection)


@dataclass
class Stored:
    """A collection's folder on a file system.

    Attributes
    ----------
    url : str
        The collection's file.
    options : dict
        Options of fsspec's file system: keys, endpoints.
    """

    url: str
    options: dict[str, Any] = field(default_factory=dict)
    #: Size and time of each file, seconds since 1970, by its path relative to the folder.
    files: dict[str, tuple[int, float]] = field(default_factory=dict)

    def _system(self) -> tuple[Any, str]:
        """The file system, and the folder's path on it."""
        import fsspec

        system, path = fsspec.core.url_to_fs(self.url, **self.options)
        return system, posixpath.dirname(path)

    def look(self) -> None:
        """List all files of the folder.

        Raises
        ------
        FileNotFoundError
            If the collection's file does not exist.
        """
        system, root = self._system()
        system.invalidate_cache()
        self.files = {}
        for path, about in system.find(root, detail=True).items():
            self.files[posixpath.relpath(path, root)] = (int(about["size"] or 0), _seconds(about))
        if self.name not in self.files:
            raise FileNotFoundError(f"{self.url}: no such file")

    @property
    def name(self) -> str:
        """The name of the collection's file."""
        return posixpath.basename(self.url)

    def outline(self, folder: Path) -> Path:
        """Create a folder with all names, sizes and times; return the collection's file in it."""
        self._fetch([self.name], folder)
        own = (folder / self.name).read_bytes()
        for path, (size, seconds) in self.files.items():
            place = _within(folder, path)
            place.parent.mkdir(parents=True, exist_ok=True)
            if _is_planned_by(path, own):
                self._fetch([path], folder)
            else:
                with open(place, "wb") as file:
                    file.truncate(size)
                os.utime(place, (seconds, seconds))
        return folder / self.name

    def work(self, planned: dict[str, Any], *how: Any) -> dict[str, Any]:
        """Do a job in a temporary folder: fetch its inputs, upload its results. See `_jobs.work`.

        If the job's ``address`` is known, the asset stored there is fetched: only the missing parts are made.
        """
        with tempfile.TemporaryDirectory(prefix="taotie-") as name:
            folder = Path(name)
            start = time.monotonic()
            job = planned["job"]
            self._fetch([*self._read_by(job, folder), *self._named_in(job["settings"], folder)], folder)
            # A list in a folder names scans by paths through that folder: `lists/../scans/a.obj`.
            (folder / job["scan"]).parent.mkdir(parents=True, exist_ok=True)
            if made := planned.get("address"):
                asset = _object(job, made)
                self._fetch([path for path in self.files if path.startswith(f"{asset}/")], folder)
            report = work({**planned, "folder": name}, *how)
            outcome = report.get("outcome")
            for part in outcome["parts"] if outcome else []:
                if not part["reused"]:
                    self._bring(folder, _object(job, part["address"]))
            report["seconds"] = time.monotonic() - start
            return report

    def keep(self, folder: Path, paths: Iterable[str]) -> None:
        """Upload files of a folder to the file system."""
        system, root = self._system()
        for path in paths:
            system.makedirs(posixpath.dirname(f"{root}/{path}"), exist_ok=True)
            system.put_file(str(folder / path), f"{root}/{path}")

    def url_of(self, path: str) -> str:
        """The URL of a path relative to the folder."""
        return posixpath.join(posixpath.dirname(self.url), PurePosixPath(path).as_posix())

    def _fetch(self, paths: Iterable[str], folder: Path) -> None:
        system, root = self._system()
        for path in paths:
            if path in self.files:
                place = _within(folder, path)
                if place.exists():
                    continue
                place.parent.mkdir(parents=True, exist_ok=True)
                system.get_file(f"{root}/{path}", str(place))
                seconds = self.files[path][1]
                os.utime(place, (seconds, seconds))

    def _bring(self, folder: Path, path: str) -> None:
        """Upload an object. The file that marks it as complete comes last."""
        system, root = self._system()
        files = [file.relative_to(folder / path).as_posix() for file in (folder / path).rglob("*") if file.is_file()]
        for name in sorted(files, key=lambda name: name == "object.json"):
            system.makedirs(posixpath.dirname(f"{root}/{path}/{name}"), exist_ok=True)
            system.put_file(str(folder / path / name), f"{root}/{path}/{name}")

    def _read_by(self, job: dict[str, Any], folder: Path) -> list[str]:
        """The files that a job reads, except for those that its settings name."""
        scan = posixpath.normpath(job["scan"])
        if "photometric" not in job["settings"]["task"]:
            return [scan, *self._named_by(scan, folder)]
        # A folder of photographs, or a file among them.
        return self._inside(posixpath.dirname(scan) if scan in self.files else scan)

    def _inside(self, folder: str) -> list[str]:
        """The files directly in a folder."""
        return [path for path in self.files if posixpath.dirname(path) == ("" if folder == "." else folder)]

    def _named_by(self, model: str, folder: Path) -> list[str]:
        """The files in a model's folder that it names, or that one of them names; models reach no others.

        Only names count, without folders and in any case, since the readers of some formats look for them so.
        """
        above = posixpath.dirname(model)
        start = above + "/" if above else ""
        names = {
            path: {_plain(os.fsencode(name)), _plain(name.encode("latin-1", "replace"))}
            for path in self.files
            if path.startswith(start) and _suffix(path) not in _MODELS
            for name in [posixpath.basename(path)]
        }
        found: dict[str, None] = {}
        unread = [model]
        while unread:
            text = self._text(unread.pop(), folder)
            for path, forms in names.items():
                if path not in found and any(form in text for form in forms):
                    found[path] = None
                    unread.append(path)
        return list(found)

    def _text(self, path: str, folder: Path) -> bytes:
        """The part of a file that can name other files, see `_plain`."""
        self._fetch([path], folder)
        suffix = _suffix(path)
        with open(_within(folder, path), "rb") as file:
            if suffix == ".obj":
                text = b"".join(line for line in file if line.lstrip().startswith(b"mtllib"))
            elif suffix == ".gltf":
                text = _uris(file.read())
            elif suffix == ".glb":
                # The container's header and the length of its JSON, which comes first.
                start = file.read(20)
                text = _uris(file.read(int.from_bytes(start[12:16], "little")))
            else:
                text = file.read(_NAMING.get(suffix, 0))
        return _plain(text)

    def _named_in(self, settings: Any, folder: Path) -> list[str]:
        """All files that settings name, those that models among them name, and those in folders that they name."""
        if isinstance(settings, dict):
            return [path for value in settings.values() for path in self._named_in(value, folder)]
        if isinstance(settings, list):
            return [path for value in settings for path in self._named_in(value, folder)]
        if not isinstance(settings, str) or not settings:
            return []
        path = posixpath.normpath(settings)
        if path not in self.files:
            return self._inside(path)
        return [path, *self._named_by(path, folder)] if _suffix(path) in _MODELS else [path]


class Keeper:
    """Uploads the books from the planning folder: the manifest periodically, and all changes at the end."""

    def __init__(self, stored: Stored, folder: Path) -> None:
        self._stored, self._folder = stored, folder
        self._known = self._books()
        self._last = time.monotonic()

    def recorded(self) -> None:
        """Upload the manifest if it is due."""
        if time.monotonic() - self._last >= _EVERY:
            self._copy("manifest*.jsonl")

    def end(self) -> None:
        """Upload all books."""
        self._copy("*")

    def _copy(self, names: str) -> None:
        self._last = time.monotonic()
        books = self._books()
        changed = [path for path in books if fnmatch(posixpath.basename(path), names) and books[path] != self._known.get(path)]
        self._stored.keep(self._folder, changed)
        self._known.update({path: books[path] for path in changed})

    def _books(self) -> dict[str, tuple[int, int]]:
        """Size and time of each file here that is neither a scan nor an object, excluding links."""
        found = {}
        for path in self._folder.rglob("*"):
            if path.is_file() and not path.is_symlink() and "objects" not in path.parts:
                about = path.stat()
                found[path.relative_to(self._folder).as_posix()] = (about.st_size, about.st_mtime_ns)
        return found


def _object(job: dict[str, Any], address: str) -> str:
    """The folder of an object, relative to the collection's."""
    return f"{PurePosixPath(job['output']).as_posix()}/objects/{address[:2]}/{address}"


def _suffix(path: str) -> str:
    return PurePosixPath(path).suffix.lower()


def _is_planned_by(path: str, collection: bytes) -> bool:
    """Return true for files that the planning process reads: records, lists and what the collection's file names."""
    name = posixpath.basename(path)
    is_named = os.fsencode(name) in collection and _suffix(path) not in _MODELS
    return is_named or _suffix(path) in _BOOKS or name == "object.json"


def _plain(text: bytes) -> bytes:
    """Text in lower case, with a slash before it and for each byte that usually separates names, such as a quote."""
    return b"/" + text.translate(_PLAIN)


def _uris(document: bytes) -> bytes:
    """The URIs in a glTF document, a line for each, as they are and decoded."""
    try:
        uris = list(_uris_in(json.loads(document)))
    except (ValueError, RecursionError):
        # The job reports what is wrong.
        return b""
    lines = [line for uri in uris if uri[:5].lower() != "data:" for line in (uri, unquote(uri))]
    return "\n".join(lines).encode("utf-8", "replace")


def _uris_in(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        if isinstance(value.get("uri"), str):
            yield value["uri"]
        value = list(value.values())
    if isinstance(value, list):
        for inner in value:
            yield from _uris_in(inner)


def _seconds(about: dict[str, Any]) -> float:
    """The modification time of a file as its file system reports it; 0 if it does not."""
    when = next((about[key] for key in ("LastModified", "mtime", "updated", "last_modified") if about.get(key)), 0.0)
    if isinstance(when, str):
        when = datetime.fromisoformat(when.replace("Z", "+00:00"))
    if isinstance(when, datetime):
        return (when if when.tzinfo else when.replace(tzinfo=timezone.utc)).timestamp()
    return float(when)


def _within(folder: Path, path: str) -> Path:
    """A path inside the folder, whatever names the file system has."""
    place = folder.joinpath(*PurePosixPath(path).parts)
    if ".." in place.parts or not place.is_relative_to(folder):
        raise ValueError(f"{path}: leads out of the collection's folder")
    return place
