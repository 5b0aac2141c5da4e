//! Which triangle lies under each texel: the rasteriser of the CPU reference.

use crate::Error;
use artifact::gltf::SkinnedMesh;

/// A mesh laid out over a map of one size.
///
/// A texel belongs to the triangle over its centre. Around the charts some texels belong to the nearest triangle, so that filters do
/// not reach into what is not the face.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// Width, height, px.
    pub size: [usize; 2],
    /// Texels that more than one triangle lies over; the first one holds there. Mirrored halves of a face that share texels can be
    /// told apart by a shader, but not by a map.
    pub shared: usize,
    /// Triangles that reach out of the map, where they are cut off.
    pub outside: usize,
    triangles: Vec<[u32; 3]>,
    starts: Vec<u32>,
    spans: Vec<Span>,
}

/// Neighbouring texels of a row under one triangle.
#[derive(Debug, Clone, Copy)]
struct Span {
    x: u32,
    length: u32,
    triangle: u32,
    /// Barycentric coordinates of the second and third corner at the first texel, and their steps.
    at: [f32; 2],
    step: [f32; 2],
}

/// Marks a texel that no triangle lies over.
const NOBODY: u32 = u32::MAX;

impl Atlas {
    /// Lays a mesh out; texels up to `padding` px beside a chart belong to it.
    ///
    /// # Errors
    /// [`Error::NoUvs`] if the mesh has no texture coordinates.
    pub fn new(mesh: &SkinnedMesh, size: [usize; 2], padding: usize) -> Result<Self, Error> {
        if mesh.uvs.is_empty() {
            return Err(Error::NoUvs { mesh: mesh.name.clone() });
        }
        let planes: Vec<Plane> =
            mesh.triangles.iter().map(|triangle| Plane::of(mesh, triangle, size)).collect();
        let mut owners = Owners { size, owner: vec![NOBODY; size[0] * size[1]], shared: 0 };
        let mut outside = 0;
        for (number, plane) in planes.iter().enumerate() {
            outside += usize::from(owners.claim(number as u32, plane));
        }
        let sources = owners.pad(padding);
        let (starts, spans) = owners.spans(&planes, &sources);
        Ok(Self { size, shared: owners.shared, outside, triangles: mesh.triangles.clone(), starts, spans })
    }

    /// Interpolates weights of vertices over a row, as a GPU does over a triangle; 0 where no triangle is. `active` tells of each
    /// run of `run` texels whether any weight there is not 0.
    pub(crate) fn row(&self, y: usize, weights: &[f32], row: &mut [f32], run: usize, active: &mut [bool]) {
        row.fill(0.0);
        active.fill(false);
        for span in &self.spans[self.starts[y] as usize..self.starts[y + 1] as usize] {
            let [a, b, c] = self.triangles[span.triangle as usize].map(|corner| weights[corner as usize]);
            if a == 0.0 && b == 0.0 && c == 0.0 {
                continue;
            }
            let (x, length) = (span.x as usize, span.length as usize);
            let start = a + span.at[0] * (b - a) + span.at[1] * (c - a);
            let step = span.step[0] * (b - a) + span.step[1] * (c - a);
            for (i, weight) in row[x..x + length].iter_mut().enumerate() {
                *weight = (start + i as f32 * step).clamp(0.0, 1.0);
            }
            active[x / run..=(x + length - 1) / run].fill(true);
        }
    }

    /// Weights of vertices over the whole map, row after row.
    #[must_use]
    pub fn spread(&self, weights: &[f32]) -> Vec<f32> {
        let [width, height] = self.size;
        let mut all = vec![0.0; width * height];
        let mut active = [false];
        for (y, row) in all.chunks_exact_mut(width.max(1)).enumerate() {
            self.row(y, weights, row, width, &mut active);
        }
        all
    }
}

/// A triangle in texels, centres at whole numbers.
struct Plane {
    corners: [[f64; 2]; 3],
    /// Gradients of the barycentric coordinates of the second and third corner.
    gradients: [[f64; 2]; 2],
}

impl Plane {
    fn of(mesh: &SkinnedMesh, triangle: &[u32; 3], size: [usize; 2]) -> Self {
        let uvs = triangle.map(|corner| mesh.uvs[corner as usize]);
        // Textures repeat: a triangle in another tile is the same one here.
        let tile = [0, 1].map(|axis| uvs.iter().map(|uv| uv[axis]).fold(f64::INFINITY, f64::min).floor());
        let texel = |uv: [f64; 2]| -> [f64; 2] {
            std::array::from_fn(|axis| (uv[axis] - tile[axis]) * size[axis] as f64 - 0.5)
        };
        let corners = uvs.map(texel);
        let [b, c] = [1, 2].map(|i| [corners[i][0] - corners[0][0], corners[i][1] - corners[0][1]]);
        let area = b[0] * c[1] - b[1] * c[0];
        let scale = if area == 0.0 { 0.0 } else { 1.0 / area };
        let gradients = [[c[1] * scale, -c[0] * scale], [-b[1] * scale, b[0] * scale]];
        Self { corners, gradients }
    }

