"""The measured cases: commands on generated or shared files."""

import functools
import os
import random
import shutil

import models
import pictures
from models import Gltf

INSPECT, RENDER = "inspect {}", "render {} -o out.png --size 512"
BAKE = "bake {} -o out.glb --size 512 --triangles 2000"
COMPARE = "compare {} --method facet,smooth --size 512 -o out"
DIFF = "diff {0} {0}"
MODELS, PICTURES = (".gltf", ".glb", ".obj", ".ply", ".stl"), (".png", ".jpg", ".jpeg", ".webp", ".tga", ".hdr", ".exr")

K = 1024


class Case:
    """A file, how to generate it if it is not shared, and the commands that read it."""

    def __init__(self, name, commands, make=None, path=None):
        self.name, self.commands, self.make, self.path = name, commands, make, path or name


def square(write, name, side, **options):
    """An image; the file is generated in the folder in which commands run."""
    return functools.partial(write, name, (side, side), **options)


def picture_cases():
    """Individual images, as maps of glTF and OBJ, and as environments."""
    kinds = [
        ("png-1bit", "png", pictures.png, {"color": 0, "bits": 1}, [4, 8, 16]),
        ("png-grey", "png", pictures.png, {"color": 0}, [4, 8]),
        ("png-palette", "png", pictures.png, {"color": 3}, [4, 8]),
        ("png-rgb", "png", pictures.png, {}, [1, 2, 4, 8, 16]),
        ("png-rgba", "png", pictures.png, {"color": 6}, [4, 8]),
        ("png-16", "png", pictures.png, {"bits": 16}, [2, 4, 8]),
        ("png-grey-16", "png", pictures.png, {"color": 0, "bits": 16}, [4]),
        ("png-interlaced", "png", pictures.png, {"interlaced": True}, [4, 8]),
        ("png-interlaced-rgba-16", "png", pictures.png, {"color": 6, "bits": 16, "interlaced": True}, [4]),
        ("jpeg", "jpg", pictures.jpeg, {}, [2, 4, 8, 16]),
        ("jpeg-420", "jpg", pictures.jpeg, {"samplings": (0x22, 0x11, 0x11)}, [4, 8]),
        ("jpeg-grey", "jpg", pictures.jpeg, {"samplings": (0x11,)}, [8]),
        ("jpeg-progressive", "jpg", pictures.jpeg, {"kind": "progressive"}, [4, 8]),
        ("jpeg-progressive-420", "jpg", pictures.jpeg, {"kind": "progressive", "samplings": (0x22, 0x11, 0x11)}, [4, 8]),
        ("jpeg-progressive-grey", "jpg", pictures.jpeg, {"kind": "progressive", "samplings": (0x11,)}, [8]),
        ("jpeg-scans", "jpg", pictures.jpeg, {"kind": "scans"}, [4, 8]),
        ("webp", "webp", pictures.webp, {}, [2, 4, 8]),
        ("ktx2", "ktx2", pictures.ktx2, {}, [2, 4, 8]),
        ("tga", "tga", pictures.tga, {}, [4, 8]),
        ("tga-rgba", "tga", pictures.tga, {"channels": 4}, [4]),
        ("hdr", "hdr", pictures.hdr, {}, [2, 4]),
        ("exr", "exr", pictures.exr, {}, [2, 4, 8]),
        ("exr-float", "exr", pictures.exr, {"is_half": False}, [4]),
        ("exr-64-channels", "exr", pictures.exr, {"channels": [f"c{i:02}" for i in range(61)] + ["R", "G", "B"]}, [2, 4]),
    ]
    for name, ending, write, options, sides in kinds:
        for side in sides:
            yield from of_picture(f"{name}-{side}k.{ending}", square(write, f"{name}-{side}k.{ending}", side * K, **options), side)
    for height in (1, 2, 4):
        for ending, write in (("hdr", pictures.hdr), ("exr", pictures.exr)):
            name = f"sky-{height}k.{ending}"
            make = functools.partial(write, name, (2 * height * K, height * K))
            yield Case(name, [f"render ball.obj -o out.png --size 512 --env {name}"], make)


