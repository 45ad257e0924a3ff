"""The three scenes, as arrays from which the GLB for Taotie and the scene of Mitsuba are both made.

Camera and light are those of view.py. The materials are those for which both programs agree by definition: metal that
reflects everything (F0 is 1, so that Fresnel's term does not matter) as GGX without light between its facets, and
Lambertian surfaces.
"""

import dataclasses

import bodies
import files
import staging


@dataclasses.dataclass(frozen=True)
class Scene:
    """`bounces` are reflections of light after the first. Light comes from the environment or from the lamp."""

    name: str
    title: str
    bodies: callable
    bounces: int = 0
    environment: bool = False


SCENES = {
    scene.name: scene
    for scene in (
        Scene("metal", "metal under an environment, direct light", bodies.metal, environment=True),
        Scene("room", "metal in a closed room, five reflections", bodies.room, bounces=4),
        Scene("relief", "relief of 360,000 triangles in a lamp's light and shadow", bodies.relief),
    )
}


def material(body):
    """The material of a body as glTF."""
    metal = {"baseColorFactor": [*body.color, 1.0], "metallicFactor": 1.0, "roughnessFactor": body.roughness}
    if body.roughness:
        return {"pbrMetallicRoughness": metal}
    matte = metal | {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    no_gloss = {"KHR_materials_specular": {"specularFactor": 0.0}}
    return {"pbrMetallicRoughness": matte, "doubleSided": True, "extensions": no_gloss}


def write(path, scene):
    """Writes the scene as GLB."""
    parts = []
    for body in scene.bodies():
        attributes = {"POSITION": body.positions, "NORMAL": body.normals}
        parts.append((attributes, body.triangles, material(body)))
    extra = staging.camera_and_lights(0 if scene.environment else 1)
    extra["extensionsUsed"] = [*extra["extensionsUsed"], "KHR_materials_specular"]
    files.write_parts(path, parts, extra=extra)
