// Shadows: rays to the lights through the boxes of all triangles, with the renderer's origins, boxes and masks.

// A box. The boxes inside it follow it; `skip` is the index of the next box outside it. In a leaf, the low four bits
// of `leaf` are the number of its triangles, and the others the index of the first. After the last box comes one
// whose `skip` is 0, since Mesa's lavapipe 22.3 reports an `arrayLength` larger than the list.
struct ShadowBox {
    low: vec3f,
    skip: u32,
    high: vec3f,
    leaf: u32,
}

// A corner of triangles. `u` and `v` are coordinates in the texture that cuts holes.
struct ShadowVertex {
    position: vec3f,
    u: f32,
    // Unit.
    normal: vec3f,
    v: f32,
}

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

// A ray, `limit` times as long as its direction. `axis` is its dominant axis, which comes last in the coordinates in
// which `shear` maps the ray to the last axis.
// Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection".
struct ShadowRay {
    origin: vec3f,
    inverse: vec3f,
    limit: f32,
    axis: u32,
    shear: vec3f,
}

// A point of a triangle: the weights of its corners, and its distance, below 0 if the ray misses the triangle.
struct ShadowHit {
    weights: vec3f,
    distance: f32,
}

@group(0) @binding(6) var<storage, read> shadow_boxes: array<ShadowBox>;
// Three corners, counter-clockwise as seen from the front, and the shadow word: 0 casts a shadow, 1 does not, from 2
// upwards the index of its mask plus 2.
@group(0) @binding(7) var<storage, read> shadow_triangles: array<vec4u>;
@group(0) @binding(8) var<storage, read> shadow_vertices: array<ShadowVertex>;
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
        return shadow_sight(shadow_ray(origin, place, 3e38));
    }
    return shadow_sight(shadow_ray(origin, place - origin, 1.0));
}

// The index of the first box from `start` onwards that the ray enters and that contains triangles; the end's if there
// is none.
fn shadow_leaf(ray: ShadowRay, start: u32) -> u32 {
    var index = start;
    loop {
        let around = shadow_boxes[index];
        if (around.skip == 0u) {
            break;
        }
        if (!shadow_enters(around, ray)) {
            index = around.skip;
            continue;
        }
        if ((around.leaf & 15u) != 0u) {
            break;
        }
        index++;
    }
    return index;
}

// 1 if nothing blocks the ray, else 0.
fn shadow_sight(ray: ShadowRay) -> f32 {
    var index = 0u;
    loop {
        index = shadow_leaf(ray, index);
        let around = shadow_boxes[index];
        if (around.skip == 0u) {
            break;
        }
        index++;
        let first = around.leaf >> 4u;
        for (var place = first; place < first + (around.leaf & 15u); place++) {
            let triangle = shadow_triangles[place];
            let hit = shadow_hit(triangle, ray);
            if (hit.distance >= 0.0 && hit.distance < ray.limit && shadow_blocks(triangle, hit.weights)) {
                return 0.0;
            }
        }
    }
    return 1.0;
}

// The point of the smooth surface above the triangle at `position`, moved a little along its normal. A shader does
// not know the corners of its triangle, so it searches for the nearest triangle along the normal.
// Source: Hanika 2021, "Hacking the Shadow Terminator".
fn shadow_origin(position: vec3f, n: vec3f) -> vec3f {
    let ray = shadow_ray(position + n * SHADOW_REACH, -n, 2.0 * SHADOW_REACH);
    var origin = position + n * SHADOW_OFFSET;
    var nearest = SHADOW_REACH;
    var index = 0u;
    loop {
        index = shadow_leaf(ray, index);
        let around = shadow_boxes[index];
        if (around.skip == 0u) {
            break;
        }
        index++;
        let first = around.leaf >> 4u;
        for (var place = first; place < first + (around.leaf & 15u); place++) {
            let triangle = shadow_triangles[place];
            let hit = shadow_hit(triangle, ray);
            let away = abs(hit.distance - SHADOW_REACH);
            if (hit.distance >= 0.0 && away < nearest) {
                nearest = away;
                origin = shadow_raised(triangle, hit.weights, n);
            }
        }
    }
    return origin;
}

