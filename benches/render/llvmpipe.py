"""OpenGL on Mesa's llvmpipe with custom shaders, without a window: the fastest of the peers."""

import ctypes
import os

import answer
import moderngl
import numpy as np
import surroundings
import view
from PIL import Image

SRGB8_ALPHA8 = 0x8C43
CUBE_MAP, CUBE_FACE, RGB, FLOAT, UNPACK_ALIGNMENT = 0x8513, 0x8515, 0x1907, 0x1406, 0x0CF5

VERTEX = """
#version 330
in vec3 positions; in vec3 normals; in vec4 tangents; in vec2 uvs;
uniform mat4 clip_from_world, world_from_object;
out vec3 position, normal; out vec4 tangent; out vec2 uv;
void main() {
    vec4 p = world_from_object * vec4(positions, 1.0);
    mat3 turn = mat3(world_from_object);
    position = p.xyz; normal = turn * normals; tangent = vec4(turn * tangents.xyz, tangents.w); uv = uvs;
    gl_Position = clip_from_world * p;
}"""

# Everything up to the angles is the same for both.
HEAD = """
#version 330
in vec3 position, normal; in vec4 tangent; in vec2 uv;
out vec4 color;
uniform sampler2D albedo_map, normal_map, orm_map, table;
uniform samplerCube surround;
uniform vec3 irradiance[9], eye, light; uniform float intensity;
const float PI = 3.14159265;
vec3 srgb(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
void main() {
    vec3 m = texture(normal_map, uv).xyz * 2.0 - 1.0;
    vec3 n = normalize(tangent.xyz * m.x + cross(normal, tangent.xyz) * (tangent.w * m.y) + normal * m.z);
    vec3 v = normalize(eye - position), to_light = light - position;
    float squared = dot(to_light, to_light);
    vec3 l = to_light * inversesqrt(squared), h = normalize(l + v);
    float e = intensity / squared;
    float nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-3), nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 1e-4);
    vec3 albedo = texture(albedo_map, uv).rgb;
    float grazing = 1.0 - vh, grazing2 = grazing * grazing, schlick = grazing2 * grazing2 * grazing;
"""

# Beckmann, V-shaped grooves, Schlick, for a bare metal.
COOK_TORRANCE = """
    const float SLOPE2 = SLOPE * SLOPE;
    float c2 = nh * nh;
    float d = exp((c2 - 1.0) / max(c2 * SLOPE2, 1e-6)) / (PI * SLOPE2 * c2 * c2 + 1e-7);
    float g = min(1.0, 2.0 * nh * min(nv, nl) / vh);
    vec3 f = albedo + (1.0 - albedo) * schlick;
    vec3 c = f * (d * g / (4.0 * nv) * e) + albedo * AMBIENT;
"""

# glTF's metallic-roughness model; the environment by the split sum and spherical harmonics.
GGX = """
    vec3 orm = texture(orm_map, uv).rgb;
    float roughness = clamp(orm.g, 0.04, 1.0), alpha = roughness * roughness, a2 = alpha * alpha;
    vec3 f0 = mix(vec3(0.04), albedo, orm.b), diffuse = albedo * (1.0 - orm.b);
    float q = nh * nh * (a2 - 1.0) + 1.0;
    float d = a2 / (PI * q * q);
    float seen = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-6);
    vec3 f = f0 + (1.0 - f0) * schlick;
    vec3 c = (diffuse * (1.0 - f) * (1.0 / PI) + f * (d * seen)) * (nl * e);
    vec2 split = texture(table, vec2(nv, roughness)).rg;
    vec3 mirrored = textureLod(surround, reflect(-v, n), roughness * LAST_LEVEL).rgb * (f0 * split.x + split.y);
    vec3 around = irradiance[0] * 0.282095
        + 0.488603 * (irradiance[1] * n.y + irradiance[2] * n.z + irradiance[3] * n.x)
        + 1.092548 * (irradiance[4] * (n.x * n.y) + irradiance[5] * (n.y * n.z) + irradiance[7] * (n.x * n.z))
        + irradiance[6] * (0.315392 * (3.0 * n.z * n.z - 1.0))
        + irradiance[8] * (0.546274 * (n.x * n.x - n.y * n.y));
    c += (mirrored + diffuse * max(around, 0.0) * (1.0 / PI)) * orm.r;
"""

TAIL = " color = vec4(srgb(c), 1.0); }"


