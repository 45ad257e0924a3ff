//! The rays of bakes: a scan's triangles on a GPU, and the dispatches that cast rays at them.
//!
//! Work is submitted in slices that take a fraction of a second even on slow GPUs, since systems reset a GPU that does
//! not answer for about two seconds. Several threads may cast rays at once, so that the GPU works on those of one while
//! others prepare theirs.

use crate::gpu::{Gpu, Result};
use crate::rays::{END_BOX, RAYS, box_words};
use bytemuck::{Pod, Zeroable};
use taotie_engine::bake::{CastRay, Open, RayCaster, RayDevice, Scan, SkyPoint, SkyRays};
use taotie_engine::math::Vec3;
use wgpu::{Buffer, BufferUsages, ComputePipeline, SubmissionIndex};

/// The shader functions of bakes, which call those of rays.
const TEXT: &str = include_str!("bake.wgsl");

/// The number of invocations of a workgroup, as in the shader.
const GROUP: u32 = 64;

/// The number of projection rays in a slice.
const PROJECTIONS: u32 = 1 << 17;

/// The number of directions that all points of a slice try together, and the smallest number of points.
const DIRECTIONS: u32 = 1 << 23;
const FEWEST_POINTS: u32 = 1 << 11;

/// Triangles whose index does not fit the words of a box.
const MOST_TRIANGLES: usize = 1 << 28;

/// The bytes that are uploaded before the GPU has taken them.
const PIECE: usize = 1 << 24;

/// The group of rays that see all parts, of parts without a group, and the place of a missing triangle.
const NONE: u32 = u32::MAX;

impl RayDevice for Gpu {
    fn load(&self, scan: &Scan) -> taotie_engine::Result<Box<dyn RayCaster>> {
        Ok(Box::new(LoadedScan::new(self, scan)?))
    }
}

/// The triangles of a scan on a GPU.
struct LoadedScan {
    gpu: Gpu,
    boxes: Buffer,
    triangles: Buffer,
    vertices: Buffer,
    /// The triangle at each place.
    order: Vec<u32>,
    /// The number of parts of the scan.
    parts: usize,
    project: ComputePipeline,
    look: ComputePipeline,
}

/// A vertex as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    u: f32,
    normal: [f32; 3],
    v: f32,
}

/// A projection ray as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Projection {
    middle: [f32; 3],
    group: u32,
    direction: [f32; 3],
    distance: f32,
}

/// A point whose sky is sampled, as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Point {
    origin: [f32; 3],
    group: u32,
    normal: [f32; 3],
    class: u32,
    facet: [f32; 3],
    padding: u32,
}

/// The open part of a hemisphere, as the shader writes it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct OpenSums {
    direction: [f32; 3],
    seen: f32,
    looked: f32,
    padding: [f32; 3],
}

/// The range of invocations of a dispatch and what all share, as the shader reads them.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Slice {
    first: u32,
    end: u32,
    directions: u32,
    classes: u32,
    distance: f32,
    padding: [u32; 3],
}

/// The number of bytes that a result takes.
const NEAREST_BYTES: usize = size_of::<[u32; 2]>();
const OPEN_BYTES: usize = size_of::<OpenSums>();

/// Work on many rays or points.
struct Work<'a> {
    /// The step, for errors.
    doing: &'static str,
    pipeline: &'a ComputePipeline,
    /// The buffers that it reads, by their bindings.
    inputs: &'a [(u32, &'a Buffer)],
    /// The binding of the results, and the bytes of each.
    results: (u32, usize),
    /// All of its invocations.
    all: Slice,
    /// The number of invocations in a slice.
    slice: u32,
}

impl LoadedScan {
    /// Uploads the triangles of a scan.
    fn new(gpu: &Gpu, scan: &Scan) -> Result<Self> {
        let mesh = scan.mesh();
        check_size(gpu, scan)?;
        let flat = scan.bvh().flat();
        let (mut boxes, order) = (box_words(&flat.boxes), flat.order);
        boxes.push(END_BOX);
        let vertex = |i: usize| {
            let normal = mesh.normals().get(i).map_or([0.0; 3], |normal| normal.to_array());
            Vertex { position: mesh.positions()[i].to_array(), u: 0.0, normal, v: 0.0 }
        };
        let triangle = |place: usize| {
            let number = order[place];
            let [a, b, c] = mesh.triangles()[number as usize];
            [a, b, c, scan.surface().part_number(number) as u32]
        };
        let vertices = filled(gpu, "the vertices of the scan", (mesh.positions().len(), &vertex))?;
        let triangles = filled(gpu, "the triangles of the scan", (order.len(), &triangle))?;
        let boxes = filled(gpu, "the tree of the scan", (boxes.len(), &|i| boxes[i]))?;
        let [project, look] = pipelines(gpu)?;
        let parts = scan.surface().part_count();
        Ok(Self { gpu: gpu.clone(), boxes, triangles, vertices, order, parts, project, look })
    }

