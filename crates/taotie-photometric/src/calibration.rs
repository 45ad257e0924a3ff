//! The lights of photographs from the highlights on chrome balls, and their brightness from a grey ball.

use crate::circle::{Circle, Outline, candidates, refined};
use crate::grey::GreyImage;
use crate::highlight::{Highlight, highlight};
use crate::lamp::{Ray, intersection, mean_direction, squared_angles};
use crate::light::{Light, place};
use crate::photograph::{Photograph, Transfer, grey_image};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, parallel};
use taotie_io::Limits;

/// The known properties of the photographs.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// Chrome balls; without any, they are looked for if no file states the lights.
    pub balls: Vec<Circle>,
    /// A matt grey ball, which shows how bright each light is.
    pub grey_ball: Option<Circle>,
    /// The side of a pixel on the object. Positions of lamps in an `.lp` file have the same unit.
    pub pixel_size: Option<f64>,
    /// The encoding of the photographs.
    pub transfer: Transfer,
    /// Limits of memory and image sizes.
    pub limits: Limits,
}

/// Chrome balls, and how well they agree.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Balls {
    /// Their outlines; those given have no residual.
    pub outlines: Vec<Outline>,
    /// Root mean square angle between the rays from several balls and the lights, degrees per component.
    pub residual_deg: Option<f64>,
}

/// The highlights of all circles in one photograph.
type Seen = Vec<Option<Highlight>>;

/// The fraction of the photographs in which a chrome ball must have a highlight.
const SEEN: f64 = 0.8;
/// How far highlights must move, as a standard deviation in radii: those of a fixed bright spot do not.
const MOVED: f64 = 0.1;
/// The fraction of a ball's edge that must be found.
const EDGE: f64 = 0.85;
/// The most distance of the edge from its circle, root mean square, pixels.
const ROUND: f64 = 0.65;
/// How far the directions that two balls show may differ: by parallax, if lamps are near.
const AGREED_DEG: f64 = 20.0;
/// Lamps are near if their positions explain the rays this much better than directions, by variance.
const BETTER: f64 = 0.5;

/// Finds the lights of photographs.
///
/// # Errors
/// Those of reading images, [`Error::Invalid`] without a chrome ball or a highlight, [`Error::Cancelled`].
pub fn lights_of_balls(
    folder: &Path,
    paths: &[PathBuf],
    setup: &Setup,
    progress: Progress<'_>,
) -> Result<(Vec<Light>, Balls)> {
    let given = |circle: &Circle| Outline { circle: *circle, residual: 0.0, share: 1.0 };
    let outlines: Vec<Outline> = match setup.balls.as_slice() {
        [] => detected(&mean_image(paths, setup, progress.part(0.0, 0.5))?),
        balls => balls.iter().map(given).collect(),
    };
    let (size, highlights) = highlights(paths, setup, &outlines, progress.part(0.5, 1.0))?;
    if let Some(outside) = setup.balls.iter().find(|ball| !ball.is_within(size)) {
        let [x, y] = outside.center;
        return Err(Error::invalid(
            format!("chrome ball {x},{y},{}", outside.radius),
            format!("it must be within the photographs of {}x{}", size[0], size[1]),
        ));
    }
    let balls = match setup.balls.is_empty() {
        true => chosen(&outlines, &highlights),
        false => (0..outlines.len()).collect(),
    };
    if balls.is_empty() {
        return Err(Error::invalid(
            format!("{}: no lights", folder.display()),
            "add an .lp file or the files of DiLiGenT; no chrome ball was found either: name it with \
             --ball X,Y,RADIUS",
        ));
    }
    let mut rays = Vec::with_capacity(paths.len());
    for (path, seen) in paths.iter().zip(&highlights) {
        let of_ball = |i: &usize| Some(Ray::new(seen[*i].as_ref()?, &outlines[*i].circle, size));
        let found: Vec<Ray> = balls.iter().filter_map(of_ball).collect();
        if found.is_empty() {
            let what = format!("{}: no highlight on a chrome ball", path.display());
            return Err(Error::invalid(what, "remove the photograph, or state the lights in an .lp file"));
        }
        rays.push(found);
    }
    let (lights, residual_deg) = lights(&rays);
    Ok((lights, Balls { outlines: balls.iter().map(|i| outlines[*i]).collect(), residual_deg }))
}

