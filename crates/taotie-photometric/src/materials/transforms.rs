//! `transforms.json` of NeRF, instant-ngp and nerfstudio: photographs with their cameras; and, as an addition, their lights.

use super::frame::{Frame, Lamp, LampPlace, Lens, Pose};
use crate::folder::check_format;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::math::{Mat4, Vec3};
use taotie_io::{quote, read_bytes};

/// The largest file that is read, bytes.
const LONGEST: usize = 64 << 20;
/// The most photographs.
const MOST: usize = 4096;
/// Extensions that are tried if a photograph is named without one.
const EXTENSIONS: [&str; 6] = ["png", "exr", "jpg", "jpeg", "tif", "tiff"];
/// Coefficients of distortion, which must be 0.
const DISTORTION: [&str; 8] = ["k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"];
/// Camera models without distortion, or with one whose coefficients are 0.
const MODELS: [&str; 5] = ["SIMPLE_PINHOLE", "PINHOLE", "OPENCV", "PERSPECTIVE", "FULL_OPENCV"];
/// How far the axes of a camera may be from unit and perpendicular.
const ROUNDING: f64 = 1e-2;
/// The farthest camera or light, model units.
const FARTHEST: f64 = 1e12;

/// The photographs of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Transforms {
    /// The file.
    pub path: PathBuf,
    /// The photographs, in the order of the file; at least one.
    pub frames: Vec<Frame>,
}

/// The keys of a lens, for all photographs or one.
#[derive(Debug, Clone, Default, Deserialize)]
struct LensKeys {
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    camera_model: Option<String>,
    #[serde(default)]
    is_fisheye: bool,
}

/// The keys of a photograph.
#[derive(Debug, Clone, Deserialize)]
struct FrameKeys {
    file_path: String,
    mask_path: Option<String>,
    transform_matrix: Vec<Vec<f64>>,
}

/// The key of a camera.
#[derive(Debug, Clone, Deserialize)]
struct PoseKeys {
    transform_matrix: Vec<Vec<f64>>,
}

/// The keys of a light.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct LightKeys {
    direction: Option<[f64; 3]>,
    position: Option<[f64; 3]>,
    intensity: Option<Intensity>,
    #[serde(default)]
    space: Space,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Intensity {
    Grey(f64),
    Rgb([f64; 3]),
}

/// The space of a light's direction or position.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Space {
    /// That of the model.
    #[default]
    World,
    /// That of the camera, for a light that moves with it.
    Camera,
}

impl Transforms {
    /// Reads a file. Photographs are looked up relative to it.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Parse`] with the photograph whose keys are wrong or missing; [`Error::Unsupported`] for
    /// distortion, naming the keys, and formats that are not read; [`Error::Limit`] for more than 4,096 photographs.
    pub fn open(path: &Path) -> Result<Self> {
        let all = json_of(path)?;
        let Some(frames) = all.get("frames").and_then(Value::as_array).filter(|frames| !frames.is_empty())
        else {
            let what = "missing list of photographs: expected keys `frames`, `file_path` and `transform_matrix` as in NeRF's \
                        transforms.json";
            return Err(Error::parse(path, "the top level", what));
        };
        if frames.len() > MOST {
            return Err(Error::limit(path.display().to_string(), format!("at most {MOST} photographs")));
        }
        let reader = Reader { path, all: &all };
        let frames = frames.iter().enumerate().map(|(i, frame)| reader.frame(i, frame));
        let frames = frames.collect::<Result<Vec<_>>>()?;
        check_unique(path, &frames)?;
        Ok(Self { path: path.to_path_buf(), frames })
    }
}

impl Pose {
    /// Reads the camera of photographs from one position: the keys of `transforms.json` at the top level, or in a single frame,
    /// whose photograph and light are not read.
    ///
    /// # Errors
    /// As [`Transforms::open`].
    pub fn open(path: &Path) -> Result<Self> {
        let all = json_of(path)?;
        let reader = Reader { path, all: &all };
        let frames = all.get("frames").and_then(Value::as_array).map(Vec::as_slice);
        let (own, at) = match (all.get("transform_matrix"), frames) {
            (Some(_), _) => (&all, "the top level"),
            (None, Some([frame])) => (frame, "frames[0]"),
            (None, _) => {
                let what =
                    "expected `transform_matrix`, here or in a single frame: the camera of all photographs";
                return Err(Error::parse(path, "the top level", what));
            }
        };
        let failed = |what: String| Error::parse(path, at, what);
        let PoseKeys { transform_matrix } = read(own).map_err(failed)?;
        let lens = reader.lens(own, at)?;
        Ok(Self { world_from_view: rigid(&transform_matrix).map_err(failed)?, lens })
    }
}