    fn coordinates(&self, at: [f64; 2]) -> [f32; 2] {
        let [dx, dy] = [at[0] - self.corners[0][0], at[1] - self.corners[0][1]];
        self.gradients.map(|[x, y]| (x * dx + y * dy) as f32)
    }

    /// From where to where the triangle crosses a row. An edge is met at the same place from both its sides, so that neighbours
    /// share no texel and leave none out.
    fn crossing(&self, y: f64) -> Option<[f64; 2]> {
        let mut found = [f64::INFINITY, f64::NEG_INFINITY];
        for i in 0..3 {
            let (mut low, mut high) = (self.corners[i], self.corners[(i + 1) % 3]);
            if low[1] > high[1] {
                (low, high) = (high, low);
            }
            if low[1] <= y && y < high[1] {
                let x = low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
                found = [found[0].min(x), found[1].max(x)];
            }
        }
        (found[0] < found[1]).then_some(found)
    }
}

/// Whose each texel is.
struct Owners {
    size: [usize; 2],
    owner: Vec<u32>,
    shared: usize,
}

impl Owners {
    /// Gives a triangle the texels under it that are still free; whether it reaches out of the map.
    fn claim(&mut self, triangle: u32, plane: &Plane) -> bool {
        let [width, height] = self.size;
        let extent = |axis: usize| {
            let values = plane.corners.map(|corner| corner[axis]);
            [
                values.into_iter().fold(f64::INFINITY, f64::min),
                values.into_iter().fold(f64::NEG_INFINITY, f64::max),
            ]
        };
        let ([left, right], [top, bottom]) = (extent(0), extent(1));
        let first = top.ceil().max(0.0) as usize;
        let last = bottom.ceil().clamp(0.0, height as f64) as usize;
        for y in first..last {
            let Some([from, to]) = plane.crossing(y as f64) else { continue };
            let columns = [from, to].map(|x| x.ceil().clamp(0.0, width as f64) as usize);
            for owner in &mut self.owner[y * width + columns[0]..y * width + columns[1].max(columns[0])] {
                match *owner {
                    NOBODY => *owner = triangle,
                    _ => self.shared += 1,
                }
            }
        }
        left < -0.5 - SLACK
            || top < -0.5 - SLACK
            || right > width as f64 - 0.5 + SLACK
            || bottom > height as f64 - 0.5 + SLACK
    }

    /// Per padded texel the texel of a chart that it copies.
    fn pad(&self, padding: usize) -> Vec<(u32, u32)> {
        let [width, height] = self.size;
        let mut taken: Vec<bool> = self.owner.iter().map(|owner| *owner != NOBODY).collect();
        let mut sources = Vec::new();
        let mut rim: Vec<(usize, usize)> =
            (0..taken.len()).filter(|&texel| taken[texel]).map(|texel| (texel, texel)).collect();
        for _ in 0..padding {
            let mut next = Vec::new();
            for &(texel, source) in &rim {
                let (x, y) = (texel % width, texel / width);
                let beside = [
                    (x > 0).then(|| texel - 1),
                    (x + 1 < width).then_some(texel + 1),
                    (y > 0).then(|| texel.wrapping_sub(width)),
                    (y + 1 < height).then_some(texel + width),
                ];
                for free in beside.into_iter().flatten() {
                    if !std::mem::replace(&mut taken[free], true) {
                        next.push((free, source));
                        sources.push((free as u32, source as u32));
                    }
                }
            }
            rim = next;
        }
        sources.sort_unstable();
        sources
    }

    fn spans(&self, planes: &[Plane], sources: &[(u32, u32)]) -> (Vec<u32>, Vec<Span>) {
        let [width, height] = self.size;
        let (mut starts, mut spans, mut padded) = (vec![0], Vec::new(), sources.iter().peekable());
        for y in 0..height {
            let row = &self.owner[y * width..(y + 1) * width];
            let mut x = 0;
            while x < width {
                let owner = row[x];
                let length = row[x..].iter().take_while(|other| **other == owner).count();
                if owner != NOBODY {
                    let plane = &planes[owner as usize];
                    let at = plane.coordinates([x as f64, y as f64]);
                    let step = plane.gradients.map(|gradient| gradient[0] as f32);
                    spans.push(Span { x: x as u32, length: length as u32, triangle: owner, at, step });
                }
                x += length;
            }
            while let Some(&(texel, source)) =
                padded.next_if(|(texel, _)| (*texel as usize) < (y + 1) * width)
            {
                let (triangle, source) = (self.owner[source as usize], source as usize);
                let at =
                    planes[triangle as usize].coordinates([(source % width) as f64, (source / width) as f64]);
                spans.push(Span { x: texel % width as u32, length: 1, triangle, at, step: [0.0; 2] });
            }
            starts.push(spans.len() as u32);
        }
        (starts, spans)
    }
}

/// Texture coordinates of 32 bits at the rim of the map reach out a little, px.
const SLACK: f64 = 1e-2;
