//! What the page is given: laws of the scene.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests may")]

mod scene;

use artifact::gltf::{Character, SkinnedMesh};
use wrinkle_blend::player::{Scene, Span, Wish};
use wrinkle_blend::{Blender, Error, Modulation, NamedPose, Params, rest};

fn made(character: &Character, poses: &[NamedPose]) -> Result<(Scene, Vec<u8>), Error> {
    let (neutral, params) = (rest(&character.nodes), Params::default());
    let setting = scene::setting(character, &neutral);
    let blender = Blender::new(setting, poses, Modulation::Cosine, &params)?;
    let wish = Wish { params: &params, modulation: &Modulation::Cosine, expressions: &[] };
    wrinkle_blend::player::scene(setting, poses, &blender, wish)
}

fn floats(block: &[u8], span: Span) -> Vec<f32> {
    let bytes = &block[span.offset..span.offset + 4 * span.length];
    bytes.chunks(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect()
}

fn words(block: &[u8], span: Span) -> Vec<u32> {
    floats(block, span).into_iter().map(f32::to_bits).collect()
}

/// A plane of two squares that share an edge, and the texture: the right one is the left one's mirror.
fn mirrored(mesh: &SkinnedMesh) -> SkinnedMesh {
    let xs = [-0.1, 0.0, 0.1];
    let grid = || [0, 1].into_iter().flat_map(|y| (0..3).map(move |x| (x, y)));
    SkinnedMesh {
        positions: grid().map(|(x, y)| [xs[x], 1.55 + 0.1 * f64::from(y), 0.1].into()).collect(),
        uvs: grid().map(|(x, y)| [(x as f64 - 1.0).abs() * 0.8 + 0.1, 1.0 - f64::from(y)]).collect(),
        triangles: vec![[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]],
        influences: vec![vec![(1, 0.5), (2, 0.5)]; 6],
        ..mesh.clone()
    }
}

#[test]
fn between_mirrored_halves_vertices_stand_twice() {
    let mut character = scene::character();
    let poses = scene::poses(&character);
    character.meshes[0] = mirrored(&character.meshes[0]);
    let (scene, block) = made(&character, &poses[..1]).unwrap();
    let part = &scene.parts[0];
    // Two vertices on the middle line have a tangent to each side.
    assert_eq!(part.positions.length, 3 * 8);
    let tangents = floats(&block, part.tangents);
    let uvs = floats(&block, part.uvs);
    for (tangent, place) in tangents.chunks(4).zip(floats(&block, part.positions).chunks(3)) {
        // u grows away from the middle, and green is up in the picture on both sides: bitangent = w · normal × tangent.
        let side = if place[0].abs() < 1e-6 { tangent[0].signum() } else { place[0].signum() };
        assert!(
            (tangent[0] - side).abs() < 1e-5 && (tangent[3] - side).abs() < 1e-5,
            "{place:?} {tangent:?}"
        );
    }
    assert_eq!(uvs.len(), 2 * 8);
    assert!(words(&block, part.triangles).iter().all(|vertex| *vertex < 8));
}

#[test]
fn a_seam_of_the_texture_does_not_show_in_normals() {
    let mut character = scene::character();
    let poses = scene::poses(&character);
    let mesh = &mut character.meshes[0];
    // A bent sheet, cut along its third column: one half keeps the vertices, the other has copies elsewhere in the texture.
    for point in &mut mesh.positions {
        point.z -= 4.0 * point.x * point.x;
    }
    for row in 0..5 {
        let cut = 5 * row + 2;
        mesh.positions.push(mesh.positions[cut]);
        mesh.uvs.push([0.9, mesh.uvs[cut][1]]);
        mesh.influences.push(mesh.influences[cut].clone());
    }
    let columns = |triangle: &[u32; 3]| triangle.iter().map(|vertex| vertex % 5).max().unwrap();
    for triangle in mesh.triangles.iter_mut().filter(|triangle| columns(triangle) > 2) {
        *triangle = triangle.map(|vertex| if vertex % 5 == 2 { 25 + vertex / 5 } else { vertex });
    }
    let (scene, block) = made(&character, &poses[..1]).unwrap();
    let part = &scene.parts[0];
    let (positions, normals) = (floats(&block, part.positions), floats(&block, part.normals));
    let mut pairs = 0;
    for (i, a) in positions.chunks(3).enumerate() {
        for (j, _) in positions.chunks(3).enumerate().skip(i + 1).filter(|(_, b)| *b == a) {
            assert_eq!(normals[3 * i..3 * i + 3], normals[3 * j..3 * j + 3], "at {a:?}");
            pairs += 1;
        }
    }
    assert!(pairs >= 5, "{pairs}");
}

#[test]
fn influences_say_what_the_character_says() {
    let character = scene::character();
    let poses = scene::poses(&character);
    let (scene, block) = made(&character, &poses).unwrap();
    let part = &scene.parts[0];
    let (ranges, influences) = (words(&block, part.ranges), words(&block, part.influences));
    assert_eq!(influences.len() % 4, 0);
    for range in ranges.chunks(2) {
        let own = influences.chunks(4).skip(range[0] as usize).take(range[1] as usize);
        let sum: f32 = own.clone().map(|influence| f32::from_bits(influence[1])).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        for influence in own {
            let node = part.joints[influence[0] as usize];
            let bone = scene.bones.iter().position(|bone| bone.node == node);
            assert_eq!(influence[2], bone.map_or(u32::MAX, |bone| bone as u32));
            let of = |pose: usize| bone.is_some_and(|bone| scene.poses[pose].ways[bone].is_some());
            assert_eq!(influence[3], (0..3).filter(|pose| of(*pose)).fold(0, |mask, pose| mask | 1 << pose));
        }
    }
    // Animations become frames: three seconds at 30 Hz, and the last one.
    assert_eq!((scene.clips[0].frames, scene.clips[0].placements.length), (91, 91 * 3 * 10));
}

#[test]
fn too_many_poses_are_refused() {
    let character = scene::character();
    let one = scene::poses(&character).remove(0).1;
    let poses: Vec<NamedPose> = (0..33).map(|number| (format!("pose {number}"), one.clone())).collect();
    assert!(matches!(made(&character, &poses), Err(Error::ManyPoses { count: 33, most: 32 })));
}
