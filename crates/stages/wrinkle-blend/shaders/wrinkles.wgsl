// Wrinkles that follow the bones [DutreveMeyer2011, Eq. 4-8]. Printed by `wrinkle-blend shader`; do not edit.

// Eq. 4: how much of its way to a reference pose a bone went. ab: from neutral to now, ac: from neutral to the
// pose, both of the same point of the bone in the space of the head.
fn bone_share(ab: vec3<f32>, ac: vec3<f32>) -> f32 {
    return clamp(dot(ab, ac) / dot(ac, ac), 0.0, 1.0);
}

// Eq. 6: the share of the wrinkles over the share of the way.
fn modulation(x: f32) -> f32 {
    return 0.5 * (cos(3.1415927 * (1.0 + x)) + 1.0);
}

// How much a bone counts for a vertex, over its skin weight. The weight of a pose's map at a vertex is the sum of
// bone_counts * modulation(bone_share) over the bones of the pose, divided by max(1, sum of bone_counts over them).
fn bone_counts(skin_weight: f32) -> f32 {
    let x = min(4.0 * skin_weight, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Eq. 5: the paper's own; the weight of a map is then min(1, sum of bone_counts_paper * modulation(bone_share)).
fn bone_counts_paper(skin_weight: f32) -> f32 {
    return step(1e-6, skin_weight);
}

// No 8-bit code says 0: what flat maps say instead would add up.
fn snap(x: f32) -> f32 {
    return x * step(0.0039225686, abs(x));
}

// A texel of a normal map (linear, not sRGB; green up).
fn decode_normal(texel: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(2.0 * texel.x - 1.0, 2.0 * texel.y - 1.0, 2.0 * texel.z - 1.0);
}

// Eq. 7: eta = (0, 0, 1) + w (n - (0, 0, 1)), never flatter than it makes sense.
fn weighted_normal(n: vec3<f32>, w: f32) -> vec3<f32> {
    return vec3<f32>(w * snap(n.x), w * snap(n.y), max(1.0 + w * (n.z - 1.0), 0.05));
}

// Eq. 8 for one map: x and y add, z multiply. Start with the neutral normal, add map by map, then normalize.
fn add_wrinkle(sum: vec3<f32>, eta: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(sum.x + eta.x, sum.y + eta.y, sum.z * eta.z);
}

// Eq. 8 for two maps: the tangent-space normal of the wrinkled skin. Normals are decoded, weights are interpolated
// between vertices.
fn wrinkled_normal(neutral: vec3<f32>, n1: vec3<f32>, n2: vec3<f32>, w1: f32, w2: f32) -> vec3<f32> {
    let first = add_wrinkle(neutral, weighted_normal(n1, w1));
    return normalize(add_wrinkle(first, weighted_normal(n2, w2)));
}
