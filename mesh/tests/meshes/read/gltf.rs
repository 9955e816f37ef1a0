//! Numbers, nodes, skins and extensions of glTF.

use super::{LIMITS, file, refusal, surface};
use glam::{DQuat, DVec3};
use localshape_mesh::{Format, Limits, Mesh, ReadError, Surface, read_cells, read_cells_with};

/// A glTF file of some parts of its document, with its data in a file beside it.
fn gltf(parts: &str, length: usize) -> String {
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"buffers\": [{{\"byteLength\": {length}, \"uri\": \"a%20b.bin\"}}], {parts}}}"
    )
}

/// Reads it with these bytes in that file.
fn with_data(parts: &str, data: &[u8]) -> Result<Surface, ReadError> {
    let text = gltf(parts, data.len());
    let mut names = Vec::new();
    let mut beside = |name: &str| {
        names.push(name.to_owned());
        Ok(data.to_vec())
    };
    let cells = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut beside);
    assert!(names.is_empty() || names == ["a b.bin"], "{names:?}");
    match cells?.mesh(Format::Gltf)? {
        Mesh::Surface(surface) => Ok(surface),
        other => panic!("{other:?}"),
    }
}

/// Parts of a document whose accessors are triangles of three points in this notation, the first of them positions.
fn parts(accessors: &str, views: &str, primitive: &str, rest: &str) -> String {
    format!(
        "\"accessors\": [{accessors}], \"bufferViews\": [{views}], \
         \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0{primitive}]{rest}"
    )
}

const NODE: &str = "}], \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]";

#[test]
fn numbers_of_gltf_have_every_type() {
    let (one, most) = (DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 100.0));
    let points = [DVec3::ZERO, one, most];
    for (kind, size, largest) in
        [(5120, 1, 127.0), (5121, 1, 255.0), (5122, 2, 32767.0), (5123, 2, 65535.0), (5126, 4, 1.0)]
    {
        for normalized in [false, true] {
            // A view that begins at byte 8, with numbers from byte 4 of it on and rows of 24 bytes.
            let mut data = vec![0xee; 8 + 4 + 3 * 24];
            for (row, point) in points.iter().enumerate() {
                for (column, value) in point.to_array().into_iter().enumerate() {
                    let number = match kind {
                        5120 | 5121 => vec![value as u8],
                        5122 | 5123 => (value as u16).to_le_bytes().to_vec(),
                        _ => (value as f32).to_le_bytes().to_vec(),
                    };
                    let at = 12 + 24 * row + size * column;
                    data[at..at + size].copy_from_slice(&number);
                }
            }
            let accessor = format!(
                "{{\"bufferView\": 0, \"byteOffset\": 4, \"componentType\": {kind}, \"normalized\": {normalized}, \"count\": 3, \"type\": \"VEC3\"}}"
            );
            let view =
                format!("{{\"buffer\": 0, \"byteOffset\": 8, \"byteLength\": {}, \"byteStride\": 24}}", data.len() - 8);
            let found = with_data(&parts(&accessor, &view, "}}", NODE), &data).expect("sound");
            let scale = if normalized { 1.0 / largest } else { 1.0 };
            let is_near = |(found, expected): (&DVec3, &DVec3)| found.distance(*expected * scale) < 1e-12;
            assert!(found.points.iter().zip(&points).all(is_near), "{kind} {normalized}: {:?}", found.points);
        }
    }
    // There is one more integer below zero than above.
    let accessor =
        "{\"bufferView\": 0, \"componentType\": 5120, \"normalized\": true, \"count\": 3, \"type\": \"VEC3\"}";
    let view = "{\"buffer\": 0, \"byteLength\": 12, \"byteStride\": 4}";
    let found = with_data(&parts(accessor, view, "}}", NODE), &[0x80, 0x81, 0x7f, 0].repeat(3)).expect("sound");
    assert_eq!(found.points[0], DVec3::new(-1.0, -1.0, 1.0));
    // Indices of every type, and what lists of corners mean.
    let positions: Vec<u8> =
        (0..5).flat_map(|at| [at as f32, (at * at) as f32, 1.0]).flat_map(f32::to_le_bytes).collect();
    for (kind, size) in [(5121, 1), (5123, 2), (5125, 4)] {
        for (mode, expected) in [
            (4, vec![[4, 0, 3]]),
            (5, vec![[4, 0, 3], [3, 0, 1], [3, 1, 2]]),
            (6, vec![[4, 0, 3], [4, 3, 1], [4, 1, 2]]),
        ] {
            let mut data = positions.clone();
            [4u32, 0, 3, 1, 2].iter().for_each(|index| data.extend(&index.to_le_bytes()[..size]));
            let accessors = format!(
                "{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 5, \"type\": \"VEC3\"}}, \
                 {{\"bufferView\": 1, \"componentType\": {kind}, \"count\": 5, \"type\": \"SCALAR\"}}"
            );
            let views = format!(
                "{{\"buffer\": 0, \"byteLength\": 60}}, {{\"buffer\": 0, \"byteOffset\": 60, \"byteLength\": {}}}",
                5 * size
            );
            let primitive = format!("}}, \"indices\": 1, \"mode\": {mode}}}");
            let mut cells = None;
            let text = gltf(&parts(&accessors, &views, &primitive, NODE), data.len());
            let found =
                read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |_| Ok(data.clone())).expect("sound");
            let found: Vec<_> =
                cells.insert(found).corners.iter().map(|corners| [corners[0], corners[1], corners[2]]).collect();
            assert_eq!(found, expected, "{kind} {mode}");
        }
    }
}