/// Reads a file as JSON.
fn json_of(path: &Path) -> Result<Value> {
    let bytes = read_bytes(path)?;
    if bytes.len() > LONGEST {
        return Err(Error::limit(path.display().to_string(), "at most 64 MiB of cameras"));
    }
    let json = serde_json::from_slice::<Value>(&bytes);
    json.map_err(|error| Error::parse(path, "JSON", format!("{error}; correct the file")))
}

/// Rejects a photograph that is listed twice.
fn check_unique(path: &Path, frames: &[Frame]) -> Result<()> {
    let mut sorted: Vec<(usize, &Frame)> = frames.iter().enumerate().collect();
    sorted.sort_by(|(_, a), (_, b)| a.path.cmp(&b.path));
    let same = sorted.windows(2).find(|pair| pair[0].1.path == pair[1].1.path);
    same.map_or(Ok(()), |pair| {
        let [first, second] = [pair[0].0.min(pair[1].0), pair[0].0.max(pair[1].0)];
        let name = quote(&pair[0].1.path.display().to_string());
        let what = format!("{name} is also frames[{first}]; list it once");
        Err(Error::parse(path, format!("frames[{second}]"), what))
    })
}

/// Reads the photographs of a file.
struct Reader<'a> {
    path: &'a Path,
    all: &'a Value,
}

impl Reader<'_> {
    fn frame(&self, i: usize, own: &Value) -> Result<Frame> {
        let at = format!("frames[{i}]");
        let failed = |what: String| Error::parse(self.path, &at, what);
        let keys: FrameKeys = read(own).map_err(&failed)?;
        let path = self.image(("file_path", &keys.file_path)).map_err(&failed)?;
        let mask =
            keys.mask_path.map(|name| self.image(("mask_path", &name)).map_err(&failed)).transpose()?;
        check_format(&path)?;
        let lens = self.lens(own, &at)?;
        let world_from_view = rigid(&keys.transform_matrix).map_err(&failed)?;
        let lamp = match (own.get("light"), self.all.get("light")) {
            (Some(light), _) | (None, Some(light)) => lamp(light, &world_from_view).map_err(&failed)?,
            (None, None) => {
                let what = "missing key `light`: expected {\"direction\": [X, Y, Z]} or {\"position\": [X, Y, Z], \
                            \"intensity\": I}, here or at the top level";
                return Err(failed(what.to_owned()));
            }
        };
        Ok(Frame { path, mask, world_from_view, lens, lamp })
    }

    /// Returns the path of an image, which may be named without its extension, given the key that names it.
    fn image(&self, (key, name): (&str, &str)) -> std::result::Result<PathBuf, String> {
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        if path.is_file() {
            return Ok(path);
        }
        let with = |extension: &str| PathBuf::from(format!("{}.{extension}", path.display()));
        let found = EXTENSIONS.iter().map(|extension| with(extension)).find(|path| path.is_file());
        found.ok_or_else(|| {
            format!("{} does not exist; correct `{key}` or add the image", quote(&path.display().to_string()))
        })
    }

    /// Returns the lens of a photograph: its own keys take precedence over those of the file, of focal lengths and angles of
    /// view together.
    fn lens(&self, own: &Value, at: &str) -> Result<Lens> {
        let failed = |at: &str, what: String| Error::parse(self.path, at, what);
        for value in [self.all, own] {
            let is_used = |key: &&str| value.get(*key).and_then(Value::as_f64).is_some_and(|v| v != 0.0);
            let used: Vec<&str> = DISTORTION.into_iter().filter(|key| is_used(key)).collect();
            if !used.is_empty() {
                let what = format!("{}: distortion ({})", self.path.display(), used.join(", "));
                return Err(Error::unsupported(
                    what,
                    "undistort the photographs, e.g. with COLMAP's image_undistorter",
                ));
            }
        }
        let file: LensKeys = read(self.all).map_err(|what| failed("the top level", what))?;
        let own: LensKeys = read(own).map_err(|what| failed(at, what))?;
        let model = own.camera_model.or(file.camera_model);
        if let Some(model) = model.filter(|model| !MODELS.contains(&model.as_str())) {
            let what = format!("{}: the camera model {}", self.path.display(), quote(&model));
            return Err(Error::unsupported(what, "undistort the photographs"));
        }
        if own.is_fisheye || file.is_fisheye {
            let what = format!("{}: a fisheye lens", self.path.display());
            return Err(Error::unsupported(what, "undistort the photographs"));
        }
        let own_width = [own.fl_x, own.fl_y, own.camera_angle_x, own.camera_angle_y];
        let [fl_x, fl_y, camera_angle_x, camera_angle_y] = match own_width.iter().any(Option::is_some) {
            true => own_width,
            false => [file.fl_x, file.fl_y, file.camera_angle_x, file.camera_angle_y],
        };
        let lens = Lens {
            focal: [fl_x, fl_y],
            angle: [camera_angle_x, camera_angle_y],
            centre: [own.cx.or(file.cx), own.cy.or(file.cy)],
            size: [own.w.or(file.w), own.h.or(file.h)],
        };
        if lens.focal.iter().chain(&lens.angle).all(Option::is_none) {
            let what = "missing focal length: expected `fl_x` in pixels or `camera_angle_x` in radians, here or at the top \
                        level";
            return Err(failed(at, what.to_owned()));
        }
        let named = [("fl_x", lens.focal[0], f64::MAX), ("fl_y", lens.focal[1], f64::MAX)];
        let angles = [("camera_angle_x", lens.angle[0], PI), ("camera_angle_y", lens.angle[1], PI)];
        for (name, value, most) in named.into_iter().chain(angles) {
            if value.is_some_and(|v| !(v > 0.0 && v < most)) {
                return Err(failed(at, format!("`{name}` must be above 0 and, if it is an angle, below π")));
            }
        }
        Ok(lens)
    }
}

