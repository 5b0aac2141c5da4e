//! From where the bones are to how much of each wrinkle map shows.

use crate::mask::VertexMask;
use crate::{Error, Modulation, Params, Pose, Probe, Skeleton, dual};
use artifact::gltf::{Character, SkinnedMesh};
use nalgebra::{Point3, Vector3};

/// A pose under its id.
pub type NamedPose = (String, Pose);

/// What a blender is made of, beside its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The character.
    pub character: &'a Character,
    /// Which of its meshes wears the wrinkles.
    pub mesh: usize,
    /// Name of the bone that defines the head's space; found by itself where none is given.
    pub head_bone: Option<&'a str>,
    /// Millimetres in a unit of the character's file.
    pub mm_per_unit: f64,
    /// The pose without wrinkles.
    pub neutral: &'a Pose,
}

/// A bone that is watched.
#[derive(Debug, Clone)]
pub struct Bone {
    /// Its name.
    pub name: String,
    node: usize,
    /// The point that is watched, in the bone's own space.
    probe: Point3<f64>,
}

impl Bone {
    /// Its node.
    pub(crate) fn node(&self) -> usize {
        self.node
    }

    /// The point that is watched, in the bone's own space, units of the file.
    pub(crate) fn probe(&self) -> Point3<f64> {
        self.probe
    }
}

/// The shares α of the bones in one pose: per reference pose one per bone, 0 to 1; 0 where the bone is not of the pose.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shares(pub Vec<Vec<f64>>);

/// A character with its reference poses, ready to tell weights [DutreveMeyer2011, Sec. 4.2–4.4].
#[derive(Debug, Clone)]
pub struct Blender {
    skeleton: Skeleton,
    bones: Vec<Bone>,
    poses: Vec<String>,
    mm_per_unit: f64,
    neutral: Vec<Point3<f64>>,
    /// AC per pose and bone, mm; none where the bone is not of the pose.
    ways: Vec<Vec<Option<Vector3<f64>>>>,
    modulation: Modulation,
    mask: VertexMask,
    dual: bool,
}

impl Blender {
    /// A blender of reference poses.
    ///
    /// # Errors
    /// If there is no pose, a pose is the neutral one, no bone is the head's, or a parameter is out of its range.
    pub fn new(
        setting: Setting<'_>,
        poses: &[NamedPose],
        modulation: Modulation,
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        if poses.is_empty() {
            return Err(Error::NoPoses);
        }
        let Watched { skeleton, bones, numbers } = watch(setting, params.probe)?;
        let at = |pose: &Pose| places(&skeleton, &bones, setting.mm_per_unit, pose);
        let neutral = at(setting.neutral);
        let ways = poses.iter().map(|(id, pose)| ways(id, &at(pose), &neutral, params));
        let ways = ways.collect::<Result<Vec<_>, Error>>()?;
        let moved: Vec<usize> =
            (0..bones.len()).filter(|&b| ways.iter().any(|way| way[b].is_some())).collect();
        let keep = |way: &Vec<Option<Vector3<f64>>>| moved.iter().map(|&bone| way[bone]).collect();
        let ways: Vec<Vec<Option<Vector3<f64>>>> = ways.iter().map(keep).collect();
        let joints: Vec<usize> = moved.iter().map(|&bone| numbers[bone]).collect();
        let mask =
            VertexMask::new(&setting.character.meshes[setting.mesh].influences, &joints, &ways, params.mask);
        Ok(Self {
            bones: moved.iter().map(|&bone| bones[bone].clone()).collect(),
            neutral: moved.iter().map(|&bone| neutral[bone]).collect(),
            poses: poses.iter().map(|(id, _)| id.clone()).collect(),
            skeleton,
            mm_per_unit: setting.mm_per_unit,
            ways,
            modulation,
            mask,
            dual: params.dual,
        })
    }

    /// Ids of the reference poses.
    #[must_use]
    pub fn poses(&self) -> &[String] {
        &self.poses
    }

    /// The bones that move in any of them.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Where the watched points are in the neutral pose, in the head's space, mm.
    pub(crate) fn neutral(&self) -> &[Point3<f64>] {
        &self.neutral
    }

    /// The node that defines the head's space.
    pub(crate) fn head(&self) -> usize {
        self.skeleton.head()
    }

    /// How far a bone goes in a reference pose, mm; none where it is not of the pose.
    #[must_use]
    pub fn way(&self, pose: usize, bone: usize) -> Option<Vector3<f64>> {
        self.ways[pose][bone]
    }

    /// How much of each pose's way each bone went: `α_jk = clamp(AB·AC/|AC|², 0, 1)` [DutreveMeyer2011, Eq. 4]. The paper prints
    /// `|AC|`; its text normalises by the length of the segment, and α is 1 at the reference pose, so the square is meant.
    #[must_use]
    pub fn shares(&self, pose: &Pose) -> Shares {
        let places = places(&self.skeleton, &self.bones, self.mm_per_unit, pose);
        let mut shares = vec![vec![0.0; self.bones.len()]; self.poses.len()];
        for (bone, (place, neutral)) in places.iter().zip(&self.neutral).enumerate() {
            let ab = place - neutral;
            if self.dual {
                self.share_out(bone, &ab, &mut shares);
                continue;
            }
            for (share, way) in shares.iter_mut().zip(&self.ways) {
                if let Some(ac) = way[bone] {
                    share[bone] = (ab.dot(&ac) / ac.norm_squared()).clamp(0.0, 1.0);
                }
            }
        }
        Shares(shares)
    }

