//! The photographs.

use super::light::Lit;
use super::marks::marks;
use super::params::FaceScenario;
use super::pictures::{FacePair, FaceTruth, FilmFrame};
use super::setting::{TARGET_MM, Thing, about, camera, close, interocular, normal};
use super::truth::{Folds, picture_areas, places, shown};
use crate::Error;
use crate::body::{Body, Fineness, MUSCLES};
use crate::film::{self, Exposure, Film, Gloss, Grain, Moment, Scene, Sensor, Skin, Solid};
use crate::paint::Layers;
use crate::pair::waves::Waves;
use crate::wrinkle::{self, Wrinkles};
use artifact::{Landmark, Landmarks};
use camera::Camera;
use mesh::vertex_normals;
use nalgebra::{Isometry3, Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// What is behind the head.
const BACKGROUND: [f32; 3] = [0.18, 0.19, 0.2];
/// Light on eyeballs, teeth and hood.
const PROP_LIGHT: f32 = 0.75;
/// How narrow the sheen is.
const SHINE: f32 = 24.0;
/// Finer triangles reach this far from a line, mm.
const FINE_REACH_MM: f64 = 8.0;
/// A pixel shows skin only from this cover on.
const WHOLE: f32 = 1.0 - 1e-4;

/// A face before a camera.
pub struct FaceStudio {
    scenario: FaceScenario,
    seed: u64,
    body: Body,
    wrinkles: Wrinkles,
    bare: Layers,
    close: Vec<bool>,
    camera: Camera,
    marks: BTreeMap<String, u32>,
    motion: Isometry3<f64>,
    turns: [f64; 3],
    exposure: f64,
    uneven: Waves,
    sheen: [f64; 2],
}

/// The skin at some share of the way.
struct Stance {
    large_scale: Vec<Point3<f64>>,
    wrinkled: Vec<Point3<f64>>,
    deepest_mm: f64,
}

impl FaceStudio {
    /// A face for a scenario; the rest is drawn.
    ///
    /// # Errors
    /// A parameter that makes no sense; a line that misses the face.
    pub fn set_up(scenario: &FaceScenario, seed: u64) -> Result<Self, Error> {
        scenario.check()?;
        let lines = wrinkle::lines(seed, &scenario.lines);
        let paths: Vec<_> = lines.iter().map(|line| line.path.clone()).collect();
        let fineness = Fineness { reach_mm: FINE_REACH_MM, crease_mm: scenario.crease_mm };
        let body = Body::parametric(seed, scenario.vertices, &paths, fineness);
        let rest = &body.mesh.positions;
        let wrinkles = Wrinkles::place(rest, &body.triangles, &body.domain, &lines, &scenario.folds)?;
        let normals = vertex_normals(rest, &body.triangles);
        let bare = Layers::build(rest, &normals, &body.triangles, Vec::new(), Vec::new());
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xface_0000);
        let own = &scenario.degradation;
        let [least, most] = own.exposure;
        let change = least + (most - least) * rng.random::<f64>();
        let mut within = |most: f64| most * (2.0 * rng.random::<f64>() - 1.0);
        let turns = [0; 3].map(|_| within(own.turn_deg.to_radians()));
        let shift = [0; 3].map(|_| within(own.shift_mm));
        Ok(Self {
            close: close(&wrinkles, rest.len()),
            camera: camera(scenario),
            marks: marks(&body),
            motion: about(&Point3::from(TARGET_MM), turns, shift),
            turns,
            exposure: if rng.random() { 1.0 + change } else { 1.0 / (1.0 + change) },
            uneven: Waves::new(&mut rng, [60.0, 180.0]),
            sheen: [0; 2].map(|_| own.specular * (0.4 * (2.0 * rng.random::<f64>() - 1.0)).exp()),
            scenario: scenario.clone(),
            seed,
            body,
            wrinkles,
            bare,
        })
    }

    /// The pair.
    ///
    /// # Errors
    /// If the film's parameters make no sense.
    pub fn pair(&self) -> Result<FacePair, Error> {
        let (rest, end) = (self.stance(0.0), self.stance(1.0));
        let [x, y, z] = self.turns;
        let shift = self.motion * Point3::from(TARGET_MM) - Point3::from(TARGET_MM);
        Ok(FacePair {
            side: self.scenario.side_px as usize,
            neutral: self.photograph(&rest, 0.0, 0)?,
            expression: self.photograph(&end, 1.0, 1)?,
            neutral_landmarks: self.landmarks(&rest, 0.0, 0),
            expression_landmarks: self.landmarks(&end, 1.0, 1),
            normals: self.normals(&rest, &end)?,
            truth: FaceTruth {
                exposure: self.exposure,
                motion: [x, y, z, shift.x, shift.y, shift.z],
                deepest_mm: end.deepest_mm,
            },
        })
    }

    /// Pictures on the way, the first at rest and the last with the whole expression.
    ///
    /// # Errors
    /// If the film's parameters make no sense.
    pub fn film(&self, count: u32, mut each: impl FnMut(FilmFrame)) -> Result<(), Error> {
        let rest = self.stance(0.0);
        let at = places(&self.camera, &rest.wrinkled);
        let weights = picture_areas(&self.body.triangles, &at);
        let tangent = |stance: &Stance| self.folds(stance).tangent_normals(&at);
        let end = tangent(&self.stance(1.0));
        for frame in 0..count {
            let way = f64::from(frame) / f64::from(count.max(2) - 1);
            let stance = self.stance(way);
            each(FilmFrame {
                picture: self.photograph(&stance, way, 2 + i64::from(frame))?,
                landmarks: self.landmarks(&stance, way, 2 + u64::from(frame)),
                way,
                shown: shown(&tangent(&stance), &end, &weights),
            });
        }
        Ok(())
    }

    fn stance(&self, way: f64) -> Stance {
        let weight = |muscle: &&str| way * self.scenario.muscles.get(*muscle).copied().unwrap_or(0.0);
        let weights: Vec<f64> = MUSCLES.iter().map(weight).collect();
        let large_scale = self.body.large_scale(&weights);
        let folded = self.wrinkles.fold(&large_scale);
        let depths = folded.valleys.iter().flat_map(|valley| &valley.points).map(|point| point.d_mm);
        Stance { large_scale, deepest_mm: depths.fold(0.0, f64::max), wrinkled: folded.positions }
    }

    fn folds<'a>(&'a self, stance: &'a Stance) -> Folds<'a> {
        Folds {
            triangles: &self.body.triangles,
            large_scale: &stance.large_scale,
            wrinkled: &stance.wrinkled,
        }
    }

    /// Where the head is at a share of the way.
    fn head(&self, way: f64) -> Isometry3<f64> {
        Isometry3::identity().lerp_slerp(&self.motion, way)
    }

    /// 8-bit sRGB; `shot` is one of a kind.
    fn photograph(&self, stance: &Stance, way: f64, shot: i64) -> Result<Vec<u8>, Error> {
        let head = self.head(way);
        let points: Vec<Point3<f64>> = stance.wrinkled.iter().map(|point| head * point).collect();
        let normals = vertex_normals(&points, &self.body.triangles);
        let lit = Lit {
            positions: &points,
            normals: &normals,
            triangles: &self.body.triangles,
            albedo: &self.body.albedo,
            close: &self.close,
        };
        let light = lit.light(&self.scenario);
        let [x, y] = self.scenario.flash_tilt;
        let sheen = self.sheen[0] + way * (self.sheen[1] - self.sheen[0]);
        // Under open sky skin shines in all directions, mostly at grazing ones.
        let flash = self.scenario.flash_share;
        let gloss = Gloss {
            strength: (sheen * (0.3 + 0.7 * flash)) as f32,
            exponent: SHINE,
            rim: (sheen * (1.0 - flash)) as f32,
            toward_key: [x, y, 1.0],
        };
        let film = Film { background: BACKGROUND, gloss: Some(gloss), ..Film::default() };
        let moment =
            |normals| Moment { open: &points, close: None, middle: None, normals, irradiance: &light };
        let face = Solid {
            skin: Skin { triangles: &self.body.triangles, albedo: &self.body.albedo },
            moment: moment(&normals),
        };
        let mut exposure = self.expose(face, &head, PROP_LIGHT, &film)?;
        self.expose_otherwise(&mut exposure, way);
        let own = &self.scenario.degradation;
        let sensor = Sensor { lens_blur_px: own.blur_px, noise_at_mid_grey: own.noise, ..Sensor::default() };
        film::develop(&exposure, &sensor, Grain { seed: self.seed, camera: 0, frame: shot })
    }

    /// The exposure of the expression, which changes slowly over the picture.
    fn expose_otherwise(&self, exposure: &mut Exposure, way: f64) {
        let side = exposure.size[0] as usize;
        let gain = 1.0 + way * (self.exposure - 1.0);
        for (index, light) in exposure.radiance.iter_mut().enumerate() {
            let at = [index % side, index / side].map(|place| place as f64 * self.scenario.pixel_mm);
            let gain = gain * (1.0 + way * self.scenario.degradation.uneven * self.uneven.at(at));
            *light = light.map(|light| (f64::from(light) * gain) as f32);
        }
    }

    fn expose(
        &self,
        face: Solid<'_>,
        head: &Isometry3<f64>,
        light: f32,
        film: &Film,
    ) -> Result<Exposure, Error> {
        let things: Vec<Thing> = self.body.props.iter().map(|prop| Thing::of(prop, head, light)).collect();
        let props: Vec<Solid> = things.iter().map(Thing::solid).collect();
        film::expose(&self.camera, &Scene { face, layers: &self.bare, props: &props }, film)
    }

    /// The true map.
    fn normals(&self, rest: &Stance, end: &Stance) -> Result<Vec<[f64; 3]>, Error> {
        let at = places(&self.camera, &rest.wrinkled);
        let code = |normal: Vector3<f64>| -> [f32; 3] { normal.map(|x| 0.5 * (x as f32 + 1.0)).into() };
        let codes: Vec<[f32; 3]> = self.folds(end).tangent_normals(&at).into_iter().map(code).collect();
        let mean = self.unlit(rest, &codes)?;
        let cover = self.unlit(rest, &vec![[1.0; 3]; codes.len()])?;
        let normal = |(mean, cover): (&[f32; 3], &[f32; 3])| match cover[0] >= WHOLE {
            true => Vector3::from(*mean).map(|c| 2.0 * f64::from(c) - 1.0).normalize().into(),
            false => [0.0; 3],
        };
        Ok(mean.iter().zip(&cover).map(normal).collect())
    }

    /// The skin as if it glowed in the colours of its vertices and all else were black.
    fn unlit(&self, stance: &Stance, colors: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, Error> {
        let light = vec![[1.0; 3]; colors.len()];
        let face = Solid {
            skin: Skin { triangles: &self.body.triangles, albedo: colors },
            moment: Moment {
                open: &stance.wrinkled,
                close: None,
                middle: None,
                normals: &[],
                irradiance: &light,
            },
        };
        let film = Film { background: [0.0; 3], gloss: None, ..Film::default() };
        Ok(self.expose(face, &Isometry3::identity(), 0.0, &film)?.radiance)
    }

    /// What somebody who places landmarks sees, and how far off they are.
    fn landmarks(&self, stance: &Stance, way: f64, shot: u64) -> Landmarks {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ 0x1a_0000 ^ shot << 32);
        let head = self.head(way);
        let depth = |point: &Point3<f64>| (self.camera.cam_from_world * point).z;
        let middle = depth(&Point3::from(TARGET_MM));
        let mut points = BTreeMap::new();
        for (id, vertex) in &self.marks {
            let point = head * stance.wrinkled[*vertex as usize];
            let off = [0, 1].map(|_| self.scenario.degradation.landmark_px * normal(&mut rng));
            let Some(pixel) = self.camera.project(&point) else { continue };
            let at = [pixel.x + off[0], pixel.y + off[1]];
            let depth_px = Some((depth(&point) - middle) / self.scenario.pixel_mm);
            points.insert(id.clone(), Landmark { at, depth_px });
        }
        let side = self.scenario.side_px;
        let interocular_px = interocular(&points);
        Landmarks { image: None, size: Some([side, side]), interocular_px, points }
    }
}
