// Wrinkles that follow the bones [DutreveMeyer2011, Eq. 4-8]. Printed by `wrinkle-blend shader`; do not edit.

// Eq. 4: how much of its way to a reference pose a bone went. ab: from neutral to now, ac: from neutral to the
// pose, both of the same point of the bone in the space of the head.
float bone_share(float3 ab, float3 ac) {
    return clamp(dot(ab, ac) / dot(ac, ac), 0.0, 1.0);
}

// Eq. 6: the share of the wrinkles over the share of the way.
float modulation(float x) {
    return 0.5 * (cos(3.1415927 * (1.0 + x)) + 1.0);
}

// How much a bone counts for a vertex, over its skin weight. The weight of a pose's map at a vertex is the sum of
// bone_counts * modulation(bone_share) over the bones of the pose, divided by max(1, sum of bone_counts over them).
float bone_counts(float skin_weight) {
    float x = min(4.0 * skin_weight, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Eq. 5: the paper's own; the weight of a map is then min(1, sum of bone_counts_paper * modulation(bone_share)).
float bone_counts_paper(float skin_weight) {
    return step(1e-6, skin_weight);
}

// No 8-bit code says 0: what flat maps say instead would add up.
float snap(float x) {
    return x * step(0.0039225686, abs(x));
}

// A texel of a normal map (linear, not sRGB; green up).
float3 decode_normal(float3 texel) {
    return float3(2.0 * texel.x - 1.0, 2.0 * texel.y - 1.0, 2.0 * texel.z - 1.0);
}

// Eq. 7: eta = (0, 0, 1) + w (n - (0, 0, 1)), never flatter than it makes sense.
float3 weighted_normal(float3 n, float w) {
    return float3(w * snap(n.x), w * snap(n.y), max(1.0 + w * (n.z - 1.0), 0.05));
}

// Eq. 8 for one map: x and y add, z multiply. Start with the neutral normal, add map by map, then normalize.
float3 add_wrinkle(float3 sum, float3 eta) {
    return float3(sum.x + eta.x, sum.y + eta.y, sum.z * eta.z);
}

// Eq. 8 for two maps: the tangent-space normal of the wrinkled skin. Normals are decoded, weights are interpolated
// between vertices.
float3 wrinkled_normal(float3 neutral, float3 n1, float3 n2, float w1, float w2) {
    float3 first = add_wrinkle(neutral, weighted_normal(n1, w1));
    return normalize(add_wrinkle(first, weighted_normal(n2, w2)));
}
