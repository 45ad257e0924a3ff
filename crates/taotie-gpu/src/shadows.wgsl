// Shadows: rays to the lights, with the renderer's origins and masks.

// A material with holes.
struct ShadowMask {
    // Width and height in texels; 0 without a texture.
    size: vec2i,
    // 0 repeats, 1 mirrors, 2 clamps.
    wrap: vec2u,
    // The index of the first texel in the opacities.
    texel: u32,
    // 1 to interpolate between four texels, 0 for the nearest.
    linear: u32,
    // The factor of all opacities.
    opacity: f32,
    // The minimum opacity at which the surface exists.
    cutoff: f32,
    // 1 if vertices have opacities; that of vertex i is at `color` + i, modulo 2^32.
    colored: u32,
    color: u32,
}

@group(0) @binding(9) var<storage, read> shadow_masks: array<ShadowMask>;
// Opacities of texels and vertices.
@group(0) @binding(10) var<storage, read> shadow_opacities: array<f32>;

// The origin of the rays from this pixel; w is 1 once it is known.
var<private> shadow_start: vec4f = vec4f(0.0);

// The visible fraction of a light at a position whose triangle has the unit normal `n`: 0 or 1.
fn visibility(light: i32, position: vec3f, n: vec3f) -> f32 {
    if (shadow_start.w == 0.0) {
        shadow_start = vec4f(shadow_origin(position, n), 1.0);
    }
    let origin = shadow_start.xyz;
    let place = lights[light].place;
    if (lights[light].kind == 0.0) {
        return ray_sight(cast_ray(origin, place, 3e38));
    }
    return ray_sight(cast_ray(origin, place - origin, 1.0));
}

// The point of the smooth surface above the triangle at `position`, moved a little along its normal. A shader does
// not know the corners of its triangle, so it searches for the nearest triangle along the normal.
// Source: Hanika 2021, "Hacking the Shadow Terminator".
fn shadow_origin(position: vec3f, n: vec3f) -> vec3f {
    let ray = cast_ray(position + n * SHADOW_REACH, -n, 2.0 * SHADOW_REACH);
    var origin = position + n * SHADOW_OFFSET;
    var nearest = SHADOW_REACH;
    var walk = RayWalk();
    for (var hit = ray_next(ray, &walk); hit.distance >= 0.0; hit = ray_next(ray, &walk)) {
        let away = abs(hit.distance - SHADOW_REACH);
        if (away < nearest) {
            nearest = away;
            origin = shadow_raised(ray_triangles[hit.place], hit.weights, n);
        }
    }
    return origin;
}

// The origin of rays from a point of a triangle, on the side that `n` points to.
fn shadow_raised(triangle: vec4u, weights: vec3f, n: vec3f) -> vec3f {
    let a = ray_vertices[triangle.x];
    let b = ray_vertices[triangle.y];
    let c = ray_vertices[triangle.z];
    let to_second = b.position - a.position;
    let to_third = c.position - a.position;
    let point = a.position + to_second * weights.y + to_third * weights.z;
    let front = normalize(cross(to_second, to_third));
    let side = select(1.0, -1.0, dot(front, n) < 0.0);
    let up = front * side;
    let shift = shadow_shift(point, a, side) * weights.x
        + shadow_shift(point, b, side) * weights.y
        + shadow_shift(point, c, side) * weights.z;
    // A surface seen from behind bulges away from the viewer: no shift.
    return point + select(vec3f(0.0), shift, dot(shift, up) > 0.0) + up * SHADOW_OFFSET;
}

// The offset from a point to the plane through a corner perpendicular to its normal, if that is above.
fn shadow_shift(point: vec3f, corner: RayVertex, side: f32) -> vec3f {
    let normal = corner.normal * side;
    return normal * -min(dot(point - corner.position, normal), 0.0);
}

// Returns true if the surface exists at a point of a triangle and casts a shadow. The last word of the triangle is 0 if
// it does, 1 if it does not, from 2 upwards the index of its mask plus 2.
fn ray_blocks(triangle: vec4u, weights: vec3f) -> bool {
    if (triangle.w < 2u) {
        return triangle.w == 0u;
    }
    let mask = shadow_masks[triangle.w - 2u];
    var opacity = mask.opacity;
    if (mask.size.x > 0) {
        let a = ray_vertices[triangle.x];
        let b = ray_vertices[triangle.y];
        let c = ray_vertices[triangle.z];
        let uv = vec2f(a.u, a.v) * weights.x + vec2f(b.u, b.v) * weights.y + vec2f(c.u, c.v) * weights.z;
        opacity *= shadow_sample(mask, uv);
    }
    if (mask.colored == 1u) {
        let corners = triangle.xyz + vec3u(mask.color);
        let colors = vec3f(
            shadow_opacities[corners.x],
            shadow_opacities[corners.y],
            shadow_opacities[corners.z],
        );
        opacity *= dot(colors, weights);
    }
    return opacity >= mask.cutoff;
}

// The opacity of a mask's texture, in its finest level.
fn shadow_sample(mask: ShadowMask, uv: vec2f) -> f32 {
    let place = vec2f(shadow_reduced(mask.wrap.x, uv.x), shadow_reduced(mask.wrap.y, uv.y)) * vec2f(mask.size);
    if (mask.linear == 0u) {
        return shadow_texel(mask, vec2i(floor(place)));
    }
    let low = floor(place - 0.5);
    let t = place - 0.5 - low;
    let i = vec2i(low);
    let top = mix(shadow_texel(mask, i), shadow_texel(mask, i + vec2i(1, 0)), t.x);
    let bottom = mix(shadow_texel(mask, i + vec2i(0, 1)), shadow_texel(mask, i + vec2i(1, 1)), t.x);
    return mix(top, bottom, t.y);
}

// An equivalent texture coordinate near [0, 2].
fn shadow_reduced(wrap: u32, u: f32) -> f32 {
    if (wrap == 0u) {
        return u - floor(u);
    }
    if (wrap == 1u) {
        return u - 2.0 * floor(u * 0.5);
    }
    return clamp(u, -1.0, 2.0);
}

fn shadow_texel(mask: ShadowMask, i: vec2i) -> f32 {
    let x = shadow_wrapped(mask.wrap.x, i.x, mask.size.x);
    let y = shadow_wrapped(mask.wrap.y, i.y, mask.size.y);
    return shadow_opacities[mask.texel + u32(y * mask.size.x + x)];
}

// The index of a texel in [0, size).
fn shadow_wrapped(wrap: u32, i: i32, size: i32) -> i32 {
    if (wrap == 2u) {
        return clamp(i, 0, size - 1);
    }
    let period = select(size, 2 * size, wrap == 1u);
    let within = ((i % period) + period) % period;
    return min(within, 2 * size - 1 - within);
}