    /// Returns the buffer with the group of each part.
    fn groups(&self, groups: &[Option<u32>]) -> Result<Buffer> {
        let group = |part: usize| number(groups.get(part).copied().flatten());
        let words: Vec<u32> = (0..self.parts.max(1)).map(group).collect();
        self.gpu.storage("the groups of the scan's parts", bytemuck::cast_slice(&words))
    }

    /// Returns the triangle at a place.
    fn triangle(&self, place: u32) -> Option<u32> {
        self.order.get(place as usize).copied()
    }

    fn project(&self, rays: &[CastRay], groups: &[Option<u32>]) -> Result<Vec<[Option<u32>; 2]>> {
        let words: Vec<Projection> = rays.iter().map(Projection::of).collect();
        let rays = self.gpu.storage("projection rays", bytemuck::cast_slice(&words))?;
        let groups = self.groups(groups)?;
        let bytes = self.run(&Work {
            doing: "casting projection rays",
            pipeline: &self.project,
            inputs: &[(1, &rays), (9, &groups)],
            results: (2, NEAREST_BYTES),
            all: Slice { end: words.len() as u32, ..Slice::zeroed() },
            slice: PROJECTIONS,
        })?;
        let places = bytes.chunks_exact(NEAREST_BYTES).map(bytemuck::pod_read_unaligned::<[u32; 2]>);
        Ok(places.map(|places| places.map(|place| self.triangle(place))).collect())
    }

    fn look(&self, sky: SkyRays<'_>, points: &[SkyPoint], groups: &[Option<u32>]) -> Result<Vec<Open>> {
        // Neighbours that follow the same directions take the same way through the tree.
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|i| points[*i].class);
        let words: Vec<Point> = order.iter().map(|i| Point::of(&points[*i])).collect();
        let directions: Vec<[f32; 4]> =
            sky.directions.iter().map(|direction| [direction.x, direction.y, direction.z, 0.0]).collect();
        let points = self.gpu.storage("points of the scan", bytemuck::cast_slice(&words))?;
        let directions = self.gpu.storage("directions", bytemuck::cast_slice(&directions))?;
        let groups = self.groups(groups)?;
        let (count, classes) = (sky.directions.len() as u32, sky.classes.max(1));
        let bytes = self.run(&Work {
            doing: "casting rays over the hemisphere",
            pipeline: &self.look,
            inputs: &[(3, &points), (5, &directions), (9, &groups)],
            results: (4, OPEN_BYTES),
            all: Slice {
                end: words.len() as u32,
                directions: count,
                classes,
                // Shaders may assume that numbers are finite.
                distance: sky.distance.min(f32::MAX),
                ..Slice::zeroed()
            },
            slice: (DIRECTIONS / count.div_ceil(classes).max(1)).max(FEWEST_POINTS),
        })?;
        let sums = bytes.chunks_exact(OPEN_BYTES).map(bytemuck::pod_read_unaligned).map(OpenSums::open);
        let mut open = vec![Open::default(); order.len()];
        order.into_iter().zip(sums).for_each(|(i, sums)| open[i] = sums);
        Ok(open)
    }

    /// Runs work slice by slice, and returns its results.
    fn run(&self, work: &Work<'_>) -> Result<Vec<u8>> {
        let gpu = &self.gpu;
        let bytes = work.all.end as u64 * work.results.1 as u64;
        if bytes == 0 {
            return Ok(Vec::new());
        }
        let results = gpu.empty(work.doing, bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC)?;
        let copy = gpu.empty(work.doing, bytes, BufferUsages::MAP_READ)?;
        let slice = gpu.empty(work.doing, size_of::<Slice>() as u64, BufferUsages::UNIFORM)?;
        let inputs = gpu.checked(work.doing, || self.bind(work, &slice, &results))?;
        let mut before: Option<SubmissionIndex> = None;
        for first in (0..work.all.end).step_by(work.slice as usize) {
            let part = Slice { first, end: work.all.end.min(first.saturating_add(work.slice)), ..work.all };
            let submitted = gpu.checked(work.doing, || {
                gpu.queue.write_buffer(&slice, 0, bytemuck::bytes_of(&part));
                let mut encoder = gpu.device.create_command_encoder(&Default::default());
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_pipeline(work.pipeline);
                pass.set_bind_group(0, &inputs, &[]);
                pass.dispatch_workgroups((part.end - part.first).div_ceil(GROUP), 1, 1);
                drop(pass);
                gpu.queue.submit([encoder.finish()])
            })?;
            // Waiting only for the slice before keeps the GPU busy.
            if let Some(before) = before.replace(submitted) {
                gpu.wait(work.doing, before)?;
            }
        }
        let submitted = gpu.checked(work.doing, || {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&results, 0, &copy, 0, bytes);
            gpu.queue.submit([encoder.finish()])
        })?;
        let mut read = gpu.read(work.doing, (copy, submitted))?;
        read.truncate(bytes as usize);
        Ok(read)
    }

    /// Binds the buffers of some work.
    fn bind(&self, work: &Work<'_>, slice: &Buffer, results: &Buffer) -> wgpu::BindGroup {
        let scan = [(6, &self.boxes), (7, &self.triangles), (8, &self.vertices)];
        let own = [(0, slice), (work.results.0, results)];
        let entries: Vec<_> = own
            .iter()
            .chain(work.inputs)
            .chain(&scan)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(work.doing),
            layout: &work.pipeline.get_bind_group_layout(0),
            entries: &entries,
        })
    }
}