def fragment(shading):
    body = {"cook-torrance": COOK_TORRANCE, "ggx": GGX}[shading]
    numbers = {"SLOPE *": f"{view.SLOPE} *", "* SLOPE;": f"* {view.SLOPE};", "AMBIENT": str(view.AMBIENT)}
    numbers["LAST_LEVEL"] = f"{surroundings.LEVELS - 1}.0"
    for name, number in numbers.items():
        body = body.replace(name, number)
    return (HEAD + body + TAIL).strip()


class Llvmpipe:
    def __init__(self, folder, mesh, shading):
        self.folder = folder
        self.context = moderngl.create_context(standalone=True, backend="egl")
        self.program = self.context.program(vertex_shader=VERTEX.strip(), fragment_shader=fragment(shading))
        self.textures = []
        self.vertices = self.upload(np.load(os.path.join(folder, f"{mesh}.npz")))
        for name in ("albedo", "normal", "orm"):
            if f"{name}_map" in self.program:
                self.bind(f"{name}_map", self.map(name))
        if "surround" in self.program:
            self.surround()
        for name, value in (("eye", view.EYE), ("light", view.LIGHT), ("intensity", view.INTENSITY)):
            self.program[name].value = value
        self.context.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self.size = None

    def upload(self, mesh):
        names = ("positions", "normals", "tangents", "uvs")
        interleaved = self.context.buffer(np.hstack([mesh[name] for name in names]).tobytes())
        triangles = self.context.buffer(mesh["triangles"].tobytes())
        return self.context.vertex_array(self.program, [(interleaved, "3f 3f 4f 2f", *names)], triangles)

    def bind(self, uniform, texture):
        texture.use(len(self.textures))
        self.program[uniform].value = len(self.textures)
        self.textures.append(texture)

    def map(self, name):
        """Trilinear, with the first row of texels at the bottom."""
        picture = Image.open(os.path.join(self.folder, f"{name}.png")).convert("RGBA")
        texels = picture.transpose(Image.Transpose.FLIP_TOP_BOTTOM).tobytes()
        kind = SRGB8_ALPHA8 if name == "albedo" else None
        texture = self.context.texture(picture.size, 4, texels, internal_format=kind)
        texture.build_mipmaps()
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        texture.repeat_x, texture.repeat_y = True, False
        return texture

    def surround(self):
        made = np.load(os.path.join(self.folder, "split-sum.npz"))
        side = surroundings.CUBE
        cube = self.context.texture_cube((side, side), 3, made["level0"].astype("f2").tobytes(), dtype="f2")
        cube.build_mipmaps()
        gl = ctypes.CDLL("libGL.so.1")  # moderngl only writes the first level of a cube
        gl.glBindTexture(CUBE_MAP, cube.glo)
        gl.glPixelStorei(UNPACK_ALIGNMENT, 1)
        for level in range(1, surroundings.LEVELS):
            for face, texels in enumerate(np.ascontiguousarray(made[f"level{level}"])):
                size, data = side >> level, texels.ctypes.data_as(ctypes.c_void_p)
                gl.glTexSubImage2D(CUBE_FACE + face, level, 0, 0, size, size, RGB, FLOAT, data)
        cube.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        self.bind("surround", cube)
        table = self.context.texture(made["table"].shape[:2], 2, made["table"].astype("f2").tobytes(), dtype="f2")
        table.repeat_x = table.repeat_y = False
        self.bind("table", table)
        self.program["irradiance"].write(made["irradiance"].tobytes())

    def resize(self, width, height):
        if self.size == (width, height):
            return
        self.size = (width, height)
        color = self.context.texture(self.size, 4)
        self.target = self.context.framebuffer([color], self.context.depth_renderbuffer(self.size))
        self.target.use()
        self.program["clip_from_world"].write(view.clip_from_world(width, height).T.astype("f4").tobytes())
        self.pixels = np.empty((height, width, 4), np.uint8)

    def frame(self, angle):
        self.program["world_from_object"].write(view.turned(angle).T.astype("f4").tobytes())
        self.target.clear(*(code / 255 for code in view.BACKGROUND), 1.0)
        self.vertices.render()
        self.target.read_into(self.pixels, components=4)

    def picture(self):
        return self.pixels[::-1]

    def about(self):
        return f"{self.context.info['GL_RENDERER']}, {self.context.info['GL_VERSION']}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["cook-torrance", "ggx"])
    answer.run(args, Llvmpipe(args.folder, args.mesh, args.shading))
