//! Images: what stands before a camera while its shutter is open, and what becomes of it.

use crate::Error;
use crate::film::{self, Exposure, Grain, Moment, Scene, Skin, Solid};
use crate::light;
use crate::take::shapes::ball;
use crate::take::{Pose, Role, Station, Studio};
use mesh::{Mesh, vertex_normals};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// What stands before the cameras while their shutters are open around one time.
pub struct Set {
    /// The face in the middle of the exposure.
    pub pose: Pose,
    /// The skin in the world in the middle of the exposure.
    pub skin_in_world: Vec<Point3<f64>>,
    /// Normals of the skin in the world.
    pub normals: Vec<Vector3<f64>>,
    /// The skin in the world, averaged over the exposure: where blurred paint seems to be.
    pub mean_skin: Vec<Point3<f64>>,
    open: Vec<Point3<f64>>,
    close: Option<Vec<Point3<f64>>>,
    props: Vec<Piece>,
    /// For wrinkle cameras: the light on the skin, and the skin to cast rays at.
    close_look: Option<CloseLook>,
}

/// The skin at the middle of an exposure, looked at closely.
struct CloseLook {
    light: Vec<[f32; 3]>,
    scene: light::Scene,
}

/// A prop in the world, when the shutter opens and closes.
struct Piece {
    triangles: Vec<[u32; 3]>,
    albedo: Vec<[f32; 3]>,
    open: Vec<Point3<f64>>,
    close: Option<Vec<Point3<f64>>>,
    light: Vec<[f32; 3]>,
}

/// Reflectance of a finger.
const FINGER: [f32; 3] = [0.42, 0.27, 0.20];
/// Light on props: they stand in the shadow of brows and lips, which is not traced.
const PROP_LIGHT: f32 = 0.75;
/// A pixel shows skin only from this cover on; backs of surfaces, and what is not skin, are dark.
const WHOLE: f32 = 1.0 - 1e-4;
/// The gain rises and falls once in so many seconds.
const GAIN_PERIOD_S: f64 = 4.0;

impl Set {
    /// The skin to cast rays at, where it is looked at closely.
    pub(super) fn close_scene(&self) -> Option<&light::Scene> {
        self.close_look.as_ref().map(|look| &look.scene)
    }
}

impl Studio {
    /// Sets up what cameras see around `time_s` with shutters that are open for `exposure_s`; `close_look`: for wrinkle
    /// cameras, with the light traced from this moment's skin.
    #[must_use]
    pub fn set(&self, time_s: f64, exposure_s: f64, close_look: bool) -> Set {
        let pose = self.pose(time_s);
        let skin_in_world = self.in_world(&pose.skin, &pose.world_from_head);
        let at = |time_s: f64| {
            let pose = self.pose(time_s);
            self.in_world(&pose.skin, &pose.world_from_head)
        };
        let (open, close) = match exposure_s > 0.0 {
            true => (at(time_s - 0.5 * exposure_s), Some(at(time_s + 0.5 * exposure_s))),
            false => (skin_in_world.clone(), None),
        };
        let normals = vertex_normals(&skin_in_world, &self.body.triangles);
        let close_look = close_look.then(|| {
            let surface = light::Surface {
                positions: &skin_in_world,
                normals: &normals,
                triangles: &self.body.triangles,
            };
            let scene = light::Scene::build(&skin_in_world, &self.body.triangles, &[]);
            let light = light::shade(&scene, &surface, &self.plan, &self.body.albedo, &self.scenario.light);
            CloseLook { light, scene }
        });
        let props = self.props(time_s, exposure_s);
        let middle = close.is_some().then_some(&skin_in_world[..]);
        let mean_skin =
            Moment { open: &open, close: close.as_deref(), middle, normals: &[], irradiance: &[] }.mean();
        Set { pose, skin_in_world, normals, mean_skin, open, close, props, close_look }
    }

