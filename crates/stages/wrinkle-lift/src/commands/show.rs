//! `wrinkle-lift show`.

use super::options::{Material, Options};
use anyhow::{Context, bail};
use artifact::canvas::{Canvas, Color};
use artifact::picture::write_rgb8;
use artifact::{FrameReader, ValleyPoint, Valleys, ValleysFrame};
use nalgebra::{Point3, Vector2, Vector3};
use rayon::prelude::*;
use stage::{ImageSource, Run, check_take};
use std::path::PathBuf;
use wrinkle_lift::{Ground, Moment, Scene, View};

/// Draws valleys over an image, and over the mesh without wrinkles as the camera sees it
///
/// The bottom of a valley is a line, yellow where it is shallow and red from d/w = 0.6 on, grey where it is flat; thin lines across it
/// are as long as it is wide (2w). What the face hides is left out.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    source: ImageSource,
    /// Valleys to draw (valleys)
    #[arg(long, value_name = "FILE")]
    valleys: PathBuf,
    /// Camera whose image is drawn
    #[arg(long, value_name = "ID")]
    camera: String,
    /// Frame to draw
    #[arg(long, value_name = "FRAME", allow_negative_numbers = true)]
    frame: i64,
    /// Part of the image: left, top, width, height in px [default: all]
    #[arg(long, value_name = "X,Y,W,H", value_parser = rectangle)]
    crop: Option<Rectangle>,
    /// Enlargement
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=8))]
    scale: u8,
    /// Picture to write, PNG: the image on the left, the mesh on the right
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Left, top, width, height, px.
#[derive(Debug, Clone, Copy)]
struct Rectangle([u32; 4]);

fn rectangle(text: &str) -> Result<Rectangle, String> {
    let numbers: Vec<u32> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    match <[u32; 4]>::try_from(numbers) {
        Ok(numbers) if text.split(',').count() == 4 => Ok(Rectangle(numbers)),
        _ => Err(format!("'{text}' is not four whole numbers, left,top,width,height")),
    }
}

const DIM: Color = [150, 150, 150];
const SHALLOW: Color = [255, 230, 40];
const DEEP: Color = [235, 30, 30];
/// d/w from which a valley is drawn as deep.
const DEEPEST: f64 = 0.6;
/// Every so manyth point has a line across.
const RUNGS: usize = 4;
/// A point is hidden where the surface is this much nearer to the camera, mm.
const BEHIND_MM: f64 = 1.0;

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    run.check_folders(&[&arguments.out])?;
    let footage = arguments.source.open(run)?;
    let (valleys, take) = read_valleys(run, arguments)?;
    check_take(run, &arguments.valleys, take.as_ref(), footage.take.as_ref())?;
    let material = arguments.options.read(run, footage.take.as_ref())?;
    let id = &arguments.camera;
    let camera = material.camera(id, &arguments.valleys)?;
    let lag = footage.clocks.get(id).map_or(0.0, |clock| clock.lag_frames(arguments.frame));
    let moment = Moment::of(arguments.frame, lag);
    let images = footage.camera(id)?;
    let number = footage.numbers().iter().position(|frame| *frame == arguments.frame);
    let path = number
        .and_then(|number| images.paths[number].as_ref())
        .with_context(|| format!("camera {id} has no image of frame {}", arguments.frame))?;
    let pose = material
        .pose(moment)
        .with_context(|| format!("the head has no pose in frame {}", arguments.frame))?;
    let crop = Crop::of(arguments.crop, camera.image_size, arguments.scale.into())?;
    let ground = Ground::of(&material.mesh);
    let scene = Scene::new(&ground, face_at(&material, moment)?, &material.spaces);
    let view = View::new(camera, &pose);
    let sight = Sight { material: &material, scene: &scene, view: &view, crop: &crop };
    let mut canvas = Canvas::new(2 * crop.size()[0], crop.size()[1])?;
    let image = images.read(path)?.to_8_bits();
    crop.paste(&mut canvas, 0, |x, y| {
        let first = 3 * (y * images.size[0] as usize + x);
        [image[first], image[first + 1], image[first + 2]]
    });
    sight.draw_face(&mut canvas, crop.size()[0]);
    let shown = sight.draw_valleys(&mut canvas, &valleys);
    run.result("valleys", valleys.valleys.len());
    run.result("points_shown", shown);
    run.publish(vec![write_rgb8(&arguments.out, canvas.width, canvas.height, &canvas.rgb)?])
}

