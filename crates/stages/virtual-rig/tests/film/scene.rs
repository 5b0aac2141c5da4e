//! Surfaces and cameras to film.

use camera::{BrownConrady, Camera, Lens};
use mesh::Mesh;
use nalgebra::{Point3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use virtual_rig::film::{Exposure, Film, Moment, Scene, Skin, Solid, expose};
use virtual_rig::paint::{Dot, Layers, Outline, Stroke, StrokeCoordinates};

/// A surface with everything that the film asks for.
pub(crate) struct Thing {
    pub(crate) open: Vec<Point3<f64>>,
    pub(crate) close: Option<Vec<Point3<f64>>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) normals: Vec<Vector3<f64>>,
    pub(crate) albedo: Vec<[f32; 3]>,
    pub(crate) irradiance: Vec<[f32; 3]>,
}

impl Thing {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let count = mesh.positions.len();
        Self {
            open: mesh.positions.clone(),
            close: None,
            normals: mesh::vertex_normals(&mesh.positions, &triangles),
            triangles,
            albedo: vec![[1.0; 3]; count],
            irradiance: vec![[1.0; 3]; count],
        }
    }

    /// A rectangle of two triangles in the plane z = `z`, facing +z.
    pub(crate) fn plate([left, right]: [f64; 2], [bottom, top]: [f64; 2], z: f64) -> Self {
        let corners = [[left, bottom, z], [right, bottom, z], [right, top, z], [left, top, z]];
        Self::of(&Mesh::from_triangles(corners.to_vec(), &[[0, 1, 2], [0, 2, 3]]))
    }

    pub(crate) fn colored(mut self, color: [f32; 3]) -> Self {
        self.albedo.fill(color);
        self
    }

    pub(crate) fn moving(mut self, way: Vector3<f64>) -> Self {
        self.close = Some(self.open.iter().map(|point| point + way).collect());
        self
    }

    pub(crate) fn solid(&self) -> Solid<'_> {
        Solid {
            skin: Skin { triangles: &self.triangles, albedo: &self.albedo },
            moment: Moment {
                open: &self.open,
                close: self.close.as_deref(),
                middle: None,
                normals: &self.normals,
                irradiance: &self.irradiance,
            },
        }
    }

    pub(crate) fn paint(&self, dots: Vec<Dot>, strokes: Vec<(Stroke, StrokeCoordinates)>) -> Layers {
        Layers::build(&self.open, &self.normals, &self.triangles, dots, strokes)
    }

    pub(crate) fn unpainted(&self) -> Layers {
        self.paint(vec![], vec![])
    }

    /// A dot in the triangle whose middle is nearest to a point.
    pub(crate) fn dot_near(&self, point: Point3<f64>, outline: Outline) -> Dot {
        let off = |triangle: &[u32; 3]| {
            let sum: Vector3<f64> = triangle.iter().map(|&vertex| self.open[vertex as usize].coords).sum();
            (sum / 3.0 - point.coords).norm()
        };
        let nearest = (0..self.triangles.len())
            .min_by(|one, other| off(&self.triangles[*one]).total_cmp(&off(&self.triangles[*other])))
            .unwrap();
        self.dot((nearest as u32, [0.2, 0.3, 0.5]), outline)
    }

    pub(crate) fn dot(&self, place: (u32, [f64; 3]), outline: Outline) -> Dot {
        Dot::at(&format!("m{}", place.0), outline, place, &self.triangles, &self.open, &self.normals)
    }
}

pub(crate) fn film() -> Film {
    Film { background: [0.0; 3], ..Film::default() }
}

pub(crate) fn shot(camera: &Camera, face: &Thing, layers: &Layers, props: &[&Thing]) -> Exposure {
    let props: Vec<Solid<'_>> = props.iter().map(|thing| thing.solid()).collect();
    expose(camera, &Scene { face: face.solid(), layers, props: &props }, &film()).unwrap()
}

/// A camera without distortion, 1000 mm before the plane z = 0 of the world, where a pixel is a millimetre: the world's
/// (x, y, 0) lands on the pixel (20 + x, 15 − y).
pub(crate) fn ruler() -> Camera {
    let eye = Point3::new(0.0, 0.0, 1000.0);
    Camera {
        image_size: [41, 31],
        lens: Lens {
            focal_px: Vector2::repeat(1000.0),
            center_px: Vector2::new(20.0, 15.0),
            distortion: BrownConrady::default(),
        },
        cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
    }
}

/// A mocap camera as in the studio, somewhere before the face.
pub(crate) fn mocap(random: &mut ChaCha8Rng) -> Camera {
    let mut draw = |size: f64| random.random_range(-size..size);
    let eye = Point3::new(draw(500.0), draw(300.0), 750.0 + draw(80.0));
    let target = Point3::new(draw(15.0), draw(15.0), draw(15.0));
    Camera {
        image_size: [656, 490],
        lens: Lens {
            focal_px: Vector2::new(1750.0 + draw(30.0), 1750.0),
            center_px: Vector2::new(327.5 + draw(8.0), 244.5 + draw(8.0)),
            distortion: BrownConrady { k1: -0.18 + draw(0.05), k2: 0.12, p1: 6e-4, p2: -4e-4, k3: 0.0 },
        },
        cam_from_world: Camera::pose_looking_at(eye, target, Vector3::new(draw(0.2), 1.0, 0.0)),
    }
}