def of_picture(name, make, side):
    if name == "png-rgb-2k.png":
        yield Case(name, [DIFF] + [f"{DIFF} --metric {metric}" for metric in ("flip", "ssim", "psnr", "rmse")], make)
    elif side <= 2 or name == "png-rgb-4k.png":
        yield Case(name, [DIFF], make)
    textured = name + ".gltf" if name.endswith(("png", "jpg", "webp", "ktx2")) else name + ".obj"

    def with_model():
        make()
        if textured.endswith(".obj"):
            models.obj(textured, 8, texture=name)
        else:
            Gltf(8).textured([name]).write(textured)

    yield Case(textured, [INSPECT] if side > 8 else [INSPECT, RENDER], with_model)


def with_png(side, build, **options):
    """A function that writes glTF with one PNG."""
    def make():
        pictures.png("map.png", (side, side), **options)
        build()
    return make


def shared_picture_cases():
    """One image in several roles, many images from one file, many files."""
    meanings = {
        "two": ["baseColorTexture", "metallicRoughnessTexture"],
        "normal": ["baseColorTexture", "normalTexture"], "all": models.MEANINGS,
    }
    for side in (2, 4):
        for title, chosen in meanings.items():
            name = f"meanings-{title}-{side}k.gltf"
            build = lambda name=name, chosen=chosen: Gltf(8).textured(["map.png"], chosen).write(name)
            yield Case(name, [INSPECT, RENDER], with_png(side * K, build))
    for side, bits in ((2, 8), (4, 8), (16, 1)):
        name = f"twenty-images-of-one-{side}k.gltf"
        build = lambda name=name: Gltf(2).textured(["map.png"], copies=20).write(name)
        options = {"color": 0, "bits": bits} if bits == 1 else {}
        yield Case(name, [INSPECT, RENDER], with_png(side * K, build, **options))
    for count, side in ((20, 1), (60, 1), (20, 2), (60, 2), (60, 4)):
        name = f"{count}-images-{side}k.gltf"

        def make(name=name, count=count, side=side):
            uris = [f"map{i}.png" for i in range(count)]
            pictures.png(uris[0], (side * K, side * K))
            for uri in uris[1:]:
                shutil.copy(uris[0], uri)
            Gltf(2).textured(uris).write(name)

        yield Case(name, [INSPECT, RENDER], make)
    for kind, write in (("png", pictures.png), ("jpeg", pictures.jpeg), ("webp", pictures.webp)):
        name = f"embedded-{kind}-4k.gltf"

        def make(name=name, kind=kind, write=write):
            write("picture", (4 * K, 4 * K))
            Gltf(8).textured([models.embedded("picture", kind)]).write(name)

        yield Case(name, [INSPECT, RENDER], make)


def geometry_cases():
    """Large meshes in all formats."""
    shadows = RENDER + " --shadows --ground"
    kinds = [
        ("obj", "obj", models.obj, {}), ("obj-uv", "obj", models.obj, {"has_uvs": True}),
        ("ply", "ply", models.ply, {}), ("ply-ascii", "ply", models.ply, {"is_ascii": True}),
        ("ply-colors", "ply", models.ply, {"has_colors": True}),
        ("stl", "stl", models.stl, {}), ("stl-ascii", "stl", models.stl, {"is_ascii": True}),
    ]
    for title, ending, write, options in kinds:
        for side in (200, 500, 1000):
            name = f"{title}-{side}.{ending}"
            commands = [INSPECT, RENDER, shadows] + [BAKE] * (side <= 500)
            yield Case(name, commands, functools.partial(write, name, side, **options))
    for count in (200_000, 1_000_000):
        name = f"soup-{count}.stl"
        yield Case(name, [INSPECT, RENDER], functools.partial(models.soup, name, count))
    name = "soup-ascii-1000000.stl"
    yield Case(name, [INSPECT, RENDER], functools.partial(models.ascii_soup, name, 1_000_000))
    for side in (200, 500, 1000):
        for ending, is_embedded in (("glb", False), ("gltf", False), ("gltf", True)):
            name = f"grid-{side}{'-embedded' * is_embedded}.{ending}"
            make = lambda name=name, side=side, is_embedded=is_embedded: Gltf(side).write(name, is_embedded)
            yield Case(name, [INSPECT, RENDER, shadows] + [BAKE] * (side <= 500), make)
    for side in (200, 700):
        name = f"no-normals-{side}.glb"
        yield Case(name, [INSPECT, RENDER], lambda name=name, side=side: Gltf(side, False).write(name))
    for count, side in ((10_000, 8), (100_000, 1), (1_000_000, 1), (30, 300), (200, 100)):
        name = f"instances-{count}-of-{2 * side * side}.gltf"
        make = lambda name=name, count=count, side=side: Gltf(side).repeated(count).write(name)
        yield Case(name, [INSPECT, RENDER, shadows] + [BAKE] * (count < 1000), make)
    for count in (10_000, 200_000):
        name = f"materials-{count}.gltf"
        yield Case(name, [INSPECT], lambda name=name, count=count: Gltf().with_materials(count).write(name))
        name = f"extras-{count}.gltf"
        yield Case(name, [INSPECT], lambda name=name, count=count: Gltf().with_extras(10 * count).write(name))
    for side in (300, 700):
        name = f"normal-mapped-{side}.glb"
        build = lambda name=name, side=side: Gltf(side).textured(["map.png"], models.MEANINGS[:3]).write(name)
        yield Case(name, [INSPECT, RENDER, BAKE], with_png(2 * K, build))


