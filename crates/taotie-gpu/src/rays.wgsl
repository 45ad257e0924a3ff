// Rays through the boxes of all triangles: the same for shadows and bakes, which define
// `ray_blocks(triangle: vec4u, weights: vec3f) -> bool`: whether a hit ends a ray.

// A box. The boxes inside it follow it; `skip` is the index of the next box outside it. In a leaf, the low four bits
// of `leaf` are the number of its triangles, and the others the index of the first. After the last box comes one
// whose `skip` is 0, since Mesa's lavapipe 22.3 reports an `arrayLength` larger than the list.
struct RayBox {
    low: vec3f,
    skip: u32,
    high: vec3f,
    leaf: u32,
}

// A corner of triangles. `u` and `v` are coordinates in the texture that cuts holes in shadows.
struct RayVertex {
    position: vec3f,
    u: f32,
    // Unit.
    normal: vec3f,
    v: f32,
}

// A ray, `limit` times as long as its direction. `axis` is its dominant axis, which comes last in the coordinates in
// which `shear` maps the ray to the last axis.
// Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection".
struct CastRay {
    origin: vec3f,
    inverse: vec3f,
    limit: f32,
    axis: u32,
    shear: vec3f,
}

// A point of a triangle: the weights of its corners, and its distance, below 0 if the ray misses the triangle. `place` is
// the index of the triangle.
struct RayHit {
    weights: vec3f,
    distance: f32,
    place: u32,
}

// The way of a ray through the boxes: the next box, and the remaining triangles of a leaf, which end before `end`.
struct RayWalk {
    index: u32,
    place: u32,
    end: u32,
}

@group(0) @binding(6) var<storage, read> ray_boxes: array<RayBox>;
// Three corners, counter-clockwise as seen from the front, and a word for `ray_blocks`.
@group(0) @binding(7) var<storage, read> ray_triangles: array<vec4u>;
@group(0) @binding(8) var<storage, read> ray_vertices: array<RayVertex>;

// The index of the first box from `start` onwards that the ray enters and that contains triangles; the end's if there
// is none.
fn ray_leaf(ray: CastRay, start: u32) -> u32 {
    var index = start;
    loop {
        let around = ray_boxes[index];
        if (around.skip == 0u) {
            break;
        }
        if (!ray_enters(around, ray)) {
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

// The next hit of a ray, in no particular order; its distance is below 0 after the last one.
fn ray_next(ray: CastRay, walk: ptr<function, RayWalk>) -> RayHit {
    loop {
        while ((*walk).place < (*walk).end) {
            let hit = ray_hit((*walk).place, ray);
            (*walk).place++;
            if (hit.distance >= 0.0) {
                return hit;
            }
        }
        let index = ray_leaf(ray, (*walk).index);
        let around = ray_boxes[index];
        if (around.skip == 0u) {
            break;
        }
        let first = around.leaf >> 4u;
        *walk = RayWalk(index + 1u, first, first + (around.leaf & 15u));
    }
    return RayHit(vec3f(0.0), -1.0, 0u);
}

// 1 if nothing blocks the ray, else 0.
fn ray_sight(ray: CastRay) -> f32 {
    var walk = RayWalk();
    for (var hit = ray_next(ray, &walk); hit.distance >= 0.0; hit = ray_next(ray, &walk)) {
        if (hit.distance < ray.limit && ray_blocks(ray_triangles[hit.place], hit.weights)) {
            return 0.0;
        }
    }
    return 1.0;
}

fn cast_ray(origin: vec3f, direction: vec3f, limit: f32) -> CastRay {
    let size = abs(direction);
    var axis = 2u;
    if (size.x >= size.y && size.x >= size.z) {
        axis = 0u;
    } else if (size.y >= size.z) {
        axis = 1u;
    }
    let along = ray_turned(direction, axis);
    let shear = vec3f(along.xy, 1.0) / along.z;
    let inverse = vec3f(ray_steep(direction.x), ray_steep(direction.y), ray_steep(direction.z));
    return CastRay(origin, inverse, limit, axis, shear);
}

// 1 / v. Parallel to a box's side: the hit is so far away that only the side of the origin matters.
fn ray_steep(v: f32) -> f32 {
    if (abs(v) < 1e-30) {
        return 1e30;
    }
    return 1.0 / v;
}

// Coordinates reordered so that `axis` is last.
fn ray_turned(v: vec3f, axis: u32) -> vec3f {
    if (axis == 0u) {
        return v.yzx;
    }
    if (axis == 1u) {
        return v.zxy;
    }
    return v;
}

fn ray_enters(around: RayBox, ray: CastRay) -> bool {
    let a = (around.low - ray.origin) * ray.inverse;
    let b = (around.high - ray.origin) * ray.inverse;
    let first = min(a, b);
    let last = max(a, b);
    let near = max(max(first.x, first.y), max(first.z, 0.0));
    let far = min(min(last.x, last.y), min(last.z, ray.limit));
    // Widened by a few rounding errors of a distance.
    return near - abs(near) * 4e-7 <= far + abs(far) * 4e-7;
}

fn ray_hit(place: u32, ray: CastRay) -> RayHit {
    let triangle = ray_triangles[place];
    let a = ray_corner(triangle.x, ray);
    let b = ray_corner(triangle.y, ray);
    let c = ray_corner(triangle.z, ray);
    let edges = vec3f(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x);
    let sum = edges.x + edges.y + edges.z;
    if ((any(edges < vec3f(0.0)) && any(edges > vec3f(0.0))) || sum == 0.0) {
        return RayHit(vec3f(0.0), -1.0, place);
    }
    let weights = edges / sum;
    return RayHit(weights, ray.shear.z * dot(weights, vec3f(a.z, b.z, c.z)), place);
}

// A corner in the coordinates of the ray, which starts at 0 and runs along the third axis.
fn ray_corner(corner: u32, ray: CastRay) -> vec3f {
    let local = ray_turned(ray_vertices[corner].position - ray.origin, ray.axis);
    return vec3f(local.xy - ray.shear.xy * local.z, local.z);
}