/// Three points in single precision and their description.
fn three() -> (Vec<u8>, &'static str, &'static str) {
    let data = [[1.0f32, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    (
        data.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect(),
        "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}",
        "{\"buffer\": 0, \"byteLength\": 36}",
    )
}

#[test]
fn nodes_of_gltf_turn_by_their_rotation_whatever_its_length() {
    let (data, accessor, view) = three();
    let turn = DQuat::from_xyzw(0.5, -0.5, 0.5, 0.5);
    for length in [1.0, 2.0, 0.001] {
        let [x, y, z, w] = (turn * length).to_array();
        let nodes = format!(
            "}}], \"scenes\": [{{\"nodes\": [1]}}], \"nodes\": [{{\"mesh\": 0, \"scale\": [2, 3, 4]}}, \
             {{\"children\": [0], \"rotation\": [{x}, {y}, {z}, {w}], \"translation\": [10, 20, 30]}}]"
        );
        let found = with_data(&parts(accessor, view, "}}", &nodes), &data).expect("sound");
        let expected =
            [2.0 * DVec3::X, 6.0 * DVec3::Y, 12.0 * DVec3::Z].map(|at| turn * at + DVec3::new(10.0, 20.0, 30.0));
        assert!(
            found.points.iter().zip(expected).all(|(found, at)| found.distance(at) < 1e-5),
            "{length}: {:?}",
            found.points
        );
    }
    // By columns.
    let nodes = "}], \"nodes\": [{\"mesh\": 0, \"matrix\": [0, 1, 0, 0, -2, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]}]";
    let found = with_data(&parts(accessor, view, "}}", nodes), &data).expect("sound");
    assert_eq!(found.points, [DVec3::new(7.0, 9.0, 9.0), DVec3::new(3.0, 8.0, 9.0), DVec3::new(7.0, 8.0, 12.0)]);
}

#[test]
fn joints_place_the_points_of_a_skin() {
    let (data, ..) = three();
    let (bytes, format) = file("skinned.gltf");
    let found = surface(&bytes, format);
    let (low, high) = localshape_sim::geometry::bounds(&found.points);
    assert_eq!(
        (low, high),
        (DVec3::new(0.0, 5.0, 0.0), DVec3::new(2.0, 6.0, 3.0)),
        "its joint moves it, its node does not"
    );
    // Two joints, the second below the first, with inverse matrices, weights as bytes whose sum is not 1, and a second set of joints.
    let mut data = data;
    let identity = [1.0f32, 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let mut moved = identity;
    moved[12] = -4.0;
    identity.iter().chain(&moved).for_each(|number| data.extend(number.to_le_bytes()));
    // The first point follows both joints alike, the second the first, the third the second by its second set.
    data.extend([0u8, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    data.extend([100u8, 100, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0]);
    data.extend([0u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0]);
    data.extend([0u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 50, 0]);
    let accessors = "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}, \
        {\"bufferView\": 1, \"componentType\": 5126, \"count\": 2, \"type\": \"MAT4\"}, \
        {\"bufferView\": 2, \"componentType\": 5121, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 12, \"componentType\": 5121, \"normalized\": true, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 24, \"componentType\": 5121, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 36, \"componentType\": 5121, \"normalized\": true, \"count\": 3, \"type\": \"VEC4\"}";
    let views = "{\"buffer\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 128}, \
        {\"buffer\": 0, \"byteOffset\": 164, \"byteLength\": 48}";
    let primitive = ", \"JOINTS_0\": 2, \"WEIGHTS_0\": 3, \"JOINTS_1\": 4, \"WEIGHTS_1\": 5}}";
    let nodes = "}], \"skins\": [{\"joints\": [1, 2], \"inverseBindMatrices\": 1}], \"scenes\": [{\"nodes\": [0, 1]}], \
        \"nodes\": [{\"mesh\": 0, \"skin\": 0, \"scale\": [9, 9, 9]}, {\"children\": [2], \"translation\": [0, 10, 0]}, \
        {\"translation\": [4, 0, 0], \"scale\": [1, 1, 2]}]";
    let whole = parts(accessors, views, primitive, nodes);
    let found = with_data(&whole, &data).expect("sound");
    // The second joint moves (x, y, z) to (x − 4 + 4, y + 10, 2z).
    assert_eq!(found.points, [DVec3::new(1.0, 10.0, 0.0), DVec3::new(0.0, 12.0, 0.0), DVec3::new(0.0, 10.0, 6.0)]);
    let told = |text: &str, data: &[u8]| with_data(text, data).expect_err("a refusal").message;
    let without = whole.replace(", \"JOINTS_1\": 4, \"WEIGHTS_1\": 5", "");
    assert_eq!(told(&without, &data), "has point 2 of a part without weights, which its skin needs");
    let few = whole.replace("\"joints\": [1, 2]", "\"joints\": [1]");
    assert_eq!(told(&few, &data), "names joint 1 of a skin with 1 joints");
    let outside = whole.replace("\"scenes\": [{\"nodes\": [0, 1]}]", "\"scenes\": [{\"nodes\": [0]}]");
    assert_eq!(told(&outside, &data), "has the joint 1 of its skin 0 outside of its scene");
    let fewer = whole.replace("\"count\": 2, \"type\": \"MAT4\"", "\"count\": 1, \"type\": \"MAT4\"");
    assert_eq!(told(&fewer, &data), "has 1 inverse matrices for 2 joints of its skin 0");
}

#[test]
fn weights_of_nodes_come_before_those_of_meshes() {
    let (mut data, ..) = three();
    let moves = [[1.0f32, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
    moves.as_flattened().iter().for_each(|number| data.extend(number.to_le_bytes()));
    let accessor =
        |view: usize| format!("{{\"bufferView\": {view}, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}}");
    let accessors = format!("{}, {}", accessor(0), accessor(1));
    let views = "{\"buffer\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 36}";
    let primitive = "}, \"targets\": [{\"POSITION\": 0}, {\"NORMAL\": 1}, {\"POSITION\": 1}]}";
    let found = |mesh: &str, node: &str| {
        let rest = format!(", \"weights\": {mesh}}}], \"nodes\": [{{\"mesh\": 0{node}}}]");
        with_data(&parts(&accessors, views, primitive, &rest), &data).expect("sound").points
    };
    let expected = |first: f64, third: f64| {
        let third = [DVec3::X, DVec3::ZERO, 5.0 * DVec3::Y].map(|moves| third * moves);
        let at = [DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z].map(|at| (1.0 + first) * at);
        [0, 1, 2].map(|point| at[point] + third[point])
    };
    assert_eq!(found("[0, 0, 0]", ""), expected(0.0, 0.0));
    assert_eq!(found("[0.5, 7, 2]", ""), expected(0.5, 2.0));
    assert_eq!(found("[0.5, 7, 2]", ", \"weights\": [0, 0, 0.25]"), expected(0.0, 0.25));
}

#[test]
fn extensions_that_are_needed_are_honoured_or_refused() {
    let (data, accessor, view) = three();
    let told = |keys: &str| match with_data(&format!("{keys}, {}", parts(accessor, view, "}}", NODE)), &data) {
        Ok(found) => format!("{} triangle", found.triangles.len()),
        Err(ReadError { message, help }) => format!("{message} ({})", help.expect("a remedy")),
    };
    for known in ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"] {
        assert_eq!(told(&format!("\"extensionsRequired\": [\"{known}\"]")), "1 triangle");
    }
    assert_eq!(told("\"extensionsUsed\": [\"KHR_node_visibility\"]"), "1 triangle");
    let expected =
        "needs extensions that are not read: `ABC_other`, `EXT_mesh_gpu_instancing` (export it again without";
    let keys = "\"extensionsUsed\": [\"EXT_mesh_gpu_instancing\"], \"extensionsRequired\": [\"KHR_xmp\", \"EXT_mesh_gpu_instancing\", \"ABC_other\"]";
    assert!(told(keys).starts_with(expected), "{}", told(keys));
    assert!(
        told("\"extensionsUsed\": [\"EXT_mesh_gpu_instancing\"]")
            .starts_with("needs extensions that are not read: `EXT_mesh")
    );
    let packed = told("\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]");
    assert!(packed.starts_with("needs extensions that are not read: `KHR_draco_mesh_compression` (export"), "{packed}");
}

#[test]
fn an_empty_scene_shows_nothing() {
    let (data, accessor, view) = three();
    let scene = |scenes: &str| {
        let rest = format!("}}], \"scene\": 0, \"scenes\": {scenes}, \"nodes\": [{{\"mesh\": 0}}]");
        with_data(&parts(accessor, view, "}}", &rest), &data)
    };
    for empty in ["[{}]", "[{\"nodes\": []}]", "[{}, {\"nodes\": [0]}]"] {
        let error = scene(empty).expect_err("nothing");
        assert_eq!(error.message, "shows nothing: no node of its scene has a mesh of triangles");
    }
    assert_eq!(scene("[{\"nodes\": [0]}, {}]").expect("sound").triangles.len(), 1);
    // As a binary file.
    let json = gltf(&parts(accessor, view, "}}", "}], \"scenes\": [{}], \"nodes\": [{\"mesh\": 0}]"), data.len());
    let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
    let lengths = [2, 20 + json.len() as u32, json.len() as u32].map(u32::to_le_bytes);
    let glb = [b"glTF", &lengths[0][..], &lengths[1], &lengths[2], b"JSON", json.as_bytes()].concat();
    let found = read_cells_with(&glb, Format::Gltf, &LIMITS, &mut |_| Ok(data.clone()));
    assert!(found.expect_err("nothing").message.starts_with("shows nothing"));
}

#[test]
fn data_of_gltf_may_be_beside_it_and_nowhere_else() {
    let (data, accessor, view) = three();
    let named = |uri: &str| {
        let text = gltf(&parts(accessor, view, "}}", NODE), data.len()).replace("a%20b.bin", uri);
        let mut asked = Vec::new();
        let found = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |name| {
            asked.push(name.to_owned());
            Ok(data.clone())
        });
        (asked.pop(), found.err().map(|error| error.message))
    };
    for (uri, name) in [
        ("a.bin", "a.bin"),
        ("my%20box%c3%bc.bin", "my boxü.bin"),
        ("parts/my box.bin", "parts/my box.bin"),
        ("parts\\\\a.bin", "parts/a.bin"),
        ("parts%5Ca.bin", "parts/a.bin"),
        ("100%.bin", "100%.bin"),
        ("%+f%zz.bin", "%+f%zz.bin"),
        ("a%2fb.bin", "a/b.bin"),
        ("..a/b..", "..a/b.."),
    ] {
        assert_eq!(named(uri), (Some(name.to_owned()), None), "{uri}");
    }
    for uri in [
        "../a.bin",
        "a/../../b.bin",
        "%2e%2e/a.bin",
        "/etc/passwd",
        "%2Fetc",
        "\\\\\\\\host\\\\a",
        "a\\\\..\\\\b",
        "//host/a",
    ] {
        let (asked, error) = named(uri);
        assert!(
            asked.is_none() && error.expect("a refusal").starts_with("has its data outside of its folder, `"),
            "{uri}"
        );
    }
    for uri in ["http://host/a.bin", "HTTPS://host/a.bin", "file:///etc/passwd", "file%3A/a", "c:/a.bin", "x-a+b.c:d"] {
        let (asked, error) = named(uri);
        assert!(asked.is_none() && error.expect("a refusal").starts_with("has its data by an address, `"), "{uri}");
    }
    // A file alone, a file that is not there, and one that is too short.
    let text = gltf(&parts(accessor, view, "}}", NODE), data.len());
    assert_eq!(
        refusal(text.as_bytes(), Format::Gltf),
        "has its data in `a b.bin`, which is another file (export all as one file)"
    );
    let missing = |_: &str| Err(ReadError { message: "is not there".to_owned(), help: None });
    let error = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut { missing }).expect_err("missing");
    assert_eq!(error.message, "has its data in `a b.bin`, which is not there");
    let short = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |_| Ok(vec![0; 35])).expect_err("short");
    assert_eq!(short.message, "has data beyond the end of its buffer 0");
}

/// Parts that share a list are read as often as they are named, within bounds.
#[test]
fn lists_named_again_and_again_are_refused() {
    let (data, accessor, view) = three();
    let targets = vec!["{\"POSITION\": 0}"; 2000].join(", ");
    let weights = vec!["1"; 2000].join(", ");
    let rest = format!(", \"weights\": [{weights}]}}], \"nodes\": [{{\"mesh\": 0}}]");
    let text = gltf(&parts(accessor, view, &format!("}}, \"targets\": [{targets}]}}"), &rest), data.len());
    let limits = Limits { points: 10, corners: 100 };
    let error =
        read_cells_with(text.as_bytes(), Format::Gltf, &limits, &mut |_| Ok(data.clone())).expect_err("a limit");
    assert!(error.message.starts_with("has 3 entries in its list 0; at most "), "{error}");
}

#[test]
fn only_the_first_buffer_of_gltf_is_the_data_of_the_file() {
    let (bytes, format) = file("cubes.glb");
    let text = String::from_utf8_lossy(&bytes[20..]);
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let json = text[..length].trim_end().replacen(
        "\"buffers\": [",
        "\"buffers\": [{\"byteLength\":1,\"uri\":\"data:a;base64,AA==\"},",
        1,
    );
    assert_ne!(json.len(), length, "it has a list of buffers");
    let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
    let rest = &bytes[20 + length..];
    let total = (20 + json.len() + rest.len()) as u32;
    let file = [&bytes[..8], &total.to_le_bytes(), &(json.len() as u32).to_le_bytes(), b"JSON", json.as_bytes(), rest];
    assert!(refusal(file.concat(), format).starts_with("has no data for its buffer 1 "));
}

/// A list without data of its own is of zeros, however long it says that it is.
#[test]
fn lists_of_gltf_are_not_longer_than_its_data() {
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:a;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[
        {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"componentType":5125,"count":9,"type":"SCALAR","sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0,"byteOffset":4}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}"#;
    let found = refusal(json.replacen("\"count\":9", "\"count\":7999998", 1).as_bytes(), Format::Gltf);
    let expected =
        "has 7999998 entries in its list 1, which has no data of its own; expected at most 36, the bytes of its";
    assert!(found.starts_with(expected), "{found}");
    assert!(read_cells(json.as_bytes(), Format::Gltf, &LIMITS).is_ok());
}

/// A triangle at each of three nodes, the last below the second; the parts of the nodes and of `asset` are given.
fn nodes(asset: &str, second: &str, rest: &str) -> String {
    format!(
        r#"{{"asset":{{{asset}}},"buffers":[{{"byteLength":36,"uri":"data:a;base64,AAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"scenes":[{{"nodes":[0,1]}}],
        "nodes":[{{"mesh":0}},{{"mesh":0,"children":[2]{second}}},{{"mesh":0}}]{rest}}}"#
    )
}

#[test]
fn hidden_nodes_of_gltf_are_left_out_with_those_below() {
    let visible = |visible: &str| format!(r#","extensions":{{"KHR_node_visibility":{{"visible":{visible}}}}}"#);
    let (version, used) = (r#""version":"2.0""#, r#","extensionsUsed":["KHR_node_visibility"]"#);
    let required = format!(r#"{used},"extensionsRequired":["KHR_node_visibility"]"#);
    for rest in [used, &required] {
        let found = surface(nodes(version, &visible("false"), rest), Format::Gltf);
        assert_eq!(found.triangles.len(), 1);
        assert_eq!(found.notes, ["has meshes that it hides (KHR_node_visibility), which are left out: 2"]);
        for second in ["", &visible("true"), &visible("0"), r#","extensions":{"KHR_node_visibility":{}}"#] {
            let found = surface(nodes(version, second, rest), Format::Gltf);
            assert_eq!((found.triangles.len(), found.notes.len()), (3, 0), "{second}");
        }
    }
}

/// Later files of the same major version are read as 2.0 unless they name another least version.
#[test]
fn gltf_of_later_versions_is_refused() {
    for asset in [r#""version":"2.0""#, r#""version":"2.1""#, r#""version":"2.1","minVersion":"2.0""#] {
        assert_eq!(surface(nodes(asset, "", ""), Format::Gltf).triangles.len(), 3, "{asset}");
    }
    for (asset, version) in [
        (r#""version":"3.0""#, "3.0"),
        (r#""version":"3.0","minVersion":"2.1""#, "2.1"),
        (r#""version":"2.1","minVersion":"2.1""#, "2.1"),
        (r#""version":"20.1""#, "20.1"),
    ] {
        let expected =
            format!("is a glTF file of the version `{version}`; expected 2.0 (export it again as glTF 2.0 (.glb))");
        assert_eq!(refusal(nodes(asset, "", ""), Format::Gltf), expected);
    }
}