    /// Exposes an image of a set: linear light, before lens blur and noise.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the film's parameters make no sense.
    pub fn expose(&self, set: &Set, station: &Station) -> Result<Exposure, Error> {
        let wrinkle = set.close_look.as_ref().filter(|_| station.role == Role::Wrinkle);
        let irradiance = wrinkle.map_or(&self.baked, |look| &look.light);
        let face = Solid {
            skin: Skin { triangles: &self.body.triangles, albedo: &self.body.albedo },
            moment: Moment {
                open: &set.open,
                close: set.close.as_deref(),
                middle: set.close.is_some().then_some(&set.skin_in_world[..]),
                normals: &set.normals,
                irradiance,
            },
        };
        let props: Vec<Solid> = set.props.iter().map(Piece::solid).collect();
        let scene = Scene { face, layers: &self.layers, props: &props };
        film::expose(&station.camera, &scene, &self.scenario.film)
    }

    /// What the sensor makes of an exposure: 8 bits per channel, rows of red, green, blue.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the sensor's parameters make no sense.
    pub fn develop(
        &self,
        exposure: &Exposure,
        station: &Station,
        shot: i64,
        time_s: f64,
    ) -> Result<Vec<u8>, Error> {
        let drift = 1.0 + self.scenario.gain_drift * (TAU * time_s / GAIN_PERIOD_S).sin();
        let flash = self
            .scenario
            .flash
            .as_ref()
            .map_or(1.0, |flash| flash.brightness(self.scenario.extent.rate, time_s, station.exposure_s));
        let sensor = film::Sensor { gain: station.sensor.gain * drift * flash, ..station.sensor.clone() };
        let grain = Grain { seed: self.scenario.seed, camera: station.number, frame: shot };
        let mut image = film::develop(exposure, &sensor, grain)?;
        if station.mirrored {
            mirror(&mut image, exposure.size[0] as usize);
        }
        Ok(image)
    }

    /// What a sensor without faults makes of a picture that is taken before the take: no flash, no drift of the gain, no
    /// mirror. `shot` is one of a kind per camera.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the sensor's parameters make no sense.
    pub fn develop_before(
        &self,
        exposure: &Exposure,
        station: &Station,
        shot: i64,
    ) -> Result<Vec<u8>, Error> {
        let grain = Grain { seed: self.scenario.seed, camera: station.number, frame: shot };
        film::develop(exposure, &self.scenario.sensor, grain)
    }

    /// Normals of the skin as a camera sees them: 16 bits per channel, n = 2c − 1 in camera space (x right, y down, z away),
    /// of unit length; black where a pixel does not show skin only.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the film's parameters make no sense.
    pub fn normals_of(&self, set: &Set, station: &Station) -> Result<Vec<u16>, Error> {
        let rotation = station.camera.cam_from_world.rotation;
        let code = |normal: &Vector3<f64>| -> [f32; 3] {
            (rotation * normal).map(|x| 0.5 * (x as f32 + 1.0)).into()
        };
        let codes: Vec<[f32; 3]> = set.normals.iter().map(code).collect();
        let mean = self.unlit(set, station, &codes)?;
        let cover = self.unlit(set, station, &vec![[1.0; 3]; codes.len()])?;
        let mut normals: Vec<u16> = mean
            .iter()
            .zip(&cover)
            .flat_map(|(mean, [cover, ..])| {
                let normal = Vector3::from(*mean).map(|c| 2.0 * f64::from(c) - 1.0);
                match *cover >= WHOLE {
                    true => normal.normalize().map(|x| (65535.0 * 0.5 * (x + 1.0)).round() as u16).into(),
                    false => [0; 3],
                }
            })
            .collect();
        if station.mirrored {
            mirror(&mut normals, station.camera.image_size[0] as usize);
        }
        Ok(normals)
    }