// The origin of rays from a point of a triangle, on the side that `n` points to.
fn shadow_raised(triangle: vec4u, weights: vec3f, n: vec3f) -> vec3f {
    let a = shadow_vertices[triangle.x];
    let b = shadow_vertices[triangle.y];
    let c = shadow_vertices[triangle.z];
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
fn shadow_shift(point: vec3f, corner: ShadowVertex, side: f32) -> vec3f {
    let normal = corner.normal * side;
    return normal * -min(dot(point - corner.position, normal), 0.0);
}

// Returns true if the surface exists at a point of a triangle and casts a shadow.
fn shadow_blocks(triangle: vec4u, weights: vec3f) -> bool {
    if (triangle.w < 2u) {
        return triangle.w == 0u;
    }
    let mask = shadow_masks[triangle.w - 2u];
    var opacity = mask.opacity;
    if (mask.size.x > 0) {
        let a = shadow_vertices[triangle.x];
        let b = shadow_vertices[triangle.y];
        let c = shadow_vertices[triangle.z];
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

fn shadow_ray(origin: vec3f, direction: vec3f, limit: f32) -> ShadowRay {
    let size = abs(direction);
    var axis = 2u;
    if (size.x >= size.y && size.x >= size.z) {
        axis = 0u;
    } else if (size.y >= size.z) {
        axis = 1u;
    }
    let along = shadow_turned(direction, axis);
    let shear = vec3f(along.xy, 1.0) / along.z;
    let inverse = vec3f(shadow_steep(direction.x), shadow_steep(direction.y), shadow_steep(direction.z));
    return ShadowRay(origin, inverse, limit, axis, shear);
}

// 1 / v. Parallel to a box's side: the hit is so far away that only the side of the origin matters.
fn shadow_steep(v: f32) -> f32 {
    if (abs(v) < 1e-30) {
        return 1e30;
    }
    return 1.0 / v;
}

// Coordinates reordered so that `axis` is last.
fn shadow_turned(v: vec3f, axis: u32) -> vec3f {
    if (axis == 0u) {
        return v.yzx;
    }
    if (axis == 1u) {
        return v.zxy;
    }
    return v;
}

fn shadow_enters(around: ShadowBox, ray: ShadowRay) -> bool {
    let a = (around.low - ray.origin) * ray.inverse;
    let b = (around.high - ray.origin) * ray.inverse;
    let first = min(a, b);
    let last = max(a, b);
    let near = max(max(first.x, first.y), max(first.z, 0.0));
    let far = min(min(last.x, last.y), min(last.z, ray.limit));
    // Widened by a few rounding errors of a distance.
    return near - abs(near) * 4e-7 <= far + abs(far) * 4e-7;
}

fn shadow_hit(triangle: vec4u, ray: ShadowRay) -> ShadowHit {
    let a = shadow_seen(triangle.x, ray);
    let b = shadow_seen(triangle.y, ray);
    let c = shadow_seen(triangle.z, ray);
    let edges = vec3f(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x);
    let sum = edges.x + edges.y + edges.z;
    if ((any(edges < vec3f(0.0)) && any(edges > vec3f(0.0))) || sum == 0.0) {
        return ShadowHit(vec3f(0.0), -1.0);
    }
    let weights = edges / sum;
    return ShadowHit(weights, ray.shear.z * dot(weights, vec3f(a.z, b.z, c.z)));
}

// A corner in the coordinates of the ray, which starts at 0 and runs along the third axis.
fn shadow_seen(corner: u32, ray: ShadowRay) -> vec3f {
    let local = shadow_turned(shadow_vertices[corner].position - ray.origin, ray.axis);
    return vec3f(local.xy - ray.shear.xy * local.z, local.z);
}
