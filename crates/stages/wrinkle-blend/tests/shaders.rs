//! The printed shader code: what the files hold, whether compilers take it, and whether it computes what the library does.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use proptest::prelude::*;
use std::path::Path;
use wrinkle_blend::shader::{Language, Value, evaluate, text};
use wrinkle_blend::{Atlas, Blended, MapBlender, Modulation, NormalMap};

fn number(function: &str, arguments: &[Value]) -> f32 {
    match evaluate(function, arguments) {
        Some(Value::Float(number)) => number,
        other => panic!("{function}: {other:?}"),
    }
}

fn vector(function: &str, arguments: &[Value]) -> [f32; 3] {
    match evaluate(function, arguments) {
        Some(Value::Vec3(vector)) => vector,
        other => panic!("{function}: {other:?}"),
    }
}

/// `FURROW_WRITE_SHADERS=1` writes them.
#[test]
fn the_files_are_what_is_printed() {
    for language in Language::ALL {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("shaders/wrinkles.{}", language.ending()));
        if std::env::var("FURROW_WRITE_SHADERS").is_ok_and(|value| value == "1") {
            std::fs::write(&path, text(language)).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == text(language), "{}: run this test with FURROW_WRITE_SHADERS=1", path.display());
    }
}

fn validated(module: &naga::Module) {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(module).unwrap();
}

#[test]
fn compilers_take_it() {
    let wgsl = text(Language::Wgsl);
    let module =
        naga::front::wgsl::parse_str(&wgsl).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&wgsl)));
    assert_eq!(module.functions.len(), 9);
    validated(&module);
    let glsl = format!("#version 450\n{}\nvoid main() {{}}\n", text(Language::Glsl));
    let options = naga::front::glsl::Options::from(naga::ShaderStage::Fragment);
    let module = naga::front::glsl::Frontend::default()
        .parse(&options, &glsl)
        .unwrap_or_else(|error| panic!("{error:?}"));
    validated(&module);
}

proptest! {
    #[test]
    fn shares_are_those_of_the_paper(ab in [-9.0..9.0f32, -9.0..9.0, -9.0..9.0], ac in [-9.0..9.0f32, 1.0..9.0, -9.0..9.0], x in 0.0..1.0f64, weight in 0.0..1.0f64) {
        let dot: f32 = (0..3).map(|axis| ab[axis] * ac[axis]).sum();
        let square: f32 = ac.iter().map(|x| x * x).sum();
        let found = number("bone_share", &[Value::Vec3(ab), Value::Vec3(ac)]);
        prop_assert!((found - (dot / square).clamp(0.0, 1.0)).abs() < 1e-5);
        let found = number("modulation", &[Value::Float(x as f32)]);
        prop_assert!((f64::from(found) - Modulation::Cosine.at(x)).abs() < 1e-6);
        let s = (4.0 * weight).min(1.0);
        let found = number("bone_counts", &[Value::Float(weight as f32)]);
        prop_assert!((f64::from(found) - s * s * (3.0 - 2.0 * s)).abs() < 1e-5);
        prop_assert_eq!(number("bone_counts_paper", &[Value::Float(1.0 / 255.0)]), 1.0);
        prop_assert_eq!(number("bone_counts_paper", &[Value::Float(0.0)]), 0.0);
    }

    /// The shader's normal is the blended map's, within a code of 8 bits.
    #[test]
    fn normals_are_those_of_the_maps(codes in proptest::collection::vec(any::<u8>(), 9), w1 in 0.0..1.0f32, w2 in 0.0..1.0f32) {
        let map = |at: usize| NormalMap::from_8_bits("map", 1, 1, &codes[3 * at..3 * at + 3]).unwrap();
        let atlas = Atlas::new(&scene::character().meshes[0], [1, 1], 0).unwrap();
        let blender = MapBlender::new(map(0), vec![map(1), map(2)], 8).unwrap();
        let Blended::Bits8(found) = blender.blend(&atlas, &[[w1; 25], [w2; 25]].concat()) else { panic!("8 bits") };
        let decoded = |at: usize| {
            let texel = std::array::from_fn(|axis| f32::from(codes[3 * at + axis]) / 255.0);
            Value::Vec3(vector("decode_normal", &[Value::Vec3(texel)]))
        };
        let shown = vector("wrinkled_normal", &[decoded(0), decoded(1), decoded(2), Value::Float(w1), Value::Float(w2)]);
        for axis in 0..3 {
            prop_assert!((f32::from(found[axis]) - (0.5 * shown[axis] + 0.5) * 255.0).abs() <= 1.0);
        }
    }
}