/// Returns the mean of all photographs without the two in which a pixel is brightest: highlights on balls vanish, edges
/// remain.
fn mean_image(paths: &[PathBuf], setup: &Setup, progress: Progress<'_>) -> Result<GreyImage> {
    let mut mean: Option<(GreyImage, Vec<[f32; 2]>)> = None;
    for (i, path) in paths.iter().enumerate() {
        progress.at(i as f64 / paths.len() as f64)?;
        let mut image = grey_image(path, setup.transfer, &setup.limits)?;
        clip(&mut image);
        let (sums, brightest) = mean.get_or_insert_with(|| {
            let count = image.values.len();
            (
                GreyImage { width: image.width, height: image.height, values: vec![0.0; count] },
                vec![[0.0; 2]; count],
            )
        });
        check_size(path, &image, [sums.width, sums.height])?;
        for ((sum, [first, second]), v) in sums.values.iter_mut().zip(brightest).zip(image.values) {
            *sum += v;
            *second = second.max(v.min(*first));
            *first = first.max(v);
        }
    }
    let Some((mut mean, brightest)) = mean else {
        return Ok(GreyImage { width: 1, height: 1, values: vec![0.0] });
    };
    let count = paths.len().saturating_sub(2).max(1) as f32;
    for (sum, [first, second]) in mean.values.iter_mut().zip(brightest) {
        *sum = (*sum - first - second).max(0.0) / count;
    }
    Ok(mean)
}

/// Clips highlights: in a float image they would outshine every edge.
fn clip(image: &mut GreyImage) {
    /// The quantile to which brighter values are clipped.
    const BRIGHT: f64 = 0.9;
    let mut sorted = image.values.clone();
    let at = (BRIGHT * (sorted.len() - 1) as f64) as usize;
    let most = *sorted.select_nth_unstable_by(at, f32::total_cmp).1;
    image.values.iter_mut().for_each(|v| *v = v.min(most));
}

fn check_size(path: &Path, image: &GreyImage, [width, height]: [usize; 2]) -> Result<()> {
    if [image.width, image.height] == [width, height] {
        return Ok(());
    }
    Err(Error::invalid(
        format!("{}: {}x{} pixels", path.display(), image.width, image.height),
        format!("the first photograph has {width}x{height}; all must be alike"),
    ))
}

fn detected(mean: &GreyImage) -> Vec<Outline> {
    // Square roots: an edge in a dark part counts as much as one in a bright part. The edge itself is halfway in light.
    let roots = mean.values.iter().map(|v| v.max(0.0).sqrt()).collect();
    let found = candidates(&GreyImage { values: roots, ..*mean });
    let outlines = parallel::tasks(found.len(), &|i| refined(mean, found[i]));
    let inside = |outline: &Outline| {
        outline.share > EDGE
            && outline.residual < ROUND
            && outline.circle.radius >= crate::circle::LEAST_RADIUS
            && outline.circle.is_within([mean.width, mean.height])
    };
    outlines.into_iter().flatten().filter(inside).collect()
}

/// Calls `task` with the number and the linear grey of each photograph, of as many at the same time as memory allows.
fn of_each<T: Send>(
    paths: &[&Path],
    setup: &Setup,
    progress: Progress<'_>,
    task: &(dyn Fn(usize, &GreyImage) -> Result<T> + Sync),
) -> Result<Vec<T>> {
    /// Bytes per pixel: decoded, with the decoder's copy, and grey.
    const PIXEL: u64 = 32;
    let (mut found, count) = (Vec::with_capacity(paths.len()), paths.len());
    let grey = |i: usize| grey_image(paths[i], setup.transfer, &setup.limits);
    let mut at_once = 1;
    while found.len() < count {
        let first = found.len();
        progress.at(first as f64 / count as f64)?;
        let done = AtomicUsize::new(first);
        let bytes = AtomicU64::new(1);
        let next = parallel::try_tasks(at_once.min(count - first), &|i| {
            let image = grey(first + i)?;
            bytes.fetch_max(image.values.len() as u64 * PIXEL, Ordering::Relaxed);
            progress.at(done.fetch_add(1, Ordering::Relaxed) as f64 / count as f64)?;
            task(first + i, &image)
        })?;
        found.extend(next);
        let memory = setup.limits.memory.map_or(u64::MAX, |memory| memory.0);
        at_once = usize::try_from(memory / bytes.into_inner()).unwrap_or(usize::MAX).max(1);
    }
    Ok(found)
}

/// Returns the size of the photographs, and in each the highlights of all circles.
fn highlights(
    paths: &[PathBuf],
    setup: &Setup,
    outlines: &[Outline],
    progress: Progress<'_>,
) -> Result<([usize; 2], Vec<Seen>)> {
    let paths: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
    let found = of_each(&paths, setup, progress, &|_, image| {
        let of_ball = |outline: &Outline| highlight(image, &outline.circle);
        Ok(([image.width, image.height], outlines.iter().map(of_ball).collect::<Vec<_>>()))
    })?;
    let size = found.first().map_or([1, 1], |(size, _)| *size);
    Ok((size, found.into_iter().map(|(_, highlights)| highlights).collect()))
}