fn read_valleys(
    run: &mut Run,
    arguments: &Arguments,
) -> anyhow::Result<(ValleysFrame, Option<artifact::TakeRef>)> {
    let path = &arguments.valleys;
    let reader = FrameReader::<Valleys>::open(path)?;
    run.input("valleys", path)?;
    let take = reader.header().take.clone();
    for frame in reader {
        let frame = frame?;
        if frame.frame == arguments.frame {
            return Ok((frame, take));
        }
    }
    bail!("{}: has no frame {}\n  to do: name one that it has", path.display(), arguments.frame)
}

fn face_at(material: &Material, moment: Moment) -> anyhow::Result<Vec<Point3<f64>>> {
    let mut cursor = material.sequence.cursor()?;
    let from = cursor.read(moment.from)?;
    match moment.share > 0.0 {
        true => Ok(moment.points(&from, &cursor.read(moment.from + 1)?)),
        false => Ok(from),
    }
}

/// A part of the image, enlarged.
struct Crop {
    corner: [u32; 2],
    sides: [u32; 2],
    scale: usize,
}

impl Crop {
    fn of(asked: Option<Rectangle>, image: [u32; 2], scale: usize) -> anyhow::Result<Self> {
        let Rectangle([x, y, width, height]) = asked.unwrap_or(Rectangle([0, 0, image[0], image[1]]));
        let ends = [x.saturating_add(width), y.saturating_add(height)];
        if width == 0 || height == 0 || ends[0] > image[0] || ends[1] > image[1] {
            bail!(
                "--crop {x},{y},{width},{height} is not within the image of {} × {} px",
                image[0],
                image[1]
            );
        }
        Ok(Self { corner: [x, y], sides: [width, height], scale })
    }

    fn size(&self) -> [usize; 2] {
        self.sides.map(|side| side as usize * self.scale)
    }

    /// The place of a pixel of the image on a canvas whose picture starts at column `left`; none outside.
    fn place(&self, pixel: Vector2<f64>, left: usize) -> Option<[f64; 2]> {
        let scale = self.scale as f64;
        let at = [0, 1].map(|axis| (pixel[axis] - f64::from(self.corner[axis]) + 0.5) * scale - 0.5);
        let inside = (0..2).all(|axis| (0.0..self.size()[axis] as f64).contains(&at[axis]));
        inside.then_some([at[0] + left as f64, at[1]])
    }

    fn paste(&self, canvas: &mut Canvas, left: usize, color: impl Fn(usize, usize) -> Color) {
        for y in 0..self.sides[1] as usize {
            for x in 0..self.sides[0] as usize {
                let corner = [left + x * self.scale, y * self.scale];
                let color = color(x + self.corner[0] as usize, y + self.corner[1] as usize);
                canvas.fill(corner, [self.scale; 2], color);
            }
        }
    }
}

/// What is drawn, from where.
struct Sight<'a> {
    material: &'a Material,
    scene: &'a Scene<'a>,
    view: &'a View<'a>,
    crop: &'a Crop,
}

