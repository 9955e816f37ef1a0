//! The schema describes every key, and shipped scenes are valid.

use localshape::scene::{Limits, Scene};
use serde_json::Value;

/// Calls `visit` on a schema and all schemas in it, each with its path.
fn walk(schema: &Value, way: &str, visit: &mut dyn FnMut(&str, &Value)) {
    visit(way, schema);
    if let Some(properties) = schema["properties"].as_object() {
        for (key, inner) in properties {
            walk(inner, &format!("{way}.{key}"), visit);
        }
    }
    if schema["items"].is_object() {
        walk(&schema["items"], &format!("{way}[]"), visit);
    }
    for keyword in ["oneOf", "anyOf"] {
        for (at, branch) in schema[keyword].as_array().into_iter().flatten().enumerate() {
            walk(branch, &format!("{way}|{at}"), visit);
        }
    }
}

#[test]
fn every_key_has_a_description_and_nothing_is_null() {
    let schema = localshape::scene::schema();
    let mut keys = 0;
    walk(&schema, "scene", &mut |way, schema| {
        for (key, inner) in schema["properties"].as_object().into_iter().flatten() {
            let description = inner["description"].as_str().unwrap_or_default();
            assert!(description.ends_with('.') && !description.contains('\n'), "{way}.{key}: {description:?}");
            keys += 1;
        }
    });
    assert!(keys > 40, "{keys}");
    assert!(!schema.to_string().contains("null"), "TOML has no null");
}

#[test]
fn it_is_a_schema_of_draft_2020_12_in_one_piece() {
    let schema = localshape::scene::schema();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(schema["title"].is_string() && schema["description"].is_string());
    assert!(!schema.to_string().contains("$ref"));
    assert_eq!(schema["additionalProperties"], false);
    let known = [
        "$schema",
        "title",
        "description",
        "type",
        "format",
        "properties",
        "required",
        "additionalProperties",
        "items",
        "minItems",
        "maxItems",
        "minLength",
        "maxLength",
        "minimum",
        "maximum",
        "exclusiveMinimum",
        "exclusiveMaximum",
        "default",
        "const",
        "enum",
        "oneOf",
        "anyOf",
        "allOf",
        "not",
        "dependentRequired",
        // Of our own: what to write in place of a key of other models.
        "x-instead",
    ];
    let types = ["object", "array", "string", "number", "integer", "boolean"];
    walk(&schema, "scene", &mut |way, schema| {
        for (keyword, value) in schema.as_object().into_iter().flatten() {
            // The validator of scene files supports these keywords only.
            assert!(known.contains(&keyword.as_str()), "{way}: {keyword}");
            assert!(keyword != "type" || types.contains(&value.as_str().unwrap_or_default()), "{way}: {value}");
        }
    });
}

#[test]
fn models_are_listed_with_all_their_parameters() {
    let schema = localshape::scene::schema();
    let models = &schema["properties"]["run"]["items"]["properties"]["model"]["oneOf"];
    let named: Vec<_> =
        models.as_array().into_iter().flatten().map(|model| &model["properties"]["kind"]["const"]).collect();
    assert!(named.contains(&&Value::from("shape-based")) && named.contains(&&Value::from("mass-spring")), "{named:?}");
    for model in models.as_array().into_iter().flatten() {
        let own = |key: &str| model["properties"][key]["exclusiveMinimum"] == 0;
        assert!(own("stiffness") || own("young"), "{model}");
        assert_eq!(model["additionalProperties"], false);
    }
}

#[test]
fn shipped_scenes_hold_against_it() {
    let mut checked = 0;
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            Scene::load(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
            checked += 1;
        }
    }
    assert!(checked > 0);
}
