//! From the lists of a glTF file to nodes, skinned meshes and animations.

use super::container::File;
use super::json;
use super::{Animation, Channel, Interpolation, Keys, Node, Placement, SkinnedMesh};
use crate::Result;
use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

pub(super) fn nodes(file: &File) -> Result<Vec<Node>> {
    let list = &file.root.nodes;
    let mut parents = vec![None; list.len()];
    for (above, node) in list.iter().enumerate() {
        let by = format!("node {above}");
        for &child in &node.children {
            file.entry(list, child, "node", &by)?;
            if parents[child].replace(above).is_some() {
                return Err(file.error(by, format!("node {child} has two parents")));
            }
        }
    }
    check_trees(file, &parents)?;
    let node = |(number, (node, parent)): (usize, (&json::Node, Option<usize>))| {
        let name = name(node.name.as_ref(), "node", number);
        let rest = rest(file, node, &name)?;
        Ok(Node { name, parent, rest })
    };
    list.iter().zip(parents).enumerate().map(node).collect()
}

fn name(given: Option<&String>, thing: &str, number: usize) -> String {
    given.filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("{thing} {number}"))
}

/// Refuses nodes that are above themselves.
fn check_trees(file: &File, parents: &[Option<usize>]) -> Result<()> {
    for start in 0..parents.len() {
        let (mut at, mut steps) = (start, 0);
        while let Some(above) = parents[at] {
            (at, steps) = (above, steps + 1);
            if steps > parents.len() {
                return Err(file.error(format!("node {start}"), "is above itself"));
            }
        }
    }
    Ok(())
}

fn rest(file: &File, node: &json::Node, name: &str) -> Result<Placement> {
    let broken = || file.error(format!("node {name}"), "its transform is no move, turn and scale");
    if let Some(matrix) = node.matrix {
        return placement(&Matrix4::from_column_slice(&matrix)).ok_or_else(broken);
    }
    let rotation = match node.rotation {
        Some(xyzw) => unit(xyzw).ok_or_else(broken)?,
        None => UnitQuaternion::identity(),
    };
    let translation = node.translation.map_or_else(Vector3::zeros, Vector3::from);
    let scale = node.scale.map_or_else(|| Vector3::repeat(1.0), Vector3::from);
    let finite = translation.iter().chain(scale.iter()).all(|x| x.is_finite());
    finite.then_some(Placement { translation, rotation, scale }).ok_or_else(broken)
}

/// The rotation of x, y, z, w; none where they are all 0.
fn unit([x, y, z, w]: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9)
}

/// A matrix as move, turn and scale; none where it squashes an axis.
fn placement(matrix: &Matrix4<f64>) -> Option<Placement> {
    let linear: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
    let mut scale = Vector3::from_fn(|axis, _| linear.column(axis).norm());
    if linear.determinant() < 0.0 {
        scale.x = -scale.x;
    }
    if !(linear.determinant().is_finite() && scale.iter().all(|s| s.abs() > 1e-12)) {
        return None;
    }
    let turn = Matrix3::from_fn(|row, column| linear[(row, column)] / scale[column]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&turn));
    Some(Placement { translation: matrix.fixed_view::<3, 1>(0, 3).into(), rotation, scale })
}

pub(super) fn meshes(file: &File, warnings: &mut Vec<String>) -> Result<Vec<SkinnedMesh>> {
    let mut meshes = Vec::new();
    for (number, node) in file.root.nodes.iter().enumerate() {
        let (Some(mesh), Some(skin)) = (node.mesh, node.skin) else { continue };
        let by = format!("node {number}");
        let shape = file.entry(&file.root.meshes, mesh, "mesh", &by)?;
        let skin = bones(file, file.entry(&file.root.skins, skin, "skin", &by)?, skin)?;
        for (part, primitive) in shape.primitives.iter().enumerate() {
            let base = name(shape.name.as_ref(), "mesh", mesh);
            let label = if shape.primitives.len() > 1 { format!("{base}/{part}") } else { base };
            // Points and lines have no skin to wrinkle.
            if primitive.mode.is_none_or(|mode| mode >= 4) {
                meshes.push(skinned(file, primitive, label, &skin, warnings)?);
            }
        }
    }
    Ok(meshes)
}

