// What the page shows at a pixel. Directions are of the world: right-handed, +Y up; the projections are those of
// envmap-conventions(7). With PICK one pixel tells where it looks and what is there.
precision highp float;
precision highp int;
precision highp samplerCube;

const float PI = 3.14159265358979;

uniform vec2 size;                 // Of the canvas, in pixels.
uniform int view;                  // 0: a camera; else the projections as envmap lists them, from 1.
uniform vec3 right, up, forward;   // Of the camera.
uniform float spread;              // Half the height of what it sees, at distance 1.
uniform mat3 turn;                 // Image to world, of latlong and angular views.
uniform samplerCube map, ggx, diffuse;
uniform sampler2D dielectric;      // What of white light a surface of index 1.5 reflects: by cosine and roughness.
uniform float last_level;          // Of ggx: roughness 1.
uniform int image;                 // 0 map, 1 ggx, 2 diffuse
uniform float level;               // Of it.
uniform float gain;                // Exposure, and what the texels were divided by.
uniform int curve;                 // 0 clip, 1 reinhard, 2 neutral
uniform vec4 balls[3];             // Middle and radius in half heights of the canvas; level L of ggx; -1: diffuse; -2 - L: dielectric.

// ---- views -----------------------------------------------------------------------------------------------------------

float aspect() { return view == 1 || view == 4 ? 2.0 : view == 2 ? 4.0 / 3.0 : 1.0; }

vec3 latlong(vec2 at) {
  float longitude = -PI * at.x, latitude = 0.5 * PI * at.y;
  return vec3(cos(latitude) * sin(longitude), sin(latitude), cos(latitude) * cos(longitude));
}

// Faces in a cross: -X -Z +X +Z from the left, +Y above -Z, -Y below it.
bool cube(vec2 at, out vec3 d) {
  vec2 cell = floor(vec2(2.0 + 2.0 * at.x, 1.5 - 1.5 * at.y));
  vec2 in_cell = vec2(2.0 + 2.0 * at.x, 1.5 - 1.5 * at.y) - cell;
  float s = 2.0 * in_cell.x - 1.0, t = 1.0 - 2.0 * in_cell.y;
  if (cell.y == 1.0)
    d = cell.x == 0.0 ? vec3(-1, t, -s) : cell.x == 1.0 ? vec3(s, t, -1) : cell.x == 2.0 ? vec3(1, t, s) : vec3(-s, t, 1);
  else
    d = cell.y == 0.0 ? vec3(s, 1, t) : vec3(s, -1, -t);
  d = normalize(d);
  return cell.y == 1.0 || cell.x == 1.0;
}

bool sphere(vec2 at, out vec3 d) {
  float rr = dot(at, at);
  d = vec3(2.0 * sqrt(max(0.0, 1.0 - rr)) * at, 1.0 - 2.0 * rr);
  return rr < 1.0;
}

vec3 paraboloid(vec2 at) {  // +Z on the left, -Z on the right; at.x from -2 to 2.
  float side = at.x < 0.0 ? 1.0 : -1.0;
  vec2 in_half = vec2(at.x + side, at.y);
  float rr = dot(in_half, in_half);
  return vec3(2.0 * in_half, side * (1.0 - rr)) / (1.0 + rr);
}

bool angular(vec2 at, out vec3 d) {
  float r = length(at), k = r > 0.0 ? sin(PI * r) / r : PI;
  d = vec3(-at.x * k, at.y * k, cos(PI * r));
  return r < 1.0;
}

// A square folded along the lines between the middles of its sides: a and b from 0 with a + b <= 1.
vec2 folded(vec2 at) { return abs(at.x) + abs(at.y) > 1.0 ? 1.0 - abs(at.yx) : abs(at); }
vec3 unfolded(vec3 d, vec2 at) {
  return d * vec3(at.x < 0.0 ? -1 : 1, abs(at.x) + abs(at.y) > 1.0 ? -1 : 1, at.y < 0.0 ? -1 : 1);
}

vec3 octahedral(vec2 at) {
  vec2 in_facet = folded(at);
  return unfolded(normalize(vec3(in_facet.x, 1.0 - in_facet.x - in_facet.y, in_facet.y)), at);
}

vec3 equal_area(vec2 at) {
  vec2 in_facet = folded(at);
  float r = in_facet.x + in_facet.y, angle = r > 0.0 ? 0.5 * PI * in_facet.y / r : 0.0, across = r * sqrt(2.0 - r * r);
  return unfolded(vec3(across * cos(angle), 1.0 - r * r, across * sin(angle)), at);
}

