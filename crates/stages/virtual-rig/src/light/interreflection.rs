//! Light that the surface throws onto itself.

use super::shading::{Places, Plan, Surface};
use super::sweep::surroundings;
use super::{Ambient, Scene, directions};

/// Light with `bounces` of interreflection, per vertex and channel, over π: B₀ = E, Bₖ₊₁ = E + G(ρ Bₖ) [Goral1984],
/// gathered, where G is the mean over the hemisphere, weighted by the cosine, of what blocked rays hit: ρ B
/// there, interpolated between the triangle's corners. All is Lambertian. What comes out meets the receiver's own ρ only
/// when it is seen. Occluders that are not part of the surface throw nothing back.
#[allow(clippy::too_many_arguments, reason = "one step of `shade`, of what it has at hand")]
pub(super) fn bounce(
    scene: &Scene,
    surface: &Surface<'_>,
    plan: &Plan,
    places: &Places,
    direct: Vec<[f32; 3]>,
    albedo: &[[f32; 3]],
    ambient: &Ambient,
    bounces: u32,
) -> Vec<[f32; 3]> {
    let mut light = direct.clone();
    for _ in 0..bounces {
        let glow: Vec<[f32; 3]> =
            light.iter().zip(albedo).map(|(light, albedo)| [0, 1, 2].map(|c| light[c] * albedo[c])).collect();
        let thrown = places.light(plan, ambient, |receivers, rays| {
            surroundings(scene, receivers, &directions::sphere(2 * rays), |triangle, u, v| {
                let Some(corners) = surface.triangles.get(triangle as usize) else { return [0.0; 3] };
                let [a, b, c] = corners.map(|vertex| glow[vertex as usize]);
                [0, 1, 2].map(|channel| (1.0 - u - v) * a[channel] + u * b[channel] + v * c[channel])
            })
        });
        light = plan.sum(&direct, &thrown);
    }
    light
}