/// The bones of a skin, and where the mesh was bound to them.
fn bones(file: &File, skin: &json::Skin, number: usize) -> Result<(Vec<usize>, Vec<Matrix4<f64>>)> {
    let by = format!("skin {number}");
    for &joint in &skin.joints {
        file.entry(&file.root.nodes, joint, "node", &by)?;
    }
    let binds = match skin.inverse_bind_matrices {
        Some(accessor) => file.numbers::<16>(accessor, &by)?,
        None => vec![Matrix4::identity().as_slice().try_into().unwrap_or([0.0; 16]); skin.joints.len()],
    };
    if binds.len() < skin.joints.len() {
        let what = format!("has {} bones, but {} inverse bind matrices", skin.joints.len(), binds.len());
        return Err(file.error(by, what));
    }
    let binds = binds[..skin.joints.len()].iter().map(|matrix| Matrix4::from_column_slice(matrix));
    Ok((skin.joints.clone(), binds.collect()))
}

fn skinned(
    file: &File,
    primitive: &json::Primitive,
    name: String,
    (joints, inverse_bind): &(Vec<usize>, Vec<Matrix4<f64>>),
    warnings: &mut Vec<String>,
) -> Result<SkinnedMesh> {
    let by = format!("mesh {name}");
    let attribute = |key: &str| primitive.attributes.get(key).copied();
    let position = attribute("POSITION").ok_or_else(|| file.error(&by, "has no positions"))?;
    let positions: Vec<[f64; 3]> = file.numbers(position, &by)?;
    let count = positions.len();
    let uvs: Vec<[f64; 2]> = attribute("TEXCOORD_0").map_or(Ok(Vec::new()), |uvs| file.numbers(uvs, &by))?;
    if !uvs.is_empty() && uvs.len() != count {
        return Err(file.error(by, format!("has {count} positions, but {} texture coordinates", uvs.len())));
    }
    if !primitive.targets.is_empty() {
        warnings.push(format!("{by}: its morph targets are left out"));
    }
    let triangles = triangles(file, primitive, &by, count)?;
    let influences = influences(file, primitive, &by, count, joints.len(), warnings)?;
    Ok(SkinnedMesh {
        name,
        positions: positions.into_iter().map(Into::into).collect(),
        uvs,
        triangles,
        joints: joints.clone(),
        inverse_bind: inverse_bind.clone(),
        influences,
    })
}

fn triangles(file: &File, primitive: &json::Primitive, by: &str, count: usize) -> Result<Vec<[u32; 3]>> {
    let corners: Vec<u32> = match primitive.indices {
        Some(indices) => file.numbers::<1>(indices, by)?.into_iter().map(|[index]| index as u32).collect(),
        None => (0..count as u32).collect(),
    };
    if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
        return Err(file.error(by, format!("a triangle names vertex {corner}, but there are {count}")));
    }
    Ok(match primitive.mode.unwrap_or(4) {
        5 => (0..corners.len().saturating_sub(2))
            .map(|i| [corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]])
            .collect(),
        6 => corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]).collect(),
        _ => corners.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect(),
    })
}

/// A weight so far from a sum of 1 is a fault of the exporter, not rounding.
const SUM_TOLERANCE: f64 = 0.02;

fn influences(
    file: &File,
    primitive: &json::Primitive,
    by: &str,
    count: usize,
    joint_count: usize,
    warnings: &mut Vec<String>,
) -> Result<Vec<Vec<(usize, f64)>>> {
    let mut all = vec![Vec::new(); count];
    for set in 0.. {
        let pair = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")]
            .map(|key| primitive.attributes.get(&key).copied());
        let (joints, weights) = match pair {
            [Some(joints), Some(weights)] => {
                (file.numbers::<4>(joints, by)?, file.numbers::<4>(weights, by)?)
            }
            [None, None] if set > 0 => break,
            _ => {
                return Err(file
                    .error(by, format!("lacks JOINTS_{set} or WEIGHTS_{set}"))
                    .fix("bind the mesh to its bones and export it again"));
            }
        };
        if joints.len() != count || weights.len() != count {
            return Err(
                file.error(by, format!("has {count} positions, but weights of {} vertices", weights.len()))
            );
        }
        for (vertex, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
            for (&joint, &weight) in joints.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                let place = || format!("{by}, vertex {vertex}");
                if weight < 0.0 {
                    return Err(file.error(place(), format!("has the negative weight {weight}")));
                }
                if joint as usize >= joint_count {
                    return Err(
                        file.error(place(), format!("hangs on bone {joint}, but the skin has {joint_count}"))
                    );
                }
                add(&mut all[vertex], joint as usize, weight);
            }
        }
    }
    normalise(by, &mut all, warnings);
    Ok(all)
}

