//! Directions spread evenly over the sphere.

/// `count` directions of the spherical Fibonacci lattice [Marques2013]: each stands for the same solid angle, and
/// any half of the sphere holds half of them, give or take a few. Its axis is turned away from the axes of faces and
/// grooves, where the lattice's rows would fall onto horizons one row at a time.
pub(super) fn sphere(count: u32) -> Vec<[f32; 3]> {
    const GOLDEN_ANGLE: f64 = std::f64::consts::PI * (3.0 - 2.236_067_977_499_79);
    let frame = nalgebra::Rotation3::from_euler_angles(0.532, 0.871, 0.219);
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let radius = (1.0 - z * z).sqrt();
            let (sin, cos) = (GOLDEN_ANGLE * f64::from(i)).sin_cos();
            let direction = frame * nalgebra::Vector3::new(radius * cos, radius * sin, z);
            [direction.x as f32, direction.y as f32, direction.z as f32]
        })
        .collect()
}