def work_cases():
    """Large renders, comparisons and maps of a small model."""
    lines = [f"render ball.obj -o out.png --size {size}" for size in (1024, 2048, 4096, 8192)]
    lines += [f"render ball.obj -o out.png --size {size} --aov normals,depth" for size in (1024, 2048, 4096)]
    lines += [f"render ball.obj -o out.exr --size {size}" for size in (2048, 4096)]
    lines += ["render ball.obj -o out.png --size 2048 --bits 16", "render ball.obj -o out.gif --size 1024 --turntable 3"]
    lines += ["render ball.obj -o out.png --size 2048 --integrator reference --spp 1"]
    lines += ["render ball.obj -o out.png --size 2048 --env studio"]
    lines += ["render ball.obj -o out.png --size 2048 --samples 16 --shadows --ground"]
    lines += [f"compare ball.obj --method facet,smooth --size {size} -o out" for size in (512, 1024, 2048)]
    lines += ["compare ball.obj --method facet,smooth --shading ggx,phong,lambert --size 1024 -o out"]
    lines += [f"bake ball.obj -o out.glb --triangles 500 --size {size}" for size in (1024, 2048, 4096)]
    lines += ["bake ball.obj -o out.glb --triangles 500 --size 2048 --maps normal,ao,bent,curvature --ao-rays 4"]
    lines += ["bake ball.obj -o out.glb --triangles 500 --size 2048 --images ktx2"]
    lines += ["bake ball.obj -o out.glb --triangles 500 --size 2048 --images webp"]
    lines += ["bake ball.obj -o out.glb --triangles 5000 --size 1024 --meshopt --lods 2000,500"]
    for i, line in enumerate(lines):
        yield Case(f"ball-{i}", [line])


def shared_cases(data, most):
    """A selection of the shared files: the largest, and others at random."""
    found = []
    for root, folders, names in os.walk(data):
        folders.sort()
        found += [os.path.join(root, name) for name in sorted(names) if name.lower().endswith(MODELS + PICTURES)]
    size = lambda path: -os.path.getsize(path)
    by_chance = random.Random(1)
    for endings, share in ((MODELS, 0.7), (PICTURES, 0.3)):
        those = sorted((path for path in found if path.lower().endswith(endings)), key=size)
        largest = those[:int(most * share / 2)]
        rest = those[len(largest):]
        chosen = largest + by_chance.sample(rest, min(len(rest), int(most * share / 2)))
        for i, path in enumerate(chosen):
            if endings is PICTURES:
                commands = [DIFF]
            else:
                commands = [INSPECT, RENDER] + [BAKE, COMPARE][i % 2:][:1] * (i < len(largest))
            yield Case(os.path.relpath(path, data), commands, path=path)


def cases(data, most):
    """All cases, with at most `most` shared files."""
    yield from work_cases()
    yield from shared_picture_cases()
    yield from geometry_cases()
    yield from picture_cases()
    if data and os.path.isdir(data):
        yield from shared_cases(data, most)
