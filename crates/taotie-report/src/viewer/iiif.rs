//! IIIF manifests of a model's views: the cameras, lights and comments of a scene; and a canvas, for version 3, which
//! has no scenes.

use super::document::PageFile;
use super::views::{Bookmark, Directional, Outline, View, six_digits};
use crate::Fact;
use serde_json::{Value, json};
use std::f64::consts::PI;
use taotie_engine::film::srgb_from_linear;
use taotie_engine::math::Vec3;

/// The JSON-LD contexts of versions 4 and 3 of the Presentation API.
const SCENE_CONTEXT: &str = "http://iiif.io/api/presentation/4/context.json";
const CANVAS_CONTEXT: &str = "http://iiif.io/api/presentation/3/context.json";

/// The names of the manifests.
pub(super) const MANIFESTS: [&str; 2] = ["manifest.json", "manifest-3.json"];

/// The sides of the canvas, whose units have no meaning here.
const SIDE: u32 = 1000;

/// Returns the manifests of a page published at `address`: `manifest.json` for version 4 of the Presentation API, the
/// first with scenes, cameras and lights, and `manifest-3.json` for version 3.
pub(super) fn manifests(outline: &Outline, address: &str) -> [PageFile; 2] {
    let base = format!("{}/", address.trim_end_matches('/'));
    let [of_scene, of_canvas] = MANIFESTS;
    [file(of_scene, &scene_manifest(outline, &base)), file(of_canvas, &canvas_manifest(outline, &base))]
}

fn file(name: &str, content: &Value) -> PageFile {
    PageFile { name: name.into(), bytes: format!("{content:#}\n").into_bytes() }
}

/// Returns the manifest for version 4: a scene with its model, and for each view a camera, lights and a comment.
/// `viewer/src/iiif.ts` writes the same.
fn scene_manifest(outline: &Outline, base: &str) -> Value {
    let scene = Scene { outline, base };
    let links = std::iter::once("").chain(outline.bookmarks.iter().map(|bookmark| bookmark.link.as_str()));
    let views: Vec<View> = links.filter_map(|link| View::of(link, outline)).collect();
    let painted = views.iter().enumerate().flat_map(|(number, view)| scene.painted(number, view));
    let mut shown = json!({
        "id": scene.id(),
        "type": "Scene",
        "label": label(&outline.title),
        "items": [{
            "id": format!("{base}scene/page"),
            "type": "AnnotationPage",
            "items": std::iter::once(scene.model()).chain(painted).collect::<Vec<_>>(),
        }],
    });
    if views.len() > 1 {
        let views = views.iter().enumerate().skip(1);
        shown["annotations"] = json!([{
            "id": format!("{base}scene/comments"),
            "type": "AnnotationPage",
            "items": views.flat_map(|(number, view)| scene.commented(number, view)).collect::<Vec<_>>(),
        }]);
    }
    let mut all = json!({
        "@context": SCENE_CONTEXT,
        "id": format!("{base}manifest.json"),
        "type": "Manifest",
        "label": label(&outline.title),
        "items": [shown],
    });
    if !outline.facts.is_empty() {
        all["metadata"] = outline.metadata().into();
    }
    all
}

/// The scene to which annotations are added. The first view is shown initially; others are hidden until their comment
/// is selected.
struct Scene<'a> {
    outline: &'a Outline,
    base: &'a str,
}

impl Scene<'_> {
    fn id(&self) -> String {
        format!("{}scene", self.base)
    }

    fn model(&self) -> Value {
        json!({
            "id": format!("{}scene/model", self.base),
            "type": "Annotation",
            "motivation": ["painting"],
            "body": [{ "id": format!("{}asset.glb", self.base), "type": "Model", "format": "model/gltf-binary" }],
            "target": [{ "id": self.id(), "type": "Scene" }],
        })
    }

    /// Returns the camera and the lights of a view.
    fn painted(&self, number: usize, view: &View) -> Vec<Value> {
        let camera = json!({
            "id": format!("{}scene/views/{number}/camera", self.base),
            "type": "PerspectiveCamera",
            "fieldOfView": six_digits(view.fov_y),
            "lookAt": point(view.target),
        });
        let mut all = vec![self.annotation(number, camera, view.eye)];
        all.extend(view.lights.iter().enumerate().map(|(i, light)| self.light([number, i], light)));
        let (color, intensity) = colored(view.fill, 1.0);
        if intensity > 0.0 {
            let id = format!("{}scene/views/{number}/fill", self.base);
            let fill = json!({
                "id": id, "type": "AmbientLight", "color": color, "intensity": relative(intensity)
            });
            all.push(self.annotation(number, fill, self.center()));
        }
        all
    }

    fn light(&self, [number, i]: [usize; 2], light: &Directional) -> Value {
        // A white matte surface facing a light of strength π reflects the maximum that a screen can show.
        let (color, intensity) = colored(light.color, PI);
        let body = json!({
            "id": format!("{}scene/views/{number}/light/{i}", self.base),
            "type": "DirectionalLight",
            "color": color,
            "intensity": relative(intensity),
            "lookAt": point(self.center()),
        });
        let radius = self.outline.camera.map_or(1.0, |camera| camera.radius);
        self.annotation(number, body, self.center() + light.to * (2.0 * radius))
    }

    /// Returns an annotation that adds something to the scene.
    fn annotation(&self, number: usize, body: Value, place: Vec3<f64>) -> Value {
        let id = format!("{}/annotation", body["id"].as_str().unwrap_or_default());
        let mut made = json!({
            "id": id,
            "type": "Annotation",
            "motivation": ["painting"],
            "body": [body],
            "target": [self.target(&format!("{id}/target"), place)],
        });
        if number > 0 {
            made["behavior"] = json!(["hidden"]);
        }
        made
    }

    /// Returns the comment of a view, and the annotation that shows the view when the comment is selected.
    fn commented(&self, number: usize, view: &View) -> [Value; 2] {
        let id = format!("{}scene/comments/{number}", self.base);
        let text = self.outline.bookmarks.get(number - 1).map(comment);
        let shown = |source: &Value| {
            json!({
                "id": format!("{}/shown", source["id"].as_str().unwrap_or_default()),
                "type": "SpecificResource",
                "source": [{ "id": source["id"], "type": "Annotation" }],
                "action": ["show", "enable", "select"],
            })
        };
        let comment = json!({
            "id": id,
            "type": "Annotation",
            "motivation": ["commenting"],
            "body": [{ "type": "TextualBody", "value": text, "format": "text/plain" }],
            "target": [self.target(&format!("{id}/target"), view.target)],
        });
        let activating = json!({
            "id": format!("{id}/view"),
            "type": "Annotation",
            "motivation": ["activating"],
            "body": self.painted(number, view).iter().map(shown).collect::<Vec<_>>(),
            "target": [{ "id": id, "type": "Annotation" }],
        });
        [comment, activating]
    }

    /// Returns a position in the scene.
    fn target(&self, id: &str, place: Vec3<f64>) -> Value {
        json!({
            "id": id,
            "type": "SpecificResource",
            "source": { "id": self.id(), "type": "Scene" },
            "selector": [point(place)],
        })
    }

    fn center(&self) -> Vec3<f64> {
        self.outline.camera.map_or(Vec3::splat(0.0), |camera| Vec3::from_array(camera.center))
    }
}

