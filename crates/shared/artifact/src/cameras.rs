//! `cameras/1`: the calibrated cameras of a rig.

use crate::{Document, Kind, TakeRef, Violation, finite};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Cameras by id, in one world space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "RigFile", into = "RigFile")]
pub struct CameraRig {
    /// Per camera id its calibration.
    pub cameras: BTreeMap<String, RigCamera>,
    /// The take that the rig was calibrated from, or is that of; absent where many share it.
    pub take: Option<TakeRef>,
}

/// A calibrated camera, and how well it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct RigCamera {
    /// Intrinsics and pose.
    pub camera: Camera,
    /// Root mean square reprojection error, radial, px; absent where nothing was measured.
    pub rms_px: Option<f64>,
    /// How many images the calibration used.
    pub views: Option<usize>,
    /// Standard deviations of the calibration.
    pub deviation: Option<CameraDeviation>,
}

impl From<Camera> for RigCamera {
    /// A camera of which no more is known than its parameters.
    fn from(camera: Camera) -> Self {
        Self { camera, rms_px: None, views: None, deviation: None }
    }
}

/// Standard deviations of a camera's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraDeviation {
    /// Of the focal lengths, px.
    pub focal_px: [f64; 2],
    /// Of the principal point, px.
    pub center_px: [f64; 2],
    /// Of the pose: small turns about the camera's own axes x, y, z, rad.
    pub rotation_rad: [f64; 3],
    /// Of the pose's translation, in the camera's axes, mm.
    pub translation_mm: [f64; 3],
}

#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RigFile {
    /// Per camera id its calibration.
    cameras: BTreeMap<String, CameraFile>,
    /// The take that the rig was calibrated from, or is that of; absent where many share it.
    take: Option<TakeRef>,
}

/// A camera, OpenCV's model: x_cam = R x + t, z forward, x right, y down; then x_cam / z_cam is distorted, scaled and moved to
/// the pixel. Pixel (0, 0) is the centre of the top-left pixel.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    /// Image width, height, px.
    image_size: [u32; 2],
    /// Focal lengths along x and y, px.
    focal_px: [f64; 2],
    /// Principal point, px.
    center_px: [f64; 2],
    distortion: Distortion,
    cam_from_world: Pose,
    /// Root mean square reprojection error, radial, px; null where nothing was measured.
    rms_px: Option<f64>,
    /// How many images the calibration used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    views: Option<usize>,
    /// Standard deviations of the calibration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deviation: Option<CameraDeviation>,
}

/// Lens distortion (Brown–Conrady), OpenCV's names.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Distortion {
    k1: f64,
    k2: f64,
    p1: f64,
    p2: f64,
    k3: f64,
}

/// World to camera.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Pose {
    /// The rows of R.
    rotation: [[f64; 3]; 3],
    /// t, mm.
    translation_mm: [f64; 3],
}

impl Kind for CameraRig {
    const NAME: &'static str = "cameras";
    const VERSION: u32 = 1;
}

impl Document for CameraRig {
    fn check(&self) -> Result<(), Violation> {
        if self.cameras.contains_key("") {
            return Err(Violation::new("cameras", "a camera has an empty id"));
        }
        self.cameras.iter().try_for_each(|(id, camera)| check_camera(&format!("camera {id}"), camera))
    }
}

fn check_camera(place: &str, rig: &RigCamera) -> Result<(), Violation> {
    let Camera { image_size, lens, cam_from_world } = &rig.camera;
    if image_size.contains(&0) {
        let what = format!("the image has no size: {} × {} px", image_size[0], image_size[1]);
        return Err(Violation::new(place, what));
    }
    let BrownConrady { k1, k2, p1, p2, k3 } = lens.distortion;
    finite(&format!("{place}, focal_px"), &lens.focal_px)?;
    finite(&format!("{place}, center_px"), &lens.center_px)?;
    finite(&format!("{place}, distortion"), &[k1, k2, p1, p2, k3])?;
    finite(&format!("{place}, cam_from_world"), &cam_from_world.translation.vector)?;
    finite(&format!("{place}, cam_from_world"), &cam_from_world.rotation.coords)?;
    if let Some(focal) = lens.focal_px.iter().find(|&&focal| focal <= 0.0) {
        return Err(Violation::new(place, format!("the focal length {focal} px is not positive")));
    }
    let spreads = rig.deviation.iter().flat_map(|deviation| {
        let CameraDeviation { focal_px, center_px, rotation_rad, translation_mm } = deviation;
        focal_px.iter().chain(center_px).chain(rotation_rad).chain(translation_mm)
    });
    for spread in rig.rms_px.iter().chain(spreads) {
        finite(place, [spread])?;
        if *spread < 0.0 {
            return Err(Violation::new(place, format!("the error {spread} is negative")));
        }
    }
    Ok(())
}

