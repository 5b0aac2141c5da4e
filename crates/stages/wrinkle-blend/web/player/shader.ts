// The shaders: skinning, the weights of poses at vertices, the wrinkled normal at pixels, skin in light. What the paper's equations are
// comes from `wrinkle-blend shader`, as the program serves it: `bone_counts`, `decode_normal`, `weighted_normal`, `add_wrinkle`.

const PRECISION = `
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2DArray;
`;

/** Poses in a vector. */
const WIDTH = 4;

export function vertexShader(equations: string): string {
  return `${PRECISION}
${equations}
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform vec4 joints[3 * JOINTS];
// Per watched bone and group of four poses: modulation(bone_share).
uniform vec4 shares[max(1, BONES * GROUPS)];
// Per influence: joint, bits of the weight, watched bone, poses of the bone.
uniform usampler2D influences;

in vec3 position;
in vec3 normal;
in vec4 tangent;
in vec2 uv;
in vec2 range;

out vec2 at;
out vec3 place;
out vec3 bound;
out vec3 along;
out vec3 across;
out vec3 outward;
out vec4 weights[GROUPS];

void main() {
  at = uv;
  bound = position;
  vec4 rows[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  vec4 sums[GROUPS];
  vec4 counts[GROUPS];
  for (int group = 0; group < GROUPS; group++) {
    sums[group] = vec4(0.0);
    counts[group] = vec4(0.0);
  }
  int width = textureSize(influences, 0).x;
  int first = int(range.x);
  int count = int(range.y);
  for (int index = first; index < first + count; index++) {
    uvec4 influence = texelFetch(influences, ivec2(index % width, index / width), 0);
    float weight = uintBitsToFloat(influence.y);
    for (int row = 0; row < 3; row++) {
      rows[row] += weight * joints[3 * int(influence.x) + row];
    }
    if (influence.z == 0xffffffffu) continue;
    float counted = SMOOTH == 1 ? bone_counts(weight) : bone_counts_paper(weight);
    for (int group = 0; group < GROUPS; group++) {
      sums[group] += counted * shares[int(influence.z) * GROUPS + group];
      uint of = influence.w >> uint(${WIDTH} * group);
      counts[group] += counted * vec4(of & 1u, (of >> 1) & 1u, (of >> 2) & 1u, (of >> 3) & 1u);
    }
  }
  if (count == 0) {
    rows = vec4[3](vec4(1.0, 0.0, 0.0, 0.0), vec4(0.0, 1.0, 0.0, 0.0), vec4(0.0, 0.0, 1.0, 0.0));
  }
  for (int group = 0; group < GROUPS; group++) {
    vec4 weight = SMOOTH == 1 ? sums[group] / max(vec4(1.0), counts[group]) : sums[group];
    // What rounding leaves at rest shows nothing.
    weights[group] = min(weight, 1.0) * step(1e-6, weight);
  }
  mat3 turn = transpose(mat3(rows[0].xyz, rows[1].xyz, rows[2].xyz));
  vec4 posed = vec4(dot(rows[0], vec4(position, 1.0)), dot(rows[1], vec4(position, 1.0)), dot(rows[2], vec4(position, 1.0)), 1.0);
  outward = normalize(turn * normal);
  along = normalize(turn * tangent.xyz);
  across = tangent.w * cross(outward, along);
  place = posed.xyz;
#ifdef IN_MAP
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
#else
  gl_Position = projectionMatrix * viewMatrix * posed;
#endif
}
`;
}

const WRINKLES = `
uniform sampler2DArray maps;
uniform float shown;

#ifdef IN_MAP
// A pixel is a texel: nothing is filtered.
vec3 layer(int number, vec2 dx, vec2 dy) {
  return decode_normal(texelFetch(maps, ivec3(gl_FragCoord.xy, number), 0).xyz);
}
#else
vec3 layer(int number, vec2 dx, vec2 dy) {
  return decode_normal(textureGrad(maps, vec3(at, float(number)), dx, dy).xyz);
}
#endif

// The tangent-space normal: the neutral map, and every map whose weight is not 0. \`even\`: how much neighbouring normals agree, where
// several share a pixel; 1 where they do.
vec3 tangent_normal(out float even) {
  vec2 dx = dFdx(at);
  vec2 dy = dFdy(at);
  vec3 sum = layer(0, dx, dy);
  even = min(1.0, length(sum));
  for (int pose = 0; pose < POSES; pose++) {
    float weight = shown * weights[pose / ${WIDTH}][pose % ${WIDTH}];
    if (weight > 0.0) {
      sum = add_wrinkle(sum, weighted_normal(layer(pose + 1, dx, dy), weight));
    }
  }
  return normalize(sum);
}
`;

const VARYING = `
in vec2 at;
in vec3 place;
in vec3 bound;
in vec3 along;
in vec3 across;
in vec3 outward;
in vec4 weights[GROUPS];
out vec4 color;
`;

/** The blended map itself, in its own texture coordinates. */
export function mapShader(equations: string): string {
  return `${PRECISION}
${VARYING}
${equations}
${WRINKLES}
void main() {
  float even;
  color = vec4(0.5 * tangent_normal(even) + 0.5, 1.0);
}
`;
}