fn read<T: DeserializeOwned>(value: &Value) -> std::result::Result<T, String> {
    T::deserialize(value).map_err(|error| error.to_string())
}

/// Returns a rigid transform from its rows.
fn rigid(rows: &[Vec<f64>]) -> std::result::Result<Mat4, String> {
    let expected = "`transform_matrix`: expected 4 rows of 4 numbers, from the camera to the world";
    if !(3..=4).contains(&rows.len()) || rows.iter().any(|row| row.len() != 4) {
        return Err(expected.to_owned());
    }
    let column = |j: usize| Vec3::new(rows[0][j], rows[1][j], rows[2][j]);
    let [x, y, z, origin] = [0, 1, 2, 3].map(column);
    let units = [x.dot(x) - 1.0, y.dot(y) - 1.0, z.dot(z) - 1.0, x.dot(y), y.dot(z), z.dot(x)];
    let is_rigid = units.iter().all(|v| v.abs() < ROUNDING) && x.cross(y).dot(z) > 0.0;
    match is_rigid && origin.length() < FARTHEST {
        true => {
            let z = z.normalize();
            let x = y.cross(z).normalize();
            Ok(Mat4::from_axes(x, z.cross(x), z, origin))
        }
        false => {
            Err("`transform_matrix` must be a rotation and a translation, without scale or mirroring"
                .to_owned())
        }
    }
}

