//! Casting the same directions from many points, neighbours together.

use super::Scene;
use super::beam::{Beam, Heading, Hits, LANES, Lanes, NONE, Origins};
use super::scene::padded;
use nalgebra::{Point3, Vector3};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Where light is received.
#[derive(Debug, Clone, Copy)]
pub(super) struct Receiver {
    /// Where rays start, in the scene's own coordinates.
    origin: [f32; 3],
    /// Unit length; rays are cast on this side.
    normal: [f32; 3],
}

impl Receiver {
    /// Rays start at `point` + `lift`, mm.
    pub(super) fn new(
        scene: &Scene,
        point: &Point3<f64>,
        lift: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> Self {
        let normal = [normal.x as f32, normal.y as f32, normal.z as f32];
        Self { origin: scene.local(&(point + lift)), normal }
    }
}

/// The irradiance (over π) of each receiver: the mean over `directions` above its horizon, weighted by their cosine, of
/// `sky` (one radiance per direction) where nothing is in the way. A receiver without a normal gets 0.
pub(super) fn open_sky(
    scene: &Scene,
    receivers: &[Receiver],
    directions: &[[f32; 3]],
    sky: &[f32],
) -> Vec<f32> {
    let headings: Vec<Heading> = directions.iter().map(|&direction| Heading::new(direction)).collect();
    let arch = Arch::new();
    by_groups(receivers, |group, stack| {
        arch.dispatch(OpenSky { scene, headings: &headings, directions, sky, group, stack })
    })
}

/// What each receiver gets from the surface around it: the mean as in [`open_sky`] of `glow` where something is hit,
/// given the triangle and the weights of its second and third corner.
pub(super) fn surroundings<G>(
    scene: &Scene,
    receivers: &[Receiver],
    directions: &[[f32; 3]],
    glow: G,
) -> Vec<[f32; 3]>
where
    G: Fn(u32, f32, f32) -> [f32; 3] + Sync,
{
    let headings: Vec<Heading> = directions.iter().map(|&direction| Heading::new(direction)).collect();
    let arch = Arch::new();
    by_groups(receivers, |group, stack| {
        arch.dispatch(Surroundings { scene, headings: &headings, directions, glow: &glow, group, stack })
    })
}

/// Receivers side by side.
struct Group {
    origins: Origins,
    normal: [Lanes; 3],
}

impl Group {
    fn of(receivers: &[Receiver], members: &[u32]) -> Self {
        let center = receivers[members[0] as usize].origin;
        let mut group = Self {
            origins: Origins { center: padded(center), offset: [[0.0; LANES]; 3] },
            normal: [[0.0; LANES]; 3],
        };
        for (lane, &member) in members.iter().enumerate() {
            let receiver = &receivers[member as usize];
            for axis in 0..3 {
                group.origins.offset[axis][lane] = receiver.origin[axis] - center[axis];
                group.normal[axis][lane] = receiver.normal[axis];
            }
        }
        group
    }

