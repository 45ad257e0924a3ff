// Bakes: projection rays onto a scan, and rays over the hemispheres of its points. The last word of a triangle is the
// number of its part.

// The rays or points of a dispatch, which are cast by consecutive invocations.
struct Slice {
    first: u32,
    end: u32,
    // The number of directions over the sphere. Points of class c follow every `classes`-th of them from the c-th on.
    directions: u32,
    classes: u32,
    // The length of the rays over the hemisphere.
    distance: f32,
}

// A ray as long on both sides of its middle.
struct Projection {
    middle: vec3f,
    // The group of parts that it sees.
    group: u32,
    // Unit.
    direction: vec3f,
    distance: f32,
}

struct SkyPoint {
    origin: vec3f,
    group: u32,
    normal: vec3f,
    own_class: u32,
    facet: vec3f,
}

// Sums over directions, weighted by their cosines: the open ones, their weights, and the weights of all.
struct Open {
    direction: vec3f,
    seen: f32,
    looked: f32,
}

const ALL: u32 = 0xffffffffu;

@group(0) @binding(0) var<uniform> slice: Slice;
@group(0) @binding(1) var<storage, read> projections: array<Projection>;
// The places of the two nearest triangles.
@group(0) @binding(2) var<storage, read_write> nearest: array<vec2u>;
@group(0) @binding(3) var<storage, read> points: array<SkyPoint>;
@group(0) @binding(4) var<storage, read_write> opens: array<Open>;
@group(0) @binding(5) var<storage, read> directions: array<vec4f>;
// The group of each part.
@group(0) @binding(9) var<storage, read> groups: array<u32>;

// The group of parts that the rays of this invocation see.
var<private> group: u32;

fn ray_blocks(triangle: vec4u, weights: vec3f) -> bool {
    return group == ALL || groups[triangle.w] == group;
}

// Finds the two hits nearest to the middle of a projection ray at which the scan's normal points along it.
@compute @workgroup_size(64)
fn project(@builtin(global_invocation_id) invocation: vec3u) {
    let number = slice.first + invocation.x;
    if (number >= slice.end) {
        return;
    }
    let own = projections[number];
    group = own.group;
    let start = own.middle - own.direction * own.distance;
    let ray = cast_ray(start, own.direction, 2.0 * own.distance);
    var away = vec2f(3e38);
    var found = vec2u(ALL);
    var walk = RayWalk();
    for (var hit = ray_next(ray, &walk); hit.distance >= 0.0; hit = ray_next(ray, &walk)) {
        let triangle = ray_triangles[hit.place];
        let here = abs(hit.distance - own.distance);
        if (hit.distance > ray.limit || here >= away.y || !ray_blocks(triangle, hit.weights)) {
            continue;
        }
        let a = ray_vertices[triangle.x].normal * hit.weights.x;
        let b = ray_vertices[triangle.y].normal * hit.weights.y;
        let c = ray_vertices[triangle.z].normal * hit.weights.z;
        if (dot(a + b + c, own.direction) > 0.0) {
            let is_nearest = here < away.x;
            away = select(vec2f(away.x, here), vec2f(here, away.x), is_nearest);
            found = select(vec2u(found.x, hit.place), vec2u(hit.place, found.x), is_nearest);
        }
    }
    nearest[number] = found;
}

// Samples the sky of a point.
@compute @workgroup_size(64)
fn look(@builtin(global_invocation_id) invocation: vec3u) {
    let number = slice.first + invocation.x;
    if (number >= slice.end) {
        return;
    }
    let point = points[number];
    group = point.group;
    var open = Open();
    for (var i = point.own_class; i < slice.directions; i += slice.classes) {
        let direction = directions[i].xyz;
        let weight = dot(point.normal, direction);
        if (weight > 0.0 && dot(point.facet, direction) > 0.0) {
            let seen = weight * ray_sight(cast_ray(point.origin, direction, slice.distance));
            open = Open(open.direction + direction * seen, open.seen + seen, open.looked + weight);
        }
    }
    opens[number] = open;
}