/** Skin, eyes and the rest in the light of one lamp and a sky. */
export function skinShader(equations: string): string {
  return `${PRECISION}
${VARYING}
${equations}
${WRINKLES}
uniform vec3 cameraPosition;
uniform vec3 lamp;
uniform float brightness;
uniform int look; // 0 skin, 1 clay, 2 influence
uniform vec3 plain;
uniform vec3 poseColors[POSES];
uniform vec4 eyes[2];
#ifdef COLOR
uniform sampler2D colors;
#endif

const vec3 SKY = vec3(0.33, 0.35, 0.39);
const vec3 GROUND = vec3(0.17, 0.145, 0.135);

vec3 linear(vec3 code) {
  return mix(code / 12.92, pow((code + 0.055) / 1.055, vec3(2.4)), step(0.04045, code));
}

vec3 encoded(vec3 light) {
  vec3 x = clamp(light, 0.0, 1.0);
  return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x));
}

float wrapped(float cosine, float by) {
  return max(0.0, (cosine + by) / (1.0 + by));
}

// A lobe of GGX with Schlick's reflectance.
float gloss(vec3 n, vec3 v, float roughness, float even, float facing) {
  vec3 h = normalize(lamp + v);
  // Relief too fine for a pixel makes it rougher (Toksvig).
  float a = sqrt(min(1.0, pow(roughness, 4.0) + 2.0 * (1.0 - even) / even));
  float nh = max(dot(n, h), 0.0);
  float nl = max(dot(n, lamp), 0.0);
  float nv = max(dot(n, v), 1e-3);
  float spread = nh * nh * (a * a - 1.0) + 1.0;
  float k = 0.5 * a;
  float seen = 1.0 / ((nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
  float reflected = facing + (1.0 - facing) * pow(1.0 - max(dot(h, v), 0.0), 5.0);
  return nl * reflected * seen * a * a / (12.566 * spread * spread);
}

vec3 albedo(float total) {
#if PART == 1
  vec4 eye = distance(bound, eyes[0].xyz) < distance(bound, eyes[1].xyz) ? eyes[0] : eyes[1];
  float off = length((bound - eye.xyz).xy) / eye.w;
  vec3 iris = mix(vec3(0.10, 0.16, 0.17), vec3(0.22, 0.30, 0.28), smoothstep(0.16, 0.36, off));
  vec3 white = mix(vec3(0.5, 0.46, 0.44), vec3(0.33, 0.25, 0.23), smoothstep(0.5, 0.95, off));
  vec3 seen = mix(iris, white, smoothstep(0.385, 0.43, off));
  seen = mix(vec3(0.008), seen, smoothstep(0.13, 0.155, off));
  return bound.z > eye.z ? seen : white;
#elif PART == 2
  return plain;
#else
  if (look == 1) return vec3(0.42);
  if (look == 2) {
    vec3 sum = vec3(0.0);
    for (int pose = 0; pose < POSES; pose++) {
      sum += weights[pose / ${WIDTH}][pose % ${WIDTH}] * linear(poseColors[pose]);
    }
    float share = 1.0 / max(1.0, total);
    return share * sum + (1.0 - share * total) * vec3(0.42);
  }
#ifdef COLOR
  return linear(texture(colors, at).rgb);
#else
  return plain;
#endif
#endif
}

void main() {
  vec3 g = normalize(outward) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 n = g;
  float total = 0.0;
  float even = 1.0;
#if PART == 0
  vec3 t = tangent_normal(even);
  n = normalize(t.x * along + t.y * across + t.z * outward) * (gl_FrontFacing ? 1.0 : -1.0);
  for (int group = 0; group < GROUPS; group++) total += dot(weights[group], vec4(1.0));
#endif
  vec3 v = normalize(cameraPosition - place);
  vec3 base = albedo(total);
  // Light goes some way under the skin, red farthest: it sees the finest relief least.
  bool soft = PART == 0 && look == 0;
  vec3 nr = soft ? normalize(mix(n, g, 0.35)) : n;
  vec3 ng = soft ? normalize(mix(n, g, 0.1)) : n;
  vec3 by = soft ? vec3(0.30, 0.12, 0.07) : vec3(0.05);
  vec3 lit = vec3(wrapped(dot(nr, lamp), by.r), wrapped(dot(ng, lamp), by.g), wrapped(dot(n, lamp), by.b));
  vec3 sky = mix(GROUND, SKY, 0.5 + 0.5 * vec3(nr.y, ng.y, n.y));
  // What lies deep in a wrinkle sees less of the sky.
  sky *= mix(1.0, clamp(dot(n, g), 0.0, 1.0), 0.6);
  float shine = PART == 1 ? 2.2 * gloss(n, v, 0.12, 1.0, 0.04) : soft ? 0.75 * gloss(n, v, 0.46, even, 0.03) + 0.25 * gloss(n, v, 0.3, even, 0.03) : 0.5 * gloss(n, v, 0.5, even, 0.03);
  vec3 key = 2.3 * brightness * vec3(1.0, 0.965, 0.92);
  vec3 light = base * (sky + lit * key * 0.45) + shine * key;
  light = light / (1.0 + 0.12 * light);
  color = vec4(encoded(light), 1.0);
}
`;
}