/// Returns a light in world space.
fn lamp(value: &Value, world_from_view: &Mat4) -> std::result::Result<Lamp, String> {
    let keys: LightKeys = read(value).map_err(|what| format!("`light`: {what}"))?;
    let intensity = match keys.intensity {
        Some(Intensity::Grey(v)) => Some([v; 3]),
        Some(Intensity::Rgb(v)) => Some(v),
        None => None,
    };
    if intensity
        .is_some_and(|v| v.iter().any(|v| !(v.is_finite() && *v >= 0.0)) || v.iter().sum::<f64>() <= 0.0)
    {
        return Err("`light`: `intensity` must be a number above 0, or three".to_owned());
    }
    let in_camera = keys.space == Space::Camera;
    match (keys.direction, keys.position) {
        (Some(direction), None) => {
            let direction = Vec3::from_array(direction);
            let direction = if in_camera { world_from_view.transform_vector(direction) } else { direction };
            let length = direction.length();
            if !(length.is_finite() && length > 1e-9) {
                return Err("`light`: `direction` must be a vector towards the light".to_owned());
            }
            Ok(Lamp {
                place: LampPlace::Towards(direction / length),
                intensity: intensity.unwrap_or([PI; 3]),
            })
        }
        (None, Some(position)) => {
            let position = Vec3::from_array(position);
            let position = if in_camera { world_from_view.transform_point(position) } else { position };
            if position.length().is_nan() || position.length() > FARTHEST {
                return Err("`light`: `position` must be a point near the model".to_owned());
            }
            let missing = "`light`: a `position` needs an `intensity`: the irradiance at distance 1";
            Ok(Lamp { place: LampPlace::At(position), intensity: intensity.ok_or(missing)? })
        }
        _ => Err("`light`: expected either `direction` or `position`".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(text: &str) -> Result<Transforms> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.png"), b"").unwrap();
        let path = folder.path().join("transforms.json");
        std::fs::write(&path, text).unwrap();
        Transforms::open(&path)
    }

    const POSE: &str = r#""transform_matrix": [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]"#;

    fn why(text: &str) -> String {
        opened(&text.replace("POSE", POSE)).unwrap_err().to_string()
    }

    #[test]
    fn cameras_and_lights_are_read() {
        let light = r#""light": {"position": [0, 0, 1], "intensity": 2, "space": "camera"}"#;
        let text = format!(
            r#"{{"camera_angle_x": 0.7, "k1": 0, "aabb_scale": 4, {light}, "frames": [{{"file_path": "./a", {POSE}}}]}}"#
        );
        let frames = opened(&text).unwrap().frames;
        assert!(frames[0].path.ends_with("a.png"));
        assert_eq!(frames[0].lens.angle, [Some(0.7), None]);
        let lamp = Lamp { place: LampPlace::At(Vec3::new(1.0, 2.0, 4.0)), intensity: [2.0; 3] };
        assert_eq!(frames[0].lamp, lamp);
    }

    #[test]
    fn a_frame_states_its_whole_angle_of_view() {
        let light = r#""light": {"direction": [0, 0, 1]}"#;
        let frame = format!(r#"{{"file_path": "a.png", "mask_path": "a", "camera_angle_x": 0.7, {POSE}}}"#);
        let text = format!(r#"{{"fl_x": 200, "fl_y": 200, "cx": 3, {light}, "frames": [{frame}]}}"#);
        let frames = opened(&text).unwrap().frames;
        let Lens { focal, angle, centre, .. } = frames[0].lens;
        assert_eq!((focal, angle, centre), ([None; 2], [Some(0.7), None], [Some(3.0), None]));
        assert!(frames[0].mask.as_ref().is_some_and(|mask| mask.ends_with("a.png")));
        let missing = text.replace(r#""mask_path": "a""#, r#""mask_path": "b""#);
        assert!(opened(&missing).unwrap_err().to_string().contains("correct `mask_path`"));
    }

    #[test]
    fn a_single_camera_needs_no_photograph() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.json");
        let open = |text: String| {
            std::fs::write(&path, text).unwrap();
            Pose::open(&path)
        };
        let top = open(format!(r#"{{"fl_x": 900, {POSE}}}"#)).unwrap();
        assert_eq!(top.world_from_view.axis(3), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(open(format!(r#"{{"fl_x": 900, "frames": [{{{POSE}}}]}}"#)).unwrap(), top);
        assert!(open("{}".to_owned()).unwrap_err().to_string().contains("`transform_matrix`"));
        assert!(open(format!("{{{POSE}}}")).unwrap_err().to_string().contains("focal length"));
    }

    #[test]
    fn errors_name_the_photograph_and_the_key() {
        let frame =
            |keys: &str| format!(r#"{{"fl_x": 9, "frames": [{{"file_path": "a.png", POSE{keys}}}]}}"#);
        let light = r#", "light": {"direction": [0, 0, 1]}"#;
        assert!(why("{").contains("JSON"));
        assert!(why(r#"{"fl_x": 9}"#).contains("`frames`"));
        assert!(why(&frame("")).contains("frames[0]: missing key `light`"));
        assert!(why(&frame(light).replace("a.png", "b.png")).contains("b.png' does not exist"));
        assert!(why(&frame(light).replace("\"fl_x\": 9", "\"x\": 9")).contains("camera_angle_x"));
        assert!(why(&frame(&format!("{light}, \"k1\": 0.1, \"p2\": 1"))).contains("distortion (k1, p2)"));
        assert!(why(&frame(&format!("{light}, \"camera_model\": \"OPENCV_FISHEYE\""))).contains("undistort"));
        assert!(why(&frame(r#", "light": {"colour": 1}"#)).contains("unknown field"));
        assert!(why(&frame(r#", "light": {"position": [0, 0, 1]}"#)).contains("needs an `intensity`"));
        assert!(why(&frame(r#", "light": {"direction": [0, 0, 0]}"#)).contains("vector towards"));
        let mirrored = POSE.replace("[1, 0, 0, 1]", "[-1, 0, 0, 1]");
        assert!(why(&frame(light).replace("POSE", &mirrored)).contains("rotation"));
        let twice = frame(light)
            .replace("[{", r#"[{"file_path": "a.png", POSE, "light": {"direction": [0, 0, 1]}}, {"#);
        assert!(why(&twice).contains("also frames[0]"));
    }
}