/// Returns the circles that are chrome balls: those whose highlights agree with another's, or the clearest one.
fn chosen(outlines: &[Outline], highlights: &[Seen]) -> Vec<usize> {
    let inside = |a: &Circle, b: &Circle| {
        let [dx, dy] = [0, 1].map(|axis| a.center[axis] - b.center[axis]);
        (dx * dx + dy * dy).sqrt() < b.radius && a.radius < b.radius
    };
    let chrome: Vec<usize> = (0..outlines.len()).filter(|i| is_chrome(highlights, *i)).collect();
    // Reflections within a ball have circles too.
    let is_part = |i: &usize| chrome.iter().any(|j| inside(&outlines[*i].circle, &outlines[*j].circle));
    let whole: Vec<usize> = chrome.iter().copied().filter(|i| !is_part(i)).collect();
    let agrees = |i: &usize| whole.iter().any(|j| j != i && difference(highlights, [*i, *j]) < AGREED_DEG);
    let agreed: Vec<usize> = whole.iter().copied().filter(agrees).collect();
    let clearest = whole.iter().copied().max_by(|a, b| outlines[*a].share.total_cmp(&outlines[*b].share));
    if agreed.is_empty() { clearest.into_iter().collect() } else { agreed }
}

/// Returns the median angle between the directions that two circles show, degrees.
fn difference(highlights: &[Seen], [i, j]: [usize; 2]) -> f64 {
    let angle = |seen: &Seen| Some(taotie_engine::compare::angle_deg(seen[i]?.direction, seen[j]?.direction));
    let mut angles: Vec<f64> = highlights.iter().filter_map(angle).collect();
    let middle = angles.len() / 2;
    match angles.len() {
        0 => f64::INFINITY,
        _ => *angles.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// Returns true if circle `i` has a small highlight that moves with the light.
fn is_chrome(highlights: &[Seen], i: usize) -> bool {
    let seen: Vec<Vec3<f64>> = highlights.iter().filter_map(|seen| Some(seen[i]?.normal)).collect();
    let mean = seen.iter().fold(Vec3::splat(0.0), |sum, n| sum + *n) / seen.len().max(1) as f64;
    let squares: f64 = seen.iter().map(|n| (*n - mean).dot(*n - mean)).sum();
    seen.len() as f64 >= SEEN * highlights.len() as f64 && (squares / seen.len().max(1) as f64).sqrt() > MOVED
}

/// Returns the lights, and the residual of the rays: near lamps if several balls show that they are near.
fn lights(rays: &[Vec<Ray>]) -> (Vec<Light>, Option<f64>) {
    let several: Vec<&Vec<Ray>> = rays.iter().filter(|rays| rays.len() > 1).collect();
    let components: usize = several.iter().map(|rays| 2 * rays.len()).sum();
    let variance = |squares: f64, unknowns: usize| {
        let freedom = components.saturating_sub(unknowns * several.len());
        (freedom > 0).then(|| squares / freedom as f64)
    };
    let distant: f64 = several
        .iter()
        .map(|rays| {
            let mean = mean_direction(rays);
            squared_angles(rays, |_| mean)
        })
        .sum();
    let near = several.iter().try_fold(0.0, |sum, rays| {
        let lamp = intersection(rays)?;
        Some(sum + squared_angles(rays, |ray| (lamp - ray.from).normalize_or(ray.direction)))
    });
    let distant = variance(distant, 2);
    let near = near.and_then(|squares| variance(squares, 3)).filter(|_| several.len() == rays.len());
    let is_near = near.zip(distant).is_some_and(|(near, distant)| near < BETTER * distant);
    let light = |rays: &Vec<Ray>| {
        let direction = mean_direction(rays);
        let position = intersection(rays).filter(|_| is_near);
        Light {
            direction: position.map_or(direction, |p| p.normalize_or(direction)),
            intensity: [1.0; 3],
            position,
        }
    };
    let residual = if is_near { near } else { distant };
    let mut lights: Vec<Light> = rays.iter().map(light).collect();
    settle_distances(&mut lights);
    (lights, residual.map(|variance| variance.sqrt().to_degrees()))
}

/// Lamps of a dome are equally far away: a scatter of their distances up to this fraction is taken for error.
const DOME: f64 = 0.2;

/// Moves lamps to their median distance if they seem to form a dome. Rays from balls that are close together find
/// directions well and distances badly, and brightness depends on the square of the distance.
fn settle_distances(lights: &mut [Light]) {
    let mut distances: Vec<f64> = lights.iter().filter_map(|light| Some(light.position?.length())).collect();
    if distances.is_empty() {
        return;
    }
    let middle = distances.len() / 2;
    let median = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
    let squares: f64 = distances.iter().map(|d| (d / median - 1.0) * (d / median - 1.0)).sum();
    if (squares / distances.len() as f64).sqrt() < DOME {
        for light in lights.iter_mut().filter(|light| light.position.is_some()) {
            light.position = Some(light.direction * median);
        }
    }
}

/// The least cosine to the light that counts on a grey ball.
const LEAST_COSINE: f64 = 0.3;
/// The fraction of a grey ball's radius that counts.
const GREY_INSIDE: f64 = 0.9;

/// The root mean square difference from a matt ball, relative to its brightness, beyond which there is none.
const MOST_GREY_MISFIT: f64 = 0.15;

/// Returns the brightness of each light relative to their mean, from a matt grey ball: the median of I / (n · l) over
/// the lit part.
///
/// # Errors
/// Those of reading images, [`Error::Invalid`] if the ball is outside, dark, or not shaded like a matt ball,
/// [`Error::Cancelled`].
pub fn brightness_of(
    photographs: &[Photograph],
    ball: &Circle,
    setup: &Setup,
    progress: Progress<'_>,
) -> Result<Vec<f64>> {
    let paths: Vec<&Path> = photographs.iter().map(|photograph| photograph.path.as_path()).collect();
    let found = of_each(&paths, setup, progress, &|i, image| {
        let photograph = &photographs[i];
        let wrong = |why: &str| {
            let [x, y] = ball.center;
            let what = format!("{}: grey ball {x},{y},{}", photograph.path.display(), ball.radius);
            Error::invalid(what, why.to_owned())
        };
        if !ball.is_within([image.width, image.height]) {
            return Err(wrong("it must be within the photographs"));
        }
        let lit = lit_part(image, ball, &photograph.light);
        let mut ratios: Vec<f64> = lit.iter().map(|[cosine, grey]| grey / cosine).collect();
        let middle = ratios.len() / 2;
        if ratios.is_empty() {
            return Err(wrong("no lit pixel on it; correct the circle or the lights"));
        }
        let brightness = *ratios.select_nth_unstable_by(middle, f64::total_cmp).1;
        Ok([brightness, misfit(&lit, brightness)])
    })?;
    let mean = |of: usize| found.iter().map(|found| found[of]).sum::<f64>() / found.len().max(1) as f64;
    let (average, misfit) = (mean(0), mean(1).sqrt());
    if misfit > MOST_GREY_MISFIT {
        let [x, y] = ball.center;
        return Err(Error::invalid(
            format!("grey ball {x},{y},{}", ball.radius),
            format!(
                "its shading differs by {:.0} % from that of a matt ball, {:.0} % at most are expected; correct the circle or \
                 the lights",
                100.0 * misfit,
                100.0 * MOST_GREY_MISFIT
            ),
        ));
    }
    Ok(found.iter().map(|[brightness, _]| brightness / average).collect())
}

/// Returns the mean squared difference of the lit pixels of a ball from a matt one, relative to their mean square.
fn misfit(lit: &[[f64; 2]], brightness: f64) -> f64 {
    let squares =
        |value: &dyn Fn(&[f64; 2]) -> f64| lit.iter().map(|pixel| value(pixel) * value(pixel)).sum::<f64>();
    let rest = squares(&|[cosine, grey]| grey - brightness * cosine);
    rest / squares(&|[_, grey]| *grey).max(f64::MIN_POSITIVE)
}

/// Returns n · l and I of the lit pixels of a ball.
fn lit_part(image: &GreyImage, ball: &Circle, light: &Light) -> Vec<[f64; 2]> {
    let inner = Circle { radius: GREY_INSIDE * ball.radius, ..*ball };
    let size = [image.width, image.height];
    let lit = |i: usize| {
        let pixel = [i % image.width, i / image.width];
        if !inner.holds(pixel, 0.0) {
            return None;
        }
        let [x, y] = [pixel[0] as f64 + 0.5 - ball.center[0], ball.center[1] - pixel[1] as f64 - 0.5];
        let [x, y] = [x / ball.radius, y / ball.radius];
        let normal = Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
        // It rests on the plane of the object, as chrome balls do: its surface is closer to a near lamp.
        let height = Vec3::new(0.0, 0.0, ball.radius * (1.0 + normal.z));
        let at = light.at(place(pixel, size) + height);
        let cosine = normal.dot(at.direction);
        let grey = f64::from(image.values[i]) * at.falloff;
        (cosine > LEAST_COSINE && grey > 0.0).then_some([cosine, grey])
    };
    (0..image.values.len()).filter_map(lit).collect()
}