    /// The mean colour of the skin in each pixel, as if the skin glowed in the colours of its vertices and all else were black.
    fn unlit(&self, set: &Set, station: &Station, colors: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, Error> {
        let light = vec![[1.0; 3]; colors.len()];
        let face = Solid {
            skin: Skin { triangles: &self.body.triangles, albedo: colors },
            moment: still(&set.skin_in_world, &light),
        };
        let dark: Vec<Vec<[f32; 3]>> =
            set.props.iter().map(|piece| vec![[0.0; 3]; piece.light.len()]).collect();
        let props: Vec<Solid> = set.props.iter().zip(&dark).map(|(piece, dark)| piece.lit_by(dark)).collect();
        let film = film::Film { background: [0.0; 3], gloss: None, ..self.scenario.film.clone() };
        let scene = Scene { face, layers: &self.bare, props: &props };
        Ok(film::expose(&station.camera, &scene, &film)?.radiance)
    }

    fn props(&self, time_s: f64, exposure_s: f64) -> Vec<Piece> {
        let fixed = |mesh: &Mesh, albedo: &[[f32; 3]]| {
            let at = |time_s: f64| self.in_world(&mesh.positions, &self.world_from_head(time_s));
            Piece::moving(mesh.triangles(), albedo.to_vec(), at, time_s, exposure_s)
        };
        let mut pieces: Vec<Piece> =
            self.body.props.iter().map(|prop| fixed(&prop.mesh, &prop.albedo)).collect();
        pieces.push(fixed(&self.headband.mesh, &self.headband.albedo));
        let hands = &self.scenario.hands;
        let count = hands.centers(self.scenario.seed, time_s).len();
        for number in 0..count {
            let form = ball(&Point3::origin(), hands.radius_mm);
            let at = |time_s: f64| {
                let center = hands.centers(self.scenario.seed, time_s)[number].coords;
                let points: Vec<Point3<f64>> = form.0.iter().map(|point| point + center).collect();
                self.in_world(&points, &nalgebra::Isometry3::identity())
            };
            let albedo = vec![FINGER; form.0.len()];
            pieces.push(Piece::moving(form.1.clone(), albedo, at, time_s, exposure_s));
        }
        pieces
    }
}

impl Piece {
    fn moving(
        triangles: Vec<[u32; 3]>,
        albedo: Vec<[f32; 3]>,
        at: impl Fn(f64) -> Vec<Point3<f64>>,
        time_s: f64,
        exposure_s: f64,
    ) -> Self {
        let light = vec![[PROP_LIGHT; 3]; albedo.len()];
        let (open, close) = match exposure_s > 0.0 {
            true => (at(time_s - 0.5 * exposure_s), Some(at(time_s + 0.5 * exposure_s))),
            false => (at(time_s), None),
        };
        Self { triangles, albedo, open, close, light }
    }

    /// The piece when the shutter opens, in another light.
    fn lit_by<'a>(&'a self, light: &'a [[f32; 3]]) -> Solid<'a> {
        Solid {
            skin: Skin { triangles: &self.triangles, albedo: &self.albedo },
            moment: still(&self.open, light),
        }
    }

    fn solid(&self) -> Solid<'_> {
        Solid {
            skin: Skin { triangles: &self.triangles, albedo: &self.albedo },
            moment: Moment {
                open: &self.open,
                close: self.close.as_deref(),
                middle: None,
                normals: &[],
                irradiance: &self.light,
            },
        }
    }
}

fn still<'a>(open: &'a [Point3<f64>], irradiance: &'a [[f32; 3]]) -> Moment<'a> {
    Moment { open, close: None, middle: None, normals: &[], irradiance }
}

/// Turns an image of three values a pixel left to right.
pub(super) fn mirror<T>(image: &mut [T], width: usize) {
    for row in image.chunks_exact_mut(3 * width) {
        for column in 0..width / 2 {
            for channel in 0..3 {
                row.swap(3 * column + channel, 3 * (width - 1 - column) + channel);
            }
        }
    }
}
