"""Programs installed by npm."""

import dataclasses
import hashlib
import json
import os


@dataclasses.dataclass(frozen=True)
class Folder:
    """A folder with `package-lock.json` and `node_modules`."""

    path: str

    def program(self, name):
        return os.path.join(self.path, "node_modules", ".bin", name)

    def identity(self):
        """A hash of the versions of all packages."""
        with open(os.path.join(self.path, "package-lock.json"), "rb") as file:
            return hashlib.sha256(file.read()).hexdigest()

    def version(self, package):
        with open(os.path.join(self.path, "node_modules", package, "package.json"), encoding="utf-8") as file:
            return json.load(file)["version"]