    /// Per lane the cosine to the normal, 0 below the horizon.
    #[inline(always)]
    fn cosines(&self, direction: [f32; 3]) -> Lanes {
        let mut cosines = [0.0; LANES];
        for lane in 0..LANES {
            let cosine = self.normal[0][lane] * direction[0]
                + self.normal[1][lane] * direction[1]
                + self.normal[2][lane] * direction[2];
            cosines[lane] = if cosine > 0.0 { cosine } else { 0.0 };
        }
        cosines
    }
}

/// Runs `work` on groups of neighbours, in parallel; each lane's outcome is its receiver's.
fn by_groups<T: Copy + Default + Send>(
    receivers: &[Receiver],
    work: impl Fn(&Group, &mut Vec<u32>) -> [T; LANES] + Sync,
) -> Vec<T> {
    let order = along_curve(receivers);
    let lanes: Vec<[T; LANES]> = order
        .par_chunks(LANES)
        .map_init(Vec::new, |stack, members| work(&Group::of(receivers, members), stack))
        .collect();
    let mut values = vec![T::default(); receivers.len()];
    for (members, lanes) in order.chunks(LANES).zip(&lanes) {
        for (&member, &value) in members.iter().zip(lanes) {
            values[member as usize] = value;
        }
    }
    values
}

/// Receivers in the order of a space-filling curve, so that neighbours come together.
fn along_curve(receivers: &[Receiver]) -> Vec<u32> {
    let mut low = [f32::MAX; 3];
    let mut extent = f32::MIN_POSITIVE;
    for receiver in receivers {
        low = std::array::from_fn(|axis| low[axis].min(receiver.origin[axis]));
    }
    for receiver in receivers {
        extent = (0..3).fold(extent, |extent, axis| extent.max(receiver.origin[axis] - low[axis]));
    }
    let key = |receiver: &Receiver| {
        let cell =
            |axis: usize| f64::from((receiver.origin[axis] - low[axis]) / extent) * f64::from((1 << 21) - 1);
        spread(cell(0) as u64) | spread(cell(1) as u64) << 1 | spread(cell(2) as u64) << 2
    };
    let mut order: Vec<(u64, u32)> =
        receivers.par_iter().enumerate().map(|(at, receiver)| (key(receiver), at as u32)).collect();
    order.par_sort_unstable();
    order.into_iter().map(|(_, at)| at).collect()
}

/// Two zeros between the lowest 21 bits.
fn spread(bits: u64) -> u64 {
    [
        (32, 0x1f_0000_0000_ffff),
        (16, 0x1f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ]
    .into_iter()
    .fold(bits, |bits, (shift, mask)| (bits | bits << shift) & mask)
}

struct OpenSky<'a> {
    scene: &'a Scene,
    headings: &'a [Heading],
    directions: &'a [[f32; 3]],
    sky: &'a [f32],
    group: &'a Group,
    stack: &'a mut Vec<u32>,
}

impl NullaryFnOnce for OpenSky<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn call(self) -> Lanes {
        let (mut all, mut open) = ([0.0; LANES], [0.0; LANES]);
        for ((heading, &direction), &sky) in self.headings.iter().zip(self.directions).zip(self.sky) {
            let cosines = self.group.cosines(direction);
            let Some(mut hits) = looking_up(&cosines) else { continue };
            self.scene.tree.trace::<true>(&Beam::new(heading, &self.group.origins), &mut hits, self.stack);
            for lane in 0..LANES {
                all[lane] += cosines[lane];
                open[lane] += if hits.reach[lane] > 0.0 { cosines[lane] * sky } else { 0.0 };
            }
        }
        std::array::from_fn(|lane| if all[lane] > 0.0 { open[lane] / all[lane] } else { 0.0 })
    }
}

struct Surroundings<'a, G> {
    scene: &'a Scene,
    headings: &'a [Heading],
    directions: &'a [[f32; 3]],
    glow: &'a G,
    group: &'a Group,
    stack: &'a mut Vec<u32>,
}

impl<G: Fn(u32, f32, f32) -> [f32; 3]> NullaryFnOnce for Surroundings<'_, G> {
    type Output = [[f32; 3]; LANES];

    #[inline(always)]
    fn call(self) -> [[f32; 3]; LANES] {
        let (mut all, mut sum) = ([0.0; LANES], [[0.0; 3]; LANES]);
        for (heading, &direction) in self.headings.iter().zip(self.directions) {
            let cosines = self.group.cosines(direction);
            let Some(mut hits) = looking_up(&cosines) else { continue };
            self.scene.tree.trace::<false>(&Beam::new(heading, &self.group.origins), &mut hits, self.stack);
            for lane in 0..LANES {
                all[lane] += cosines[lane];
                if hits.triangle[lane] != NONE {
                    let glow = (self.glow)(hits.triangle[lane], hits.u[lane], hits.v[lane]);
                    sum[lane] =
                        std::array::from_fn(|channel| sum[lane][channel] + cosines[lane] * glow[channel]);
                }
            }
        }
        std::array::from_fn(|lane| sum[lane].map(|sum| if all[lane] > 0.0 { sum / all[lane] } else { 0.0 }))
    }
}

/// Rays without end where the cosine is positive; none if there is no such lane.
#[inline(always)]
fn looking_up(cosines: &Lanes) -> Option<Hits> {
    let mut reach = [-1.0; LANES];
    let mut any = false;
    for lane in 0..LANES {
        any |= cosines[lane] > 0.0;
        reach[lane] = if cosines[lane] > 0.0 { f32::INFINITY } else { -1.0 };
    }
    any.then(|| Hits::none(reach))
}

/// The rays that [`open_sky`] casts, in its order, as origins (in the scene's coordinates) and directions.
pub(super) fn rays(receivers: &[Receiver], directions: &[[f32; 3]]) -> Vec<[[f32; 3]; 2]> {
    let order = along_curve(receivers);
    let mut rays = vec![];
    for members in order.chunks(LANES) {
        let cosines = Group::of(receivers, members);
        for &direction in directions {
            let cosines = cosines.cosines(direction);
            let up = members.iter().zip(cosines).filter(|(_, cosine)| *cosine > 0.0);
            rays.extend(up.map(|(&member, _)| [receivers[member as usize].origin, direction]));
        }
    }
    rays
}