    fn share_out(&self, bone: usize, ab: &Vector3<f64>, shares: &mut [Vec<f64>]) {
        let of: Vec<(usize, Vector3<f64>)> =
            self.ways.iter().enumerate().filter_map(|(pose, way)| Some((pose, way[bone]?))).collect();
        let ways: Vec<Vector3<f64>> = of.iter().map(|pair| pair.1).collect();
        for ((pose, _), share) in of.iter().zip(dual::shares(&ways, ab)) {
            shares[*pose][bone] = share.clamp(0.0, 1.0);
        }
    }

    /// θ(α), as shaders take it.
    #[must_use]
    pub fn modulated(&self, shares: &Shares) -> Shares {
        Shares(shares.0.iter().map(|bones| bones.iter().map(|x| self.modulation.at(*x)).collect()).collect())
    }

    /// How much of each pose's map shows at each vertex, β, 0 to 1: per pose #V weights, pose after pose, into `weights`.
    /// [DutreveMeyer2011, Eq. 5]; the paper applies θ here and once more where maps are blended; it is applied once.
    pub fn vertex_weights(&self, shares: &Shares, weights: &mut Vec<f32>) {
        self.mask.weights(&self.modulated(shares), weights);
    }

    /// #V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.mask.vertex_count()
    }
}

/// The bones of the skin below the head.
pub(crate) struct Watched {
    pub(crate) skeleton: Skeleton,
    pub(crate) bones: Vec<Bone>,
    /// Per bone its number among the skin's joints.
    numbers: Vec<usize>,
}

pub(crate) fn watch(setting: Setting<'_>, probe: Probe) -> Result<Watched, Error> {
    let mesh = &setting.character.meshes[setting.mesh];
    let nodes = &setting.character.nodes;
    let skeleton = Skeleton::new(nodes, &mesh.joints, setting.head_bone)?;
    let below = skeleton.head_from_nodes(setting.neutral);
    let centroids = centroids(mesh);
    let (mut bones, mut numbers) = (Vec::new(), Vec::new());
    for (joint, &node) in mesh.joints.iter().enumerate() {
        let Some(centroid) = centroids[joint].filter(|_| below[node].is_some() && node != skeleton.head())
        else {
            continue;
        };
        let probe = match probe {
            Probe::Skin => mesh.inverse_bind[joint].transform_point(&centroid),
            Probe::Joint => Point3::origin(),
        };
        bones.push(Bone { name: nodes[node].name.clone(), node, probe });
        numbers.push(joint);
    }
    match bones.is_empty() {
        true => Err(Error::NoBones { mesh: mesh.name.clone(), head: nodes[skeleton.head()].name.clone() }),
        false => Ok(Watched { skeleton, bones, numbers }),
    }
}

/// Per joint the centroid of the vertices that hang on it, by weight, where they were bound; none where none does.
fn centroids(mesh: &SkinnedMesh) -> Vec<Option<Point3<f64>>> {
    let mut sums = vec![(Vector3::zeros(), 0.0); mesh.joints.len()];
    for (point, influences) in mesh.positions.iter().zip(&mesh.influences) {
        for &(joint, weight) in influences {
            sums[joint].0 += point.coords * weight;
            sums[joint].1 += weight;
        }
    }
    sums.into_iter().map(|(sum, weight)| (weight > 0.0).then(|| Point3::from(sum / weight))).collect()
}

/// Where the bones' probes are in the head's space, mm.
pub(crate) fn places(skeleton: &Skeleton, bones: &[Bone], mm_per_unit: f64, pose: &Pose) -> Vec<Point3<f64>> {
    let transforms = skeleton.head_from_nodes(pose);
    let place = |bone: &Bone| {
        let place = transforms[bone.node]
            .map_or(bone.probe, |head_from_bone| head_from_bone.transform_point(&bone.probe));
        place * mm_per_unit
    };
    bones.iter().map(place).collect()
}

/// How far each bone goes in a pose; none of those that hardly move.
fn ways(
    id: &str,
    places: &[Point3<f64>],
    neutral: &[Point3<f64>],
    params: &Params,
) -> Result<Vec<Option<Vector3<f64>>>, Error> {
    let all: Vec<Vector3<f64>> = places.iter().zip(neutral).map(|(place, neutral)| place - neutral).collect();
    let most_mm = all.iter().map(Vector3::norm).fold(0.0, f64::max);
    if most_mm < params.least_mm || most_mm == 0.0 {
        return Err(Error::NeutralPose { pose: id.to_string(), least_mm: params.least_mm, most_mm });
    }
    let least = params.least_mm.max(params.least_share * most_mm);
    Ok(all.into_iter().map(|way| (way.norm() >= least && way.norm() > 0.0).then_some(way)).collect())
}
