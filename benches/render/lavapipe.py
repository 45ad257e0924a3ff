"""WebGPU (wgpu-py) on a software Vulkan driver, Mesa's lavapipe, with a custom shader."""

import os

import answer
import numpy as np
import surroundings
import view
import wgpu
from PIL import Image

TARGET, DEPTH = "rgba8unorm-srgb", "depth32float"

# The same as llvmpipe's `ggx`; the target encodes sRGB.
SHADER = """
struct Scene {
    clip_from_world: mat4x4f, world_from_object: mat4x4f, eye: vec4f, light: vec4f, irradiance: array<vec4f, 9>
};
@group(0) @binding(0) var<uniform> s: Scene;
@group(0) @binding(1) var trilinear: sampler;
@group(0) @binding(2) var clamped: sampler;
@group(0) @binding(3) var albedo_map: texture_2d<f32>;
@group(0) @binding(4) var normal_map: texture_2d<f32>;
@group(0) @binding(5) var orm_map: texture_2d<f32>;
@group(0) @binding(6) var surround: texture_cube<f32>;
@group(0) @binding(7) var table: texture_2d<f32>;
struct Vertex {
    @builtin(position) clip: vec4f, @location(0) position: vec3f, @location(1) normal: vec3f,
    @location(2) tangent: vec4f, @location(3) uv: vec2f
};
@vertex fn vertex(
    @location(0) position: vec3f, @location(1) normal: vec3f, @location(2) tangent: vec4f, @location(3) uv: vec2f
) -> Vertex {
    var o: Vertex;
    let p = s.world_from_object * vec4f(position, 1);
    o.clip = s.clip_from_world * p;
    o.position = p.xyz;
    o.normal = (s.world_from_object * vec4f(normal, 0)).xyz;
    o.tangent = vec4f((s.world_from_object * vec4f(tangent.xyz, 0)).xyz, tangent.w);
    o.uv = uv;
    return o;
}
@fragment fn fragment(i: Vertex) -> @location(0) vec4f {
    let PI = 3.14159265;
    let m = textureSample(normal_map, trilinear, i.uv).xyz * 2 - 1;
    let albedo = textureSample(albedo_map, trilinear, i.uv).rgb;
    let orm = textureSample(orm_map, trilinear, i.uv).rgb;
    let n = normalize(i.tangent.xyz * m.x + cross(i.normal, i.tangent.xyz) * (i.tangent.w * m.y) + i.normal * m.z);
    let v = normalize(s.eye.xyz - i.position);
    let to_light = s.light.xyz - i.position;
    let squared = dot(to_light, to_light);
    let l = to_light * inverseSqrt(squared);
    let h = normalize(l + v);
    let e = s.light.w / squared;
    let nl = max(dot(n, l), 0.0); let nv = max(dot(n, v), 1e-3);
    let nh = max(dot(n, h), 0.0); let vh = max(dot(v, h), 1e-4);
    let grazing = 1 - vh; let grazing2 = grazing * grazing; let schlick = grazing2 * grazing2 * grazing;
    let roughness = clamp(orm.g, 0.04, 1.0); let alpha = roughness * roughness; let a2 = alpha * alpha;
    let f0 = mix(vec3f(0.04), albedo, orm.b); let diffuse = albedo * (1 - orm.b);
    let q = nh * nh * (a2 - 1) + 1; let d = a2 / (PI * q * q);
    let seen = 0.5 / (nl * sqrt(nv * nv * (1 - a2) + a2) + nv * sqrt(nl * nl * (1 - a2) + a2) + 1e-6);
    let f = f0 + (1 - f0) * schlick;
    var c = (diffuse * (1 - f) * (1 / PI) + f * (d * seen)) * (nl * e);
    let split = textureSample(table, clamped, vec2f(nv, roughness)).rg;
    let gathered = textureSampleLevel(surround, clamped, reflect(-v, n), roughness * LAST_LEVEL).rgb;
    let around = s.irradiance[0].xyz * 0.282095
        + 0.488603 * (s.irradiance[1].xyz * n.y + s.irradiance[2].xyz * n.z + s.irradiance[3].xyz * n.x)
        + 1.092548 * (s.irradiance[4].xyz * (n.x * n.y) + s.irradiance[5].xyz * (n.y * n.z))
        + 1.092548 * (s.irradiance[7].xyz * (n.x * n.z))
        + s.irradiance[6].xyz * (0.315392 * (3 * n.z * n.z - 1))
        + s.irradiance[8].xyz * (0.546274 * (n.x * n.x - n.y * n.y));
    c += (gathered * (f0 * split.x + split.y) + diffuse * max(around, vec3f(0)) * (1 / PI)) * orm.r;
    return vec4f(c, 1);
}
""".replace("LAST_LEVEL", f"{surroundings.LEVELS - 1}.0")

