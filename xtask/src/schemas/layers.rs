//! The schemas of a material's layers, whose factors are a table of the engine.

use super::document::or_null;
use serde_json::{Map, Value, json};
use taotie_engine::image::Encoding;
use taotie_engine::scene::{FactorValue, LAYERS, Layer, Light, Material};

/// Returns the schema of each layer by name.
pub fn properties() -> Value {
    LAYERS.iter().map(|layer| (layer.key().to_owned(), schema(layer))).collect::<Map<_, _>>().into()
}

fn schema(layer: &Layer) -> Value {
    let mut material = Material::default();
    (layer.add)(&mut material);
    let mut properties = Map::new();
    for factor in layer.factors {
        let number = |most: f32| json!({ "type": "number", "minimum": 0, "maximum": most });
        let (unit, mut schema) = match (factor.get)(&material) {
            // Readers accept brighter colours than glTF allows.
            Some(FactorValue::Color(_)) => {
                let items = number(Light::MOST);
                ("", json!({ "type": "array", "items": items, "minItems": 3, "maxItems": 3 }))
            }
            Some(FactorValue::Angle(_)) => ("_deg", json!({ "type": "number" })),
            _ => ("", number(factor.most)),
        };
        schema["description"] =
            format!("The {}, `{}` of {}.", factor.name, factor.member, layer.extension).into();
        properties.insert(format!("{}{unit}", factor.field), schema);
    }
    if layer.textures.iter().any(|role| role.encoding() == Encoding::Normal) {
        let mut scale = or_null(json!({ "type": "number" }));
        scale["description"] = "The factor of its normal map; `null` without one.".into();
        properties.insert("normal_scale".into(), scale);
    }
    let required: Vec<&String> = properties.keys().collect();
    let object = json!({ "type": "object", "required": required, "properties": properties, "additionalProperties": false });
    let mut schema = if layer.is_optional() { or_null(object) } else { object };
    schema["description"] = format!("The {}, {}.", layer.name, layer.extension).into();
    schema
}
