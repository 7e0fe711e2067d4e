//! Checks of a glTF file before it is read: required extensions, and indices of parts that must exist.

use serde_json::Value;

/// Extensions that may be required: they are read, or affect only light and pictures.
const READ: [&str; 16] = [
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_anisotropy",
    "KHR_materials_dispersion",
    "KHR_xmp_json_ld",
    "KHR_node_visibility",
];
/// Compressions of triangles, by their extensions.
const COMPRESSED: [(&str, &str); 3] = [
    ("KHR_draco_mesh_compression", "Draco"),
    ("EXT_meshopt_compression", "meshopt"),
    ("KHR_meshopt_compression", "meshopt"),
];

/// Members of lists that index other lists.
const NAMES: [(&str, &[&str], &str); 9] = [
    ("scenes", &["nodes"], "nodes"),
    ("nodes", &["children"], "nodes"),
    ("nodes", &["mesh"], "meshes"),
    ("accessors", &["bufferView"], "bufferViews"),
    ("bufferViews", &["buffer"], "buffers"),
    ("textures", &["source"], "images"),
    ("textures", &["sampler"], "samplers"),
    ("images", &["bufferView"], "bufferViews"),
    ("materials", &["pbrMetallicRoughness", "baseColorTexture", "index"], "textures"),
];

/// The document without requirements that are met.
///
/// # Errors
/// One sentence: an extension that is not read, or an index of a part that does not exist.
pub(super) fn checked(json: &[u8]) -> Result<Vec<u8>, String> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let mut root: Value = serde_json::from_slice(json)
        .map_err(|e| format!("its JSON cannot be read ({}); it is damaged or no glTF 2.0", crate::json_fault(&e)))?;
    let required: Vec<String> = strings(root.get("extensionsRequired"));
    for name in &required {
        if let Some((_, what)) = COMPRESSED.iter().find(|(extension, _)| extension == name) {
            return Err(format!(
                "its triangles are compressed with {what} ({name}), which this version does not read; write it without compression, as by gltf-transform or Blender"
            ));
        }
        if !READ.contains(&name.as_str()) {
            return Err(format!(
                "it requires the extension {name:.60}, which this version does not read; write it without"
            ));
        }
    }
    if let Some(root) = root.as_object_mut() {
        root.remove("extensionsRequired");
    }
    for (list, members, of) in NAMES {
        for (k, part) in items(&root, list).iter().enumerate() {
            let named = members.iter().try_fold(part, |at, member| at.get(member));
            check(named, of, &root).map_err(|e| format!("part {k} of its {list} {e}"))?;
        }
    }
    for (k, mesh) in items(&root, "meshes").iter().enumerate() {
        for primitive in mesh.get("primitives").and_then(Value::as_array).into_iter().flatten() {
            let attributes = primitive.get("attributes").and_then(Value::as_object);
            let accessors = attributes.into_iter().flat_map(|a| a.values()).chain(primitive.get("indices"));
            for accessor in accessors {
                check(Some(accessor), "accessors", &root).map_err(|e| format!("mesh {k} {e}"))?;
            }
            check(primitive.get("material"), "materials", &root).map_err(|e| format!("mesh {k} {e}"))?;
        }
    }
    check(root.get("scene"), "scenes", &root).map_err(|e| format!("it {e}"))?;
    root.get_mut("images").and_then(Value::as_array_mut).into_iter().flatten().for_each(complete);
    serde_json::to_vec(&root).map_err(|e| e.to_string())
}

/// Gives a picture the members without which the reader panics: a picture inside the file has a type (its content tells the true one), any
/// other has an address (an empty one is refused where it is read).
fn complete(picture: &mut Value) {
    let Some(picture) = picture.as_object_mut() else { return };
    let lacks = |picture: &serde_json::Map<String, Value>, key: &str| picture.get(key).is_none_or(Value::is_null);
    let (key, value) = if lacks(picture, "bufferView") { ("uri", "data:") } else { ("mimeType", "image/png") };
    if lacks(picture, key) {
        picture.insert(key.into(), value.into());
    }
}

fn items<'r>(root: &'r Value, list: &str) -> &'r [Value] {
    root.get(list).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn strings(list: Option<&Value>) -> Vec<String> {
    let list = list.and_then(Value::as_array).into_iter().flatten();
    list.filter_map(|v| v.as_str().map(str::to_owned)).collect()
}

/// Whether an index, or each of a list, is one of a list of the document.
fn check(named: Option<&Value>, of: &str, root: &Value) -> Result<(), String> {
    let count = items(root, of).len();
    let fine = |v: &Value| v.as_u64().is_some_and(|n| n < count as u64);
    let all = match named {
        None => return Ok(()),
        Some(Value::Array(list)) => list.as_slice(),
        Some(one) => std::slice::from_ref(one),
    };
    match all.iter().find(|v| !fine(v)) {
        Some(v) => Err(format!("names number {v} of {count} {of}; it is damaged")),
        None => Ok(()),
    }
}
