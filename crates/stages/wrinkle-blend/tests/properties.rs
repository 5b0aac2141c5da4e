//! Laws of the method.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scene;

use artifact::gltf::Placement;
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;
use scene::{blender, character, poses, setting};
use wrinkle_blend::{
    Atlas, Blended, Blender, Error, Goal, MapBlender, Mask, Modulation, NormalMap, Params, Pose, Probe,
    combined, crosstalk, fit_poses, recovery, rest,
};

fn all_params() -> Vec<Params> {
    let mut all = Vec::new();
    for dual in [false, true] {
        for mask in [Mask::Smooth, Mask::Paper] {
            all.push(Params { dual, mask, ..Params::default() });
        }
    }
    all
}

#[test]
fn at_each_reference_pose_its_own_share_is_whole_and_at_rest_none_is() {
    let character = character();
    let own: Vec<Pose> = poses(&character).into_iter().map(|pose| pose.1).collect();
    for params in all_params() {
        let blender = blender(&character, &params);
        assert!(recovery(&blender, &own).iter().all(|share| (share - 1.0).abs() < 1e-9), "{params:?}");
        let still = blender.shares(&rest(&character.nodes));
        assert!(still.0.iter().flatten().all(|share| *share == 0.0));
        let mut weights = vec![9.0; 3];
        blender.vertex_weights(&still, &mut weights);
        assert!(weights.len() == 75 && weights.iter().all(|weight| *weight == 0.0));
    }
}

#[test]
fn dual_poses_show_none_of_each_other() {
    let character = character();
    let own: Vec<Pose> = poses(&character).into_iter().map(|pose| pose.1).collect();
    let beside = |dual: bool| {
        let matrix = crosstalk(&blender(&character, &Params { dual, ..Params::default() }), &own);
        (0..3)
            .flat_map(|m| (0..3).map(move |k| (m, k)))
            .filter(|(m, k)| m != k)
            .map(|(m, k)| matrix[m][k])
            .fold(0.0, f64::max)
    };
    assert!(beside(false) > 0.1, "the left bone of 'in' also goes up");
    assert!(beside(true) < 1e-9);
}

#[test]
fn a_bone_that_turns_on_the_spot_is_seen_by_its_skin_only() {
    let character = character();
    let bones = |probe| {
        let neutral = rest(&character.nodes);
        let open = [poses(&character).remove(2)];
        Blender::new(
            setting(&character, &neutral),
            &open,
            Modulation::Cosine,
            &Params { probe, ..Params::default() },
        )
    };
    assert_eq!(bones(Probe::Skin).unwrap().bones()[0].name, "jaw");
    let refused = bones(Probe::Joint).unwrap_err();
    assert!(
        matches!(&refused, Error::NeutralPose { pose, most_mm, .. } if pose == "open" && *most_mm == 0.0),
        "{refused}"
    );
}

#[test]
fn the_papers_mask_counts_the_smallest_weight_and_the_smooth_one_fades() {
    let mut character = character();
    character.meshes[0].influences[2] = vec![(0, 0.99), (1, 0.01)];
    let up = poses(&character).remove(0).1;
    let at = |mask| {
        let blender = blender(&character, &Params { mask, ..Params::default() });
        let mut weights = Vec::new();
        blender.vertex_weights(&blender.shares(&up), &mut weights);
        [weights[0], weights[2]]
    };
    assert_eq!(at(Mask::Paper), [1.0, 1.0]);
    let [held, hardly] = at(Mask::Smooth);
    assert!(held == 1.0 && hardly < 0.01, "{held} {hardly}");
}