impl RayCaster for LoadedScan {
    fn nearest(
        &self,
        rays: &[CastRay],
        groups: &[Option<u32>],
    ) -> taotie_engine::Result<Vec<[Option<u32>; 2]>> {
        Ok(self.project(rays, groups)?)
    }

    fn open(
        &self,
        sky: SkyRays<'_>,
        points: &[SkyPoint],
        groups: &[Option<u32>],
    ) -> taotie_engine::Result<Vec<Open>> {
        Ok(self.look(sky, points, groups)?)
    }
}

impl Projection {
    fn of(ray: &CastRay) -> Self {
        let CastRay { middle, direction, distance, group } = *ray;
        let [middle, direction] = [middle, direction].map(Vec3::to_array);
        Self { middle, group: number(group), direction, distance }
    }
}

impl Point {
    fn of(point: &SkyPoint) -> Self {
        let SkyPoint { origin, normal, facet, class, group } = *point;
        let [origin, normal, facet] = [origin, normal, facet].map(Vec3::to_array);
        Self { origin, group: number(group), normal, class, facet, padding: 0 }
    }
}

impl OpenSums {
    fn open(self) -> Open {
        Open { looked: self.looked, seen: self.seen, direction: Vec3::from_array(self.direction) }
    }
}

/// Returns the number of a group for the shader.
fn number(group: Option<u32>) -> u32 {
    group.unwrap_or(NONE)
}

/// Refuses a scan whose triangles or vertices do not fit into one buffer.
fn check_size(gpu: &Gpu, scan: &Scan) -> Result<()> {
    let mesh = scan.mesh();
    let (triangles, vertices) = (mesh.triangles().len(), mesh.positions().len());
    let largest = (triangles * size_of::<[u32; 4]>()).max(vertices * size_of::<Vertex>()) as u64;
    let most = gpu.limits.max_storage_buffer_binding_size.min(gpu.limits.max_buffer_size);
    if largest <= most && triangles < MOST_TRIANGLES {
        return Ok(());
    }
    let fitting = ((triangles as f64 * (most as f64 / largest as f64)) as u64).min(MOST_TRIANGLES as u64 - 1);
    Err(gpu.too_large("the scan", format!("{triangles} triangles"), format!("about {fitting}")))
}

/// Creates a buffer of elements, which are uploaded piece by piece.
fn filled<T: Pod>(gpu: &Gpu, what: &str, (count, element): (usize, &dyn Fn(usize) -> T)) -> Result<Buffer> {
    let buffer = gpu.empty(what, (count * size_of::<T>()) as u64, BufferUsages::STORAGE)?;
    let per_piece = PIECE / size_of::<T>();
    for first in (0..count).step_by(per_piece) {
        let elements: Vec<T> = (first..count.min(first + per_piece)).map(element).collect();
        let submitted = gpu.checked(what, || {
            gpu.queue.write_buffer(&buffer, (first * size_of::<T>()) as u64, bytemuck::cast_slice(&elements));
            gpu.queue.submit([])
        })?;
        gpu.wait(what, submitted)?;
    }
    Ok(buffer)
}

/// Creates the pipelines for projection rays and for rays over the hemisphere.
fn pipelines(gpu: &Gpu) -> Result<[ComputePipeline; 2]> {
    gpu.checked("the shaders of bakes", || {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bake"),
            source: wgpu::ShaderSource::Wgsl(format!("{RAYS}{TEXT}").into()),
        });
        ["project", "look"].map(|name| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::scene::{Material, Scene};

    #[test]
    fn a_scan_that_does_not_fit_is_refused_with_the_size_that_does() {
        let Some(mut gpu) = crate::gpu::found() else { return };
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 64, 32), Material::default()).unwrap();
        let scan = Scan::new(scene).unwrap();
        assert!(gpu.load(&scan).is_ok());
        // 3,968 triangles take 63,488 bytes, and 2,145 vertices 68,640.
        gpu.limits.max_storage_buffer_binding_size = 34_320;
        let error = gpu.load(&scan).err().expect("it does not fit").to_string();
        let fits = "the scan is too large: 3968 triangles, at most about 1984 on ";
        assert!(error.starts_with(fits) && error.ends_with("; make it smaller, or use the CPU"), "{error}");
    }
}
