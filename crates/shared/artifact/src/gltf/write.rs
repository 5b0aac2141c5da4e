//! A character as one binary file (`.glb`).

use super::{Animation, Character, Interpolation, Keys, SkinnedMesh};
use crate::{Error, Result, Sink, Staged};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// Writes a character as `.glb`: each mesh with a skin and a node of its own, behind the nodes given; normals are those of the
/// bind pose. Numbers become 32-bit floats.
///
/// # Errors
/// If a number is not finite, or the file cannot be written.
pub fn write(path: &Path, character: &Character) -> Result<Staged> {
    let mut parts = Parts::default();
    let nodes = parts.nodes(character);
    let meshes: Vec<Value> = character.meshes.iter().map(|mesh| parts.mesh(mesh)).collect();
    let skins: Vec<Value> = character.meshes.iter().map(|mesh| parts.skin(mesh)).collect();
    let animations: Vec<Value> = character.animations.iter().map(|clip| parts.animation(clip)).collect();
    if !parts.finite {
        return Err(Error::new(path, "the character holds a number that is not finite"));
    }
    let roots: Vec<usize> = (0..nodes.len())
        .filter(|&at| character.nodes.get(at).is_none_or(|node| node.parent.is_none()))
        .collect();
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "Furrow" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": meshes,
        "skins": skins,
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{ "byteLength": parts.bytes.len() }],
    });
    if !animations.is_empty() {
        document["animations"] = animations.into();
    }
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |bytes: &[u8]| {
        u32::try_from(bytes.len()).map_err(|_| Error::new(path, "is larger than a GLB can be (4 GiB)"))
    };
    let (text_length, bytes_length) = (length(&text)?, length(&parts.bytes)?);
    let total = text_length.checked_add(bytes_length).and_then(|sum| sum.checked_add(28));
    let total = total.ok_or_else(|| Error::new(path, "is larger than a GLB can be (4 GiB)"))?;
    let mut sink = Sink::create(path)?;
    let pieces: [&[u8]; 8] = [
        b"glTF",
        &[2, 0, 0, 0],
        &total.to_le_bytes(),
        &text_length.to_le_bytes(),
        b"JSON",
        &text,
        &bytes_length.to_le_bytes(),
        b"BIN\0",
    ];
    let written = pieces.iter().chain([&parts.bytes.as_slice()]).try_for_each(|piece| sink.write_all(piece));
    written.map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

/// The binary part, and what refers into it.
struct Parts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    finite: bool,
}

impl Default for Parts {
    fn default() -> Self {
        Self { bytes: Vec::new(), views: Vec::new(), accessors: Vec::new(), finite: true }
    }
}

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;

impl Parts {
    /// Adds bytes as a view with one accessor; returns the accessor.
    fn add(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": shape }));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, shape: &str, rows: &[[f64; N]]) -> usize {
        self.finite &= rows.iter().flatten().all(|number| number.is_finite());
        let bytes: Vec<u8> =
            rows.iter().flatten().flat_map(|number| (*number as f32).to_le_bytes()).collect();
        self.add(&bytes, FLOAT, shape, rows.len())
    }

    /// Floats of which the format wants the extent too.
    fn bounded<const N: usize>(&mut self, shape: &str, rows: &[[f64; N]]) -> usize {
        let accessor = self.floats(shape, rows);
        let extent = |pick: fn(f64, f64) -> f64, start: f64| -> Vec<f64> {
            let axis = |axis: usize| rows.iter().map(|row| f64::from(row[axis] as f32)).fold(start, pick);
            (0..N).map(axis).collect()
        };
        if !rows.is_empty() && self.finite {
            self.accessors[accessor]["min"] = extent(f64::min, f64::INFINITY).into();
            self.accessors[accessor]["max"] = extent(f64::max, f64::NEG_INFINITY).into();
        }
        accessor
    }