proptest! {
    /// However the head is carried and turned, wrinkles stay.
    #[test]
    fn a_rigid_motion_of_the_head_changes_nothing(turn in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0], way in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0], share in 0.0..1.0f64) {
        let character = character();
        let still = rest(&character.nodes);
        let mut pose = combined(&still, &[poses(&character).remove(1).1]);
        pose[2].translation = still[2].translation.lerp(&pose[2].translation, share);
        let mut carried = pose.clone();
        let rotation = UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]);
        carried[0] = Placement { translation: Vector3::from(way), rotation, ..carried[0] };
        carried[1] = Placement { rotation, ..carried[1] };
        for params in all_params() {
            let blender = blender(&character, &params);
            for (one, other) in blender.shares(&pose).0.iter().flatten().zip(blender.shares(&carried).0.iter().flatten()) {
                prop_assert!((one - other).abs() < 1e-9 && (0.0..=1.0).contains(one));
            }
        }
    }

    /// Weights of 0 return the normalised neutral map, code by code; maps may be laid over it in any order.
    #[test]
    fn nothing_shown_is_the_neutral_map(codes in proptest::collection::vec(any::<u16>(), 3 * 64), wide: bool) {
        let map = |shift: usize| {
            let turned: Vec<u16> = (0..codes.len()).map(|i| codes[(i + 3 * shift) % codes.len()]).collect();
            match wide {
                true => NormalMap::from_16_bits("map", 8, 8, &turned).unwrap(),
                false => NormalMap::from_8_bits("map", 8, 8, &turned.iter().map(|code| (code >> 8) as u8).collect::<Vec<_>>()).unwrap(),
            }
        };
        let bits = if wide { 16 } else { 8 };
        let full = if wide { 65535.0 } else { 255.0 };
        let neutral = map(0);
        let atlas = Atlas::new(&character().meshes[0], [8, 8], 0).unwrap();
        let blend = |maps: Vec<NormalMap>, weights: &[f32]| {
            match MapBlender::new(map(0), maps, bits).unwrap().blend(&atlas, weights) {
                Blended::Bits8(codes) => codes.into_iter().map(f64::from).collect::<Vec<f64>>(),
                Blended::Bits16(codes) => codes.into_iter().map(f64::from).collect(),
            }
        };
        let still = blend(vec![map(1), map(2)], &[0.0; 50]);
        for (texel, found) in still.chunks(3).enumerate() {
            let normal = Vector3::from(neutral.normal(texel));
            let wanted = normal.normalize();
            for axis in 0..3 {
                prop_assert!(normal.norm() == 0.0 || found[axis] == ((0.5 * wanted[axis] + 0.5) * full).round_ties_even());
            }
        }
        let (one, other) = ([[0.3f32; 25], [0.8; 25]].concat(), [[0.8f32; 25], [0.3; 25]].concat());
        let (ab, ba) = (blend(vec![map(1), map(2)], &one), blend(vec![map(2), map(1)], &other));
        prop_assert!(ab.iter().zip(&ba).all(|(a, b)| (a - b).abs() <= 1.0));
    }
}

/// The equations in 64 bits, texel by texel.
fn reference(neutral: [f64; 3], maps: &[([f64; 3], f64)]) -> Vector3<f64> {
    let snap = |x: f64| if x.abs() <= 1.0 / 255.0 + 1e-6 { 0.0 } else { x };
    let add = |sum: Vector3<f64>, (n, w): &([f64; 3], f64)| {
        Vector3::new(
            sum.x + w * snap(n[0]),
            sum.y + w * snap(n[1]),
            sum.z * (1.0 + w * (n[2] - 1.0)).max(0.05),
        )
    };
    maps.iter().fold(Vector3::from(neutral), add).normalize()
}