impl From<CameraRig> for RigFile {
    fn from(rig: CameraRig) -> Self {
        let cameras = rig.cameras.into_iter().map(|(id, camera)| (id, camera.into())).collect();
        Self { cameras, take: rig.take }
    }
}

impl TryFrom<RigFile> for CameraRig {
    type Error = String;

    fn try_from(file: RigFile) -> Result<Self, String> {
        let read = |(id, camera): (String, CameraFile)| match RigCamera::try_from(camera) {
            Ok(camera) => Ok((id, camera)),
            Err(what) => Err(format!("camera {id}: {what}")),
        };
        let cameras = file.cameras.into_iter().map(read).collect::<Result<_, _>>()?;
        Ok(Self { cameras, take: file.take })
    }
}

impl From<RigCamera> for CameraFile {
    fn from(rig: RigCamera) -> Self {
        let Camera { image_size, lens, cam_from_world } = rig.camera;
        let BrownConrady { k1, k2, p1, p2, k3 } = lens.distortion;
        // + 0.0: no row says -0.0. A matrix is stored by columns, so the transposed one lists the rows.
        let rows = cam_from_world.rotation.to_rotation_matrix().into_inner().transpose().add_scalar(0.0);
        Self {
            image_size,
            focal_px: lens.focal_px.into(),
            center_px: lens.center_px.into(),
            distortion: Distortion { k1, k2, p1, p2, k3 },
            cam_from_world: Pose {
                rotation: rows.into(),
                translation_mm: cam_from_world.translation.vector.into(),
            },
            rms_px: rig.rms_px,
            views: rig.views,
            deviation: rig.deviation,
        }
    }
}

impl TryFrom<CameraFile> for RigCamera {
    type Error = String;

    fn try_from(file: CameraFile) -> Result<Self, String> {
        let Distortion { k1, k2, p1, p2, k3 } = file.distortion;
        let Pose { rotation, translation_mm } = file.cam_from_world;
        let lens = Lens {
            focal_px: file.focal_px.into(),
            center_px: file.center_px.into(),
            distortion: BrownConrady { k1, k2, p1, p2, k3 },
        };
        let rotation = nearest_rotation(Matrix3::from(rotation).transpose())?;
        let cam_from_world = Isometry3::from_parts(translation_mm.into(), rotation);
        let camera = Camera { image_size: file.image_size, lens, cam_from_world };
        Ok(Self { camera, rms_px: file.rms_px, views: file.views, deviation: file.deviation })
    }
}

/// How far R Rᵀ may be from the identity, in any element: files with seven digits or more pass.
const ORTHONORMAL_TOLERANCE: f64 = 1e-6;

/// The rotation nearest to a matrix that is nearly one, by Newton's iteration for the polar factor, R ← ½ (R + R⁻ᵀ): it
/// doubles the digits with each step.
pub(crate) fn nearest_rotation(mut matrix: Matrix3<f64>) -> Result<UnitQuaternion<f64>, String> {
    let off = (matrix * matrix.transpose() - Matrix3::identity()).amax();
    if off.is_nan() || off > ORTHONORMAL_TOLERANCE {
        return Err(format!("the rows of its rotation are not orthonormal (off by {off:.1e})"));
    }
    if matrix.determinant() < 0.0 {
        return Err("its rotation mirrors (determinant −1)".to_string());
    }
    for _ in 0..2 {
        let inverse = matrix.try_inverse().ok_or("its rotation is singular")?;
        matrix = (matrix + inverse.transpose()) / 2.0;
    }
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    Ok(UnitQuaternion::new_normalize(UnitQuaternion::from_rotation_matrix(&rotation).into_inner()))
}