    fn nodes(&mut self, character: &Character) -> Vec<Value> {
        let mut nodes: Vec<Value> = Vec::new();
        for (number, node) in character.nodes.iter().enumerate() {
            let children: Vec<usize> =
                (0..character.nodes.len()).filter(|&at| character.nodes[at].parent == Some(number)).collect();
            let rest = &node.rest;
            let numbers =
                [rest.translation.as_slice(), rest.rotation.coords.as_slice(), rest.scale.as_slice()];
            self.finite &= numbers.iter().copied().flatten().all(|number| number.is_finite());
            let [translation, rotation, scale] = numbers;
            let mut value = json!({ "name": node.name, "translation": translation, "rotation": rotation, "scale": scale });
            if !children.is_empty() {
                value["children"] = children.into();
            }
            nodes.push(value);
        }
        for (number, mesh) in character.meshes.iter().enumerate() {
            nodes.push(json!({ "name": mesh.name, "mesh": number, "skin": number }));
        }
        nodes
    }

    fn mesh(&mut self, mesh: &SkinnedMesh) -> Value {
        let points: Vec<[f64; 3]> = mesh.positions.iter().map(|point| (*point).into()).collect();
        let normals = mesh::vertex_normals(&mesh.positions, &mesh.triangles);
        let normals: Vec<[f64; 3]> = normals.into_iter().map(Into::into).collect();
        let mut attributes =
            json!({ "POSITION": self.bounded("VEC3", &points), "NORMAL": self.floats("VEC3", &normals) });
        if !mesh.uvs.is_empty() {
            attributes["TEXCOORD_0"] = self.floats("VEC2", &mesh.uvs).into();
        }
        let most = mesh.influences.iter().map(Vec::len).max().unwrap_or(0).max(1);
        for set in 0..most.div_ceil(4) {
            let of = |vertex: &Vec<(usize, f64)>| -> [(usize, f64); 4] {
                std::array::from_fn(|at| vertex.get(4 * set + at).copied().unwrap_or((0, 0.0)))
            };
            let four: Vec<[(usize, f64); 4]> = mesh.influences.iter().map(of).collect();
            let joints: Vec<u8> =
                four.iter().flatten().flat_map(|pair| (pair.0 as u16).to_le_bytes()).collect();
            let weights: Vec<[f64; 4]> = four.iter().map(|four| four.map(|pair| pair.1)).collect();
            attributes[format!("JOINTS_{set}")] =
                self.add(&joints, UNSIGNED_SHORT, "VEC4", four.len()).into();
            attributes[format!("WEIGHTS_{set}")] = self.floats("VEC4", &weights).into();
        }
        let corners: Vec<u8> =
            mesh.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect();
        let indices = self.add(&corners, UNSIGNED_INT, "SCALAR", 3 * mesh.triangles.len());
        json!({ "name": mesh.name, "primitives": [{ "attributes": attributes, "indices": indices }] })
    }

    fn skin(&mut self, mesh: &SkinnedMesh) -> Value {
        let binds: Vec<[f64; 16]> =
            mesh.inverse_bind.iter().map(|bind| std::array::from_fn(|at| bind.as_slice()[at])).collect();
        json!({ "joints": mesh.joints, "inverseBindMatrices": self.floats("MAT4", &binds) })
    }

    fn animation(&mut self, clip: &Animation) -> Value {
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for channel in &clip.channels {
            let times: Vec<[f64; 1]> = channel.times.iter().map(|time| [*time]).collect();
            let input = self.bounded("SCALAR", &times);
            let (path, output) = match &channel.keys {
                Keys::Translation(keys) => ("translation", self.floats("VEC3", keys)),
                Keys::Rotation(keys) => ("rotation", self.floats("VEC4", keys)),
                Keys::Scale(keys) => ("scale", self.floats("VEC3", keys)),
            };
            let interpolation = match channel.interpolation {
                Interpolation::Step => "STEP",
                Interpolation::Linear => "LINEAR",
                Interpolation::Cubic => "CUBICSPLINE",
            };
            channels
                .push(json!({ "sampler": samplers.len(), "target": { "node": channel.node, "path": path } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        }
        json!({ "name": clip.name, "channels": channels, "samplers": samplers })
    }
}