fn point(place: Vec3<f64>) -> Value {
    let [x, y, z] = place.to_array().map(six_digits);
    json!({ "type": "PointSelector", "x": x, "y": y, "z": z })
}

fn relative(intensity: f64) -> Value {
    json!({ "type": "Quantity", "quantityValue": six_digits(intensity), "unit": "relative" })
}

/// Returns a light's colour in sRGB, scaled so that its strongest channel is full, and its intensity relative to
/// `full`, at most 1.
fn colored(light: [f64; 3], full: f64) -> (String, f64) {
    let most = light.into_iter().fold(0.0, f64::max);
    let code = |channel: f64| {
        let linear = if most > 0.0 { channel / most } else { 1.0 };
        (255.0 * srgb_from_linear(linear)).round() as u8
    };
    let [r, g, b] = light.map(code);
    (format!("#{r:02X}{g:02X}{b:02X}"), (most / full).min(1.0))
}

/// Returns the manifest for version 3, which has models but no scenes: a canvas represents the model.
fn canvas_manifest(outline: &Outline, base: &str) -> Value {
    let canvas = format!("{base}canvas");
    let page = json!({
        "id": format!("{base}index.html"),
        "type": "Text",
        "label": label(&outline.title),
        "format": "text/html",
    });
    let mut shown = json!({
        "id": canvas,
        "type": "Canvas",
        "label": label(&outline.title),
        "width": SIDE,
        "height": SIDE,
        "items": [{
            "id": format!("{base}canvas/page"),
            "type": "AnnotationPage",
            "items": [{
                "id": format!("{base}canvas/model"),
                "type": "Annotation",
                "motivation": "painting",
                "body": { "id": format!("{base}asset.glb"), "type": "Model", "format": "model/gltf-binary" },
                "target": canvas,
            }],
        }],
    });
    if !outline.bookmarks.is_empty() {
        let comments = outline.bookmarks.iter().enumerate();
        shown["annotations"] = json!([{
            "id": format!("{base}canvas/comments"),
            "type": "AnnotationPage",
            "items": comments.map(|(i, bookmark)| canvas_comment(i + 1, bookmark, base)).collect::<Vec<_>>(),
        }]);
    }
    let mut all = json!({
        "@context": CANVAS_CONTEXT,
        "id": format!("{base}manifest-3.json"),
        "type": "Manifest",
        "label": label(&outline.title),
        "rendering": [page],
        "items": [shown],
    });
    if !outline.facts.is_empty() {
        all["metadata"] = outline.metadata().into();
    }
    all
}

/// Returns a comment with the link to its view.
fn canvas_comment(number: usize, bookmark: &Bookmark, base: &str) -> Value {
    let text = format!("{}\n{base}index.html#{}", comment(bookmark), bookmark.link);
    json!({
        "id": format!("{base}canvas/comments/{number}"),
        "type": "Annotation",
        "motivation": "commenting",
        "body": { "type": "TextualBody", "value": text, "format": "text/plain" },
        "target": format!("{base}canvas"),
    })
}

impl Outline {
    /// Returns the facts about the model as label–value pairs.
    fn metadata(&self) -> Vec<Value> {
        let pair = |fact: &Fact| json!({ "label": label(&fact.name), "value": label(&fact.value) });
        self.facts.iter().map(pair).collect()
    }
}

/// Returns a language map for a text without a language.
fn label(text: &str) -> Value {
    json!({ "none": [text] })
}

/// Joins a bookmark's title and text.
fn comment(bookmark: &Bookmark) -> String {
    [bookmark.title.as_str(), bookmark.text.as_str()].join("\n").trim().to_owned()
}
