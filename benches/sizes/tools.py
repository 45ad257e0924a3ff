"""The programs that make assets, and their settings."""

import dataclasses
import os

import hashes
import measure

# Placeholders in the words of a command.
SOURCE, OUT = "MODEL", "OUT.glb"
HERE = os.path.dirname(os.path.abspath(__file__))


@dataclasses.dataclass(frozen=True)
class Tool:
    """A program; `identity` changes with its version, and `words` are its command without options."""

    name: str
    identity: str
    words: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Setting:
    """One way to make an asset: a tool with options, applied to the result of `before` or else to the model."""

    tool: Tool
    options: tuple[str, ...] = ()
    before: "Setting | None" = None

    def command(self, source, out):
        """The command line that makes `out` from `source`."""
        return [{SOURCE: source, OUT: out}.get(word, word) for word in self.tool.words] + list(self.options)

    def label(self):
        """A readable label: `-si 0.5 after WebP 512 75`."""
        own = " ".join(self.options) or "no options"
        return own if self.before is None else f"{own} after {self.before.tool.name} {self.before.label()}"

    def identity(self):
        """Equal for equal assets of one model, wherever the programs are installed."""
        before = self.before and self.before.identity()
        return hashes.of_value([self.tool.name, self.tool.identity, self.options, before])


@dataclasses.dataclass(frozen=True)
class Tools:
    """The tools that are compared; `webp` only prepares textures."""

    taotie: Tool
    gltfpack: Tool
    gltf_transform: Tool
    webp: Tool


def installed(taotie, node):
    """The tools, with `taotie` at this path and the others from the folder of npm."""
    return Tools(baker(taotie), packer(node), transformer(node), texture_encoder(node))


def baker(program):
    return Tool("taotie", hashes.of_files(program), (program, "bake", SOURCE, "-o", OUT, "--no-verify"))


def packer(node):
    """gltfpack with the strongest compression of EXT_meshopt_compression, which Taotie also writes."""
    return Tool("gltfpack", node.version("gltfpack"), (node.program("gltfpack"), "-i", SOURCE, "-o", OUT, "-cc"))


def transformer(node):
    words = (node.program("gltf-transform"), "optimize", SOURCE, OUT, "--texture-compress", "webp")
    return Tool("gltf-transform", node.identity(), words)


def texture_encoder(node):
    """Its options are the largest side in texels, or 0, and the quality."""
    script = os.path.join(HERE, "textures.mjs")
    identity = hashes.of_value([node.identity(), hashes.of_files(script)])
    return Tool("WebP", identity, ("node", script, node.path, SOURCE, OUT))


def versions(node):
    """The versions of the programs from npm, as reported by them."""
    transform = measure.run([node.program("gltf-transform"), "--version"]).output.strip()
    return f"{measure.run([node.program('gltfpack'), '-v']).output.strip()}; gltf-transform {transform}"
