"""Libraries in the programs and wheels that are not crates: C and C++ within crates, scripts of pages, what is linked."""

from __future__ import annotations

import html
import importlib.metadata
import json
import re
from dataclasses import dataclass
from pathlib import Path

import place
import toolchain
from packages import Package


@dataclass(frozen=True)
class Vendored:
    """A library within a crate: which file has its version, in which numbers, and which has its licence."""

    name: str
    crate: str
    licence: str
    file: str
    version: str
    text: str


VENDORED = (
    Vendored("libwebp", "libwebp-sys", "BSD-3-Clause", "vendor/src/dec/vp8i_dec.h", r"define DEC_\w+_VERSION (\d+)", "vendor/COPYING"),
    Vendored("zstd", "zstd-sys", "BSD-3-Clause", "zstd/lib/zstd.h", r"define ZSTD_VERSION_(?:MAJOR|MINOR|RELEASE) +(\d+)", "zstd/LICENSE"),
    Vendored("meshoptimizer", "meshopt", "MIT", "vendor/src/meshoptimizer.h", r"define MESHOPTIMIZER_VERSION \d+ /\* ([\d.]+)",
             "vendor/src/meshoptimizer.h"),
    Vendored("mimalloc", "libmimalloc-sys", "MIT", "c_src/mimalloc/v3/include/mimalloc.h", r"define MI_MALLOC_VERSION (\d)(\d\d)(\d\d)",
             "c_src/mimalloc/v3/LICENSE"),
)


@dataclass(frozen=True)
class Script:
    """A library that scripts contain: its project, and the file of its licence in dist/licences."""

    name: str
    project: str
    text: str


# The viewer's script, and those of the packages with the command as WebAssembly.
SCRIPTS = (Script("three", "viewer", "three.txt"), Script("@bjorn3/browser_wasi_shim", "npm/taotie-wasm", "browser_wasi_shim.txt"))
# musl, libc++ and libunwind come with Zig.
OF_ZIG = ("libc/musl/COPYRIGHT", "libcxx/LICENSE.TXT", "libunwind/LICENSE.TXT")


def all_of(crates: list[Package]) -> list[Package]:
    """Return the libraries."""
    folders = {crate.name: crate.folder for crate in crates}
    return [vendored(library, folders[library.crate]) for library in VENDORED] + [*map(script, SCRIPTS), *linked()]


def vendored(library: Vendored, folder: Path) -> Package:
    found = re.findall(library.version, (folder / library.file).read_text(encoding="utf-8"))
    numbers = found[0] if found and isinstance(found[0], tuple) else found
    if not numbers:
        raise SystemExit(f"make dist: {folder / library.file} does not state the version of {library.name}: correct dist/libraries.py")
    version = ".".join(number if "." in number else str(int(number)) for number in numbers)
    url = f"pkg:generic/{library.name}@{version}"
    return Package(library.name, version, library.licence, url, texts=[licence_in(folder / library.text)])


def licence_in(path: Path) -> str:
    """Return the text of a licence file, or the last comment of a source file."""
    text = path.read_text(encoding="utf-8")
    return text if path.suffix != ".h" else re.sub(r"(?m)^ \* ?", "", text[text.rindex("/**") + 3 : text.rindex("*/")]).strip()


def script(library: Script) -> Package:
    """Return a library, as the lock file of its project states it."""
    lock = json.loads((place.ROOT / library.project / "package-lock.json").read_text())["packages"][f"node_modules/{library.name}"]
    text = (place.ROOT / "dist/licences" / library.text).read_text(encoding="utf-8")
    return Package(library.name, lock["version"], lock["license"], f"pkg:npm/{library.name.replace('@', '%40')}@{lock['version']}", texts=[text])


def linked() -> list[Package]:
    """Return what the compilers link into programs: the standard libraries of Rust, C and C++."""
    rust = re.search(r"release: (\S+)", toolchain.output(["rustc", "-vV"]))[1]
    notices = (toolchain.sysroot() / "share/doc/rust/COPYRIGHT-library.html").read_text(encoding="utf-8")
    plain = re.sub(r"\s*\n\s*\n\s*", "\n\n", html.unescape(re.sub(r"<[^>]*>", "", notices)))
    zig = importlib.metadata.distribution("ziglang")
    texts = [Path(zig.locate_file(f"ziglang/lib/{name}")).read_text(encoding="utf-8") for name in OF_ZIG]
    return [
        Package("rust-std", rust, "MIT OR Apache-2.0", f"pkg:generic/rust-std@{rust}", texts=[plain.strip()]),
        Package("ziglang", zig.version, "MIT AND (Apache-2.0 WITH LLVM-exception)", f"pkg:pypi/ziglang@{zig.version}", texts=texts),
    ]