impl Sight<'_> {
    /// The mesh in the light of a lamp beside the camera.
    fn draw_face(&self, canvas: &mut Canvas, left: usize) {
        let Crop { corner, sides, .. } = *self.crop;
        let normals = mesh::vertex_normals(&self.scene.in_head, self.scene.ground.triangles());
        let row = |y: u32| -> Vec<Color> {
            let pixel = |x: u32| {
                self.shade(Vector2::new(f64::from(x + corner[0]), f64::from(y + corner[1])), &normals)
            };
            (0..sides[0]).map(pixel).collect()
        };
        let rows: Vec<Vec<Color>> = (0..sides[1]).into_par_iter().map(row).collect();
        self.crop.paste(canvas, left, |x, y| rows[y - corner[1] as usize][x - corner[0] as usize]);
    }

    fn shade(&self, pixel: Vector2<f64>, normals: &[Vector3<f64>]) -> Color {
        let Some(ray) = self.view.ray(pixel) else { return [40; 3] };
        let Some(hit) = self.scene.cast(&self.view.eye(), &ray) else { return [40; 3] };
        let corners = self.scene.ground.triangles()[hit.spot.face as usize];
        let normal: Vector3<f64> =
            (0..3).map(|i| normals[corners[i] as usize] * hit.spot.barycentric[i]).sum();
        let light = -normal.normalize().dot(&ray);
        [(60.0 + 165.0 * light.clamp(0.0, 1.0).powf(0.8)).round() as u8; 3]
    }

    /// Draws all valleys on both pictures; gives how many points the camera sees.
    fn draw_valleys(&self, canvas: &mut Canvas, frame: &ValleysFrame) -> usize {
        let mut shown = 0;
        for points in frame.valleys.values() {
            let bottoms = self.pixels(points, |point| Point3::from(point.at_mm));
            let surface = |point: &ValleyPoint, side: f64| {
                let [at, normal, across] = [point.at_mm, point.normal, point.across].map(Vector3::from);
                Point3::from(at + normal * point.d_mm + across * (side * point.w_mm))
            };
            let feet = self.pixels(points, |point| surface(point, 0.0));
            let rims = [-1.0, 1.0].map(|side| self.pixels(points, |point| surface(point, side)));
            let seen: Vec<bool> = feet.iter().map(|foot| foot.is_some_and(|foot| self.sees(foot))).collect();
            shown += seen.iter().filter(|seen| **seen).count();
            for left in [0, self.crop.size()[0]] {
                for i in 0..points.len() {
                    let color = color(&points[i]);
                    if i % RUNGS == 0 && seen[i] && points[i].d_mm > 0.0 {
                        self.line(canvas, left, [rims[0][i], rims[1][i]], color);
                    }
                    if i > 0 && seen[i] && seen[i - 1] {
                        self.line(canvas, left, [bottoms[i - 1], bottoms[i]], color);
                    }
                }
            }
        }
        shown
    }

    /// Per point its pixel and its distance from the camera.
    fn pixels(
        &self,
        points: &[ValleyPoint],
        place: impl Fn(&ValleyPoint) -> Point3<f64>,
    ) -> Vec<Option<(Vector2<f64>, f64)>> {
        let inverse = &self.material.spaces.head_from_face;
        let in_face: Vec<Point3<f64>> = points.iter().map(place).collect();
        let pixel = |preimage: &operators::Preimage| {
            let pixel = self.view.project(&preimage.point)?;
            inverse.is_found(preimage).then_some((pixel, (preimage.point - self.view.eye()).norm()))
        };
        inverse.preimages(&in_face).iter().map(pixel).collect()
    }

    fn sees(&self, (pixel, distance): (Vector2<f64>, f64)) -> bool {
        let hit = self.view.ray(pixel).and_then(|ray| self.scene.cast(&self.view.eye(), &ray));
        hit.is_none_or(|hit| (hit.point - self.view.eye()).norm() > distance - BEHIND_MM)
    }

    fn line(&self, canvas: &mut Canvas, left: usize, ends: [Option<(Vector2<f64>, f64)>; 2], color: Color) {
        let place = |end: Option<(Vector2<f64>, f64)>| self.crop.place(end?.0, left);
        if let [Some(from), Some(to)] = ends.map(place) {
            canvas.line(from, to, color);
        }
    }
}

fn color(point: &ValleyPoint) -> Color {
    if point.d_mm == 0.0 || point.w_mm == 0.0 {
        return DIM;
    }
    let share = (point.d_mm / point.w_mm / DEEPEST).min(1.0);
    [0, 1, 2].map(|i| (f64::from(SHALLOW[i]) * (1.0 - share) + f64::from(DEEP[i]) * share).round() as u8)
}