FORMATS = (("float32x3", 0), ("float32x3", 12), ("float32x4", 24), ("float32x2", 40))


def halved(texels):
    """All levels of a square image of bytes."""
    levels = [texels]
    while len(levels[-1]) > 1:
        a = levels[-1].astype(np.float32)
        mean = (a[::2, ::2] + a[1::2, ::2] + a[::2, 1::2] + a[1::2, 1::2]) / 4
        levels.append((mean + 0.5).astype(np.uint8))
    return levels


class Lavapipe:
    def __init__(self, folder, mesh):
        self.folder = folder
        adapters = [a for a in wgpu.gpu.enumerate_adapters_sync() if "llvmpipe" in a.info["device"]]
        if not adapters:
            raise SystemExit("lavapipe is not installed")
        self.adapter = adapters[0]
        self.device = self.adapter.request_device_sync()
        self.queue = self.device.queue
        vessel = np.load(os.path.join(folder, f"{mesh}.npz"))
        uvs = vessel["uvs"] * np.float32([1, -1]) + np.float32([0, 1])
        vertices = np.hstack([vessel["positions"], vessel["normals"], vessel["tangents"], uvs])
        self.vertices = self.device.create_buffer_with_data(data=vertices, usage=wgpu.BufferUsage.VERTEX)
        self.triangles = self.device.create_buffer_with_data(data=vessel["triangles"], usage=wgpu.BufferUsage.INDEX)
        self.corners = vessel["triangles"].size
        made = np.load(os.path.join(folder, "split-sum.npz"))
        self.irradiance = np.pad(made["irradiance"], ((0, 0), (0, 1)))
        usage = wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.COPY_DST
        self.uniforms = self.device.create_buffer(size=(16 + 16 + 4 + 4 + 36) * 4, usage=usage)
        self.pipeline = self.pipe()
        self.group = self.bound(made)
        self.size = None

    def pipe(self):
        module = self.device.create_shader_module(code=SHADER)
        attributes = [{"format": f, "offset": o, "shader_location": i} for i, (f, o) in enumerate(FORMATS)]
        layout = [{"array_stride": 48, "step_mode": "vertex", "attributes": attributes}]
        return self.device.create_render_pipeline(
            layout="auto",
            vertex={"module": module, "entry_point": "vertex", "buffers": layout},
            primitive={"topology": "triangle-list", "front_face": "ccw", "cull_mode": "back"},
            depth_stencil={"format": DEPTH, "depth_write_enabled": True, "depth_compare": "less"},
            fragment={"module": module, "entry_point": "fragment", "targets": [{"format": TARGET}]},
        )

    def texture(self, levels, form, layers=1):
        """`levels` of (layers, rows, columns, channels)."""
        side = levels[0].shape[1]
        usage = wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST
        size = (side, side, layers)
        texture = self.device.create_texture(size=size, mip_level_count=len(levels), format=form, usage=usage)
        for level, data in enumerate(levels):
            data = np.ascontiguousarray(data)
            count, rows, columns = data.shape[:3]
            place = {"texture": texture, "mip_level": level}
            lines = {"bytes_per_row": data.strides[1], "rows_per_image": rows}
            self.queue.write_texture(place, data, lines, (columns, rows, count))
        return texture

    def map(self, name):
        texels = np.array(Image.open(os.path.join(self.folder, f"{name}.png")).convert("RGBA"))
        form = TARGET if name == "albedo" else "rgba8unorm"
        return self.texture([level[None] for level in halved(texels)], form).create_view()

    def bound(self, made):
        linear = {"mag_filter": "linear", "min_filter": "linear", "mipmap_filter": "linear"}
        one = np.float16(1)
        opaque = ((0, 0), (0, 0), (0, 0), (0, 1))
        levels = [np.pad(made[f"level{i}"], opaque, constant_values=one) for i in range(surroundings.LEVELS)]
        cube = self.texture([level.astype(np.float16) for level in levels], "rgba16float", 6)
        table = self.texture([made["table"].astype(np.float16)[None]], "rg16float")
        resources = [
            {"buffer": self.uniforms, "offset": 0, "size": self.uniforms.size},
            self.device.create_sampler(**linear, address_mode_u="repeat", address_mode_v="clamp-to-edge"),
            self.device.create_sampler(**linear),
            *(self.map(name) for name in ("albedo", "normal", "orm")),
            cube.create_view(dimension="cube"),
            table.create_view(),
        ]
        entries = [{"binding": i, "resource": resource} for i, resource in enumerate(resources)]
        return self.device.create_bind_group(layout=self.pipeline.get_bind_group_layout(0), entries=entries)

    def resize(self, width, height):
        if self.size == (width, height, 1):
            return
        self.size = (width, height, 1)
        attached = wgpu.TextureUsage.RENDER_ATTACHMENT
        self.target = self.device.create_texture(
            size=self.size, format=TARGET, usage=attached | wgpu.TextureUsage.COPY_SRC
        )
        self.depth = self.device.create_texture(size=self.size, format=DEPTH, usage=attached).create_view()
        # WebGPU's depth is in [0, 1].
        halve = np.diag([1, 1, 0.5, 1])
        halve[2, 3] = 0.5
        self.clip_from_world = halve @ view.clip_from_world(width, height)

    def frame(self, angle):
        numbers = [self.clip_from_world.T.ravel(), view.turned(angle).T.ravel(), [*view.EYE, 1]]
        numbers += [[*view.LIGHT, view.INTENSITY], self.irradiance.ravel()]
        self.queue.write_buffer(self.uniforms, 0, np.concatenate(numbers).astype(np.float32))
        encoder = self.device.create_command_encoder()
        ground = tuple(view.linear(code) for code in view.BACKGROUND)
        color = {
            "view": self.target.create_view(),
            "clear_value": (*ground, 1),
            "load_op": "clear",
            "store_op": "store",
        }
        depth = {"view": self.depth, "depth_clear_value": 1.0, "depth_load_op": "clear", "depth_store_op": "discard"}
        drawing = encoder.begin_render_pass(color_attachments=[color], depth_stencil_attachment=depth)
        drawing.set_pipeline(self.pipeline)
        drawing.set_bind_group(0, self.group)
        drawing.set_vertex_buffer(0, self.vertices)
        drawing.set_index_buffer(self.triangles, "uint32")
        drawing.draw_indexed(self.corners)
        drawing.end()
        self.queue.submit([encoder.finish()])
        lines = {"bytes_per_row": self.size[0] * 4, "rows_per_image": self.size[1]}
        self.pixels = self.queue.read_texture({"texture": self.target}, lines, self.size)

    def picture(self):
        return np.frombuffer(self.pixels, np.uint8).reshape(self.size[1], self.size[0], 4)

    def about(self):
        return f"wgpu-py {wgpu.__version__}, {self.adapter.info['device']}, {self.adapter.info.get('description', '')}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["ggx"])
    answer.run(args, Lavapipe(args.folder, args.mesh))