// @param at in the picture: from -1 to 1, upwards; of a camera in half heights of the canvas.
bool direction_at(vec2 at, out vec3 d) {
  if (view == 0) {
    d = normalize(forward + spread * (at.x * right + at.y * up));
    return true;
  }
  if (abs(at.x) > 1.0 || abs(at.y) > 1.0) return false;
  bool inside = true;
  if (view == 1) d = turn * latlong(at);
  if (view == 2) inside = cube(at, d);
  if (view == 3) inside = sphere(at, d);
  if (view == 4) d = paraboloid(vec2(2.0 * at.x, at.y));
  if (view == 5) { inside = angular(at, d); d = turn * d; }
  if (view == 6) d = octahedral(at);
  if (view == 7) d = equal_area(at);
  return inside;
}

// ---- light -----------------------------------------------------------------------------------------------------------

vec3 radiance_of_map(vec3 d) {
  return image == 0 ? textureLod(map, d, level).rgb : image == 1 ? textureLod(ggx, d, level).rgb : textureLod(diffuse, d, 0.0).rgb;
}

// A ball as a mirror ball is seen: small and far away in the direction of its middle.
bool ball_at(vec4 ball, vec2 at, out vec3 d, out vec3 radiance) {
  vec2 in_ball = (at - ball.xy) / ball.z;
  float rest = 1.0 - dot(in_ball, in_ball);
  if (ball.z == 0.0 || rest <= 0.0) return false;
  vec3 away = normalize(forward + spread * (ball.x * right + ball.y * up));
  vec3 side = normalize(right - dot(right, away) * away);
  vec3 normal = in_ball.x * side + in_ball.y * cross(side, away) - sqrt(rest) * away;
  bool coated = ball.w < -1.0;
  vec3 below = textureLod(diffuse, normal, 0.0).rgb;
  d = ball.w == -1.0 ? normal : reflect(away, normal);
  float ball_level = coated ? -2.0 - ball.w : ball.w;
  vec3 reflected = textureLod(ggx, d, ball_level).rgb;
  float part = coated ? textureLod(dielectric, vec2(sqrt(rest), ball_level / last_level), 0.0).r : ball.w < 0.0 ? 0.0 : 1.0;
  radiance = mix(below, reflected, part);
  return true;
}

// @return whether anything is there.
bool seen(vec2 pixel, out vec3 d, out vec3 radiance) {
  vec2 at = (2.0 * pixel - size) / size.y;
  if (view == 0)
    for (int k = 0; k < 3; ++k)
      if (ball_at(balls[k], at, d, radiance)) return true;
  if (view > 0) at /= min(1.0, size.x / size.y / aspect()) * vec2(aspect(), 1.0);
  if (!direction_at(at, d)) return false;
  radiance = radiance_of_map(d);
  return true;
}

// ---- display ---------------------------------------------------------------------------------------------------------

vec3 neutral(vec3 c) {  // Khronos PBR Neutral Tone Mapper, 2024.
  float start = 0.76, least = min(c.r, min(c.g, c.b));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  if (peak < start) return c;
  float drawn_in = 1.0 - (1.0 - start) * (1.0 - start) / (peak + 1.0 - 2.0 * start);
  return mix(c * drawn_in / peak, vec3(drawn_in), 1.0 - 1.0 / (0.15 * (peak - drawn_in) + 1.0));
}

vec3 shown(vec3 c) {
  c = curve == 1 ? c / (1.0 + c) : curve == 2 ? neutral(c) : c;
  c = clamp(c, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));  // sRGB
}

#ifdef PICK
uniform vec2 pointer;  // In pixels, from below.
layout(location = 0) out uvec4 picked_direction;  // The bits of floats; the last is whether anything is there.
layout(location = 1) out uvec4 picked_radiance;
void main() {
  vec3 d = vec3(0), radiance = vec3(0);
  bool any = seen(pointer, d, radiance);
  picked_direction = uvec4(floatBitsToUint(d), any ? 1u : 0u);
  picked_radiance = uvec4(floatBitsToUint(radiance), 0u);
}
#else
out vec4 colour;
void main() {
  vec3 d, radiance;
  colour = vec4(seen(gl_FragCoord.xy, d, radiance) ? shown(gain * radiance) : vec3(0.1), 1);
}
#endif