#[test]
fn blended_maps_are_those_of_the_equations() {
    // More texels than are done at once, of maps that look like maps.
    const SIZE: usize = 600;
    let tilted = |number: usize| {
        let normal = |texel: usize| {
            let (x, y) = ((texel % SIZE) as f64, (texel / SIZE) as f64);
            let n =
                Vector3::new((0.1 * x + number as f64).sin(), (0.07 * y * (1.0 + number as f64)).cos(), 1.2)
                    .normalize();
            [n.x, n.y, n.z].map(|part| ((0.5 * part + 0.5) * 255.0).round() as u8)
        };
        let codes: Vec<u8> = (0..SIZE * SIZE).flat_map(normal).collect();
        NormalMap::from_8_bits("map", SIZE, SIZE, &codes).unwrap()
    };
    let (neutral, maps) = (tilted(0), [tilted(1), tilted(2)]);
    let character = character();
    let atlas = Atlas::new(&character.meshes[0], [SIZE, SIZE], 0).unwrap();
    assert_eq!((atlas.shared, atlas.outside), (0, 0));
    // Weights that run across the face: bilinear on the grid, so linear over each triangle.
    let uvs = &character.meshes[0].uvs;
    let weights: Vec<f32> =
        uvs.iter().map(|uv| uv[0] as f32).chain(uvs.iter().map(|uv| 1.0 - uv[1] as f32)).collect();
    let blended = MapBlender::new(neutral.clone(), maps.to_vec(), 8).unwrap().blend(&atlas, &weights);
    let Blended::Bits8(codes) = blended else { panic!("8 bits") };
    for (texel, found) in codes.chunks(3).enumerate() {
        let [u, v] = [texel % SIZE, texel / SIZE].map(|at| (at as f64 + 0.5) / SIZE as f64);
        let normal =
            reference(neutral.normal(texel), &[(maps[0].normal(texel), u), (maps[1].normal(texel), 1.0 - v)]);
        for axis in 0..3 {
            assert!(
                (f64::from(found[axis]) - (0.5 * normal[axis] + 0.5) * 255.0).abs() < 0.51,
                "texel {texel}"
            );
        }
    }
}

#[test]
fn charts_reach_over_their_rim_and_no_farther() {
    let mut mesh = character().meshes.remove(0);
    mesh.uvs.iter_mut().for_each(|uv| *uv = [0.25 + 0.5 * uv[0], 0.25 + 0.5 * uv[1]]);
    let covered = |padding: usize| {
        let atlas = Atlas::new(&mesh, [64, 64], padding).unwrap();
        atlas.spread(&[1.0; 25]).iter().filter(|weight| **weight == 1.0).count()
    };
    assert_eq!(covered(0), 32 * 32);
    // Four sides, and steps at the corners.
    assert_eq!(covered(3), 32 * 32 + 4 * 3 * 32 + 4 * 3);
}

#[test]
fn mirrored_halves_share_texels_and_it_is_said() {
    let mut mesh = character().meshes.remove(0);
    mesh.uvs.iter_mut().for_each(|uv| uv[0] = 2.0 * (uv[0] - 0.5).abs());
    assert_eq!(Atlas::new(&mesh, [32, 32], 0).unwrap().shared, 32 * 32);
    mesh.uvs.clear();
    assert_eq!(Atlas::new(&mesh, [32, 32], 0).unwrap_err(), Error::NoUvs { mesh: "face".into() });
}

#[test]
fn a_performance_of_two_poses_needs_two() {
    let character = character();
    let neutral = rest(&character.nodes);
    let own = poses(&character);
    // The left goes up and the jaw opens, each at its own pace; the extremes are frames 10 and 30.
    let frames: Vec<Pose> = (0..41)
        .map(|frame| {
            let share = |middle: f64| (1.0 - (f64::from(frame) - middle).abs() / 10.0).max(0.0);
            let mut pose = neutral.clone();
            pose[2].translation = neutral[2].translation.lerp(&own[0].1[2].translation, share(10.0));
            pose[4].rotation = neutral[4].rotation.slerp(&own[2].1[4].rotation, share(30.0));
            pose
        })
        .collect();
    let goal = Goal { tolerance_mm: 1.0, most: 6 };
    let chosen = fit_poses(setting(&character, &neutral), &frames, goal, &Params::default()).unwrap();
    let mut found = chosen.frames.clone();
    found.sort_unstable();
    assert_eq!(found, [10, 30]);
    assert!(chosen.error_mm <= 1.0 && chosen.errors_mm.windows(2).all(|pair| pair[1] <= pair[0]));
    let few = Goal { most: 1, ..goal };
    let refused = fit_poses(setting(&character, &neutral), &frames, few, &Params::default());
    assert!(matches!(refused, Err(Error::TooFewPoses { count: 1, .. })));
    let still =
        fit_poses(setting(&character, &neutral), std::slice::from_ref(&neutral), goal, &Params::default());
    assert!(matches!(still, Err(Error::NeutralPose { .. })));
}