/// Adds a weight; a bone that is named twice counts with the sum.
fn add(influences: &mut Vec<(usize, f64)>, joint: usize, weight: f64) {
    match influences.binary_search_by_key(&joint, |pair| pair.0) {
        Ok(at) => influences[at].1 += weight,
        Err(at) => influences.insert(at, (joint, weight)),
    }
}

/// Divides weights by their sum, and says where that is more than rounding.
fn normalise(by: &str, all: &mut [Vec<(usize, f64)>], warnings: &mut Vec<String>) {
    let (mut off, mut bare, mut worst) = (0usize, 0usize, (0, 1.0f64));
    for (vertex, influences) in all.iter_mut().enumerate() {
        let sum: f64 = influences.iter().map(|pair| pair.1).sum();
        if influences.is_empty() {
            bare += 1;
            continue;
        }
        off += usize::from((sum - 1.0).abs() > SUM_TOLERANCE);
        if (sum - 1.0).abs() > (worst.1 - 1.0).abs() {
            worst = (vertex, sum);
        }
        influences.iter_mut().for_each(|pair| pair.1 /= sum);
    }
    if off > 0 {
        let (vertex, sum) = worst;
        warnings.push(format!(
            "{by}: the weights of {off} vertices do not add up to 1 (vertex {vertex}: {sum:.3}); they are divided by their sum"
        ));
    }
    if bare > 0 {
        warnings.push(format!("{by}: {bare} vertices hang on no bone"));
    }
}

pub(super) fn animations(file: &File) -> Result<Vec<Animation>> {
    let animation = |(number, animation): (usize, &json::Animation)| {
        let name = name(animation.name.as_ref(), "animation", number);
        let channels = animation.channels.iter().filter_map(|channel| {
            // Weights of morph targets, and targets of extensions, move no bone.
            let node = channel.target.node.filter(|_| channel.target.path != "weights")?;
            Some(self::channel(file, animation, channel, node, &format!("animation {name}")))
        });
        let channels = channels.collect::<Result<_>>()?;
        Ok(Animation { name, channels })
    };
    file.root.animations.iter().enumerate().map(animation).collect()
}

fn channel(
    file: &File,
    animation: &json::Animation,
    channel: &json::Channel,
    node: usize,
    by: &str,
) -> Result<Channel> {
    file.entry(&file.root.nodes, node, "node", by)?;
    let sampler = file.entry(&animation.samplers, channel.sampler, "sampler", by)?;
    let by = format!("{by}, node {node}");
    let times: Vec<f64> = file.numbers::<1>(sampler.input, &by)?.into_iter().map(|[time]| time).collect();
    if times.is_empty() || times.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(file.error(by, "the times of its keys do not rise"));
    }
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::Cubic,
        Some(other) => return Err(file.error(by, format!("has the unknown interpolation {other}"))),
    };
    let (keys, count) = match channel.target.path.as_str() {
        "translation" => counted(file.numbers(sampler.output, &by)?, Keys::Translation),
        "rotation" => counted(file.numbers(sampler.output, &by)?, Keys::Rotation),
        "scale" => counted(file.numbers(sampler.output, &by)?, Keys::Scale),
        other => return Err(file.error(by, format!("moves the unknown '{other}'"))),
    };
    let wanted = times.len() * if interpolation == Interpolation::Cubic { 3 } else { 1 };
    match count == wanted {
        true => Ok(Channel { node, times, interpolation, keys }),
        false => Err(file.error(by, format!("has {} keys, but {count} values", times.len()))),
    }
}

fn counted<T>(values: Vec<T>, keys: impl Fn(Vec<T>) -> Keys) -> (Keys, usize) {
    let count = values.len();
    (keys(values), count)
}
