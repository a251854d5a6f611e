// The light that a surface sends towards the viewer; the formulae and sources are those of render/shading.h, function by
// function. All in the world's axes, positions from the viewpoint. reflected() is what lies in a direction, sharply:
// reflect_environment.glsl or reflect_mirror.glsl.
//
// ambient: Shot::ambient.
uniform int light_count;
uniform vec3 ambient;
layout(binding = UNIT_SPLIT_SUM) uniform sampler2D split_sum;  // split_sum_table(), edges clamped.

// Light from all round, EnvironmentLight's: of the environment, or of a rough mirror's own map.
uniform vec3 irradiance[9];
layout(binding = UNIT_GLOSSY) uniform samplerCubeArray glossy;  // Its levels as GL turns faces (Layout::api).
uniform vec3 reflected_ambient;  // Beside what is reflected: 0 where a map holds it.
uniform float blur;              // 1; 0: the base reflects all sharply, and a smooth coat, too.

struct ShadingPoint {
  vec3 position, normal, smooth_normal;
  vec4 base_colour;
  float metallic, roughness;
  vec3 emissive;
  float transmission, ior;
  float bend;    // Of what is let through: 1 / ior of solids, 1 of thin walls.
  vec4 volume;   // Of solids: what they absorb a metre, and how thick they are in the world.
  float reached; // Part of the light from all round that does: by the occlusion map.
  vec3 shadow_origin;   // Where shadows are found.
#if SHEEN
  vec3 sheen;
  float sheen_roughness;
#endif
#if COATED
  float coat, coat_roughness;
  vec3 coat_normal;
#endif
};

// @param reached the part of the environment's light that does.
vec3 irradiance_over_pi(vec3 n, vec3 reached) {
  vec3 sum = irradiance[0] + n.x * irradiance[1] + n.y * irradiance[2] + n.z * irradiance[3] + n.x * n.z * irradiance[4] +
             n.x * n.y * irradiance[5] + (3 * n.y * n.y - 1) * irradiance[6] + n.y * n.z * irradiance[7] +
             (n.z * n.z - n.x * n.x) * irradiance[8];
  return ambient + reached * max(sum, 0);
}

uniform int glossy_count;
uniform float glossy_roughness[MAX_GLOSSY_LEVELS], glossy_mip[MAX_GLOSSY_LEVELS];

vec3 blurred(vec3 from, int level) { return ambient + textureLod(glossy, vec4(from, level), glossy_mip[level]).rgb; }

// Of two levels the upper, and how far it is from the lower to it. Below level 0 is the environment itself.
struct GlossyMix {
  int upper;
  float part;
};
GlossyMix glossy_mix(float roughness) {
  int upper = 0;
  while (upper < glossy_count - 1 && glossy_roughness[upper] < roughness) ++upper;
  float least = upper == 0 ? 0 : glossy_roughness[upper - 1];
  return GlossyMix(upper, clamp((roughness - least) / (glossy_roughness[upper] - least), 0, 1));
}

// @param v away from the surface. @param bend as turned() has it.
vec3 glossy_radiance(vec3 v, vec3 n, float bend, float roughness) {
  vec3 from = turned(-v, n, bend);
  GlossyMix m = glossy_mix(roughness);
  vec3 below = m.upper == 0 ? reflected_ambient + reflected(from, n, bend) : blurred(from, m.upper - 1);
  return mix(below, blurred(from, m.upper), m.part);
}

// How much of a reflection the levels give, which are without the suns.
float blurred_part(float roughness) {
  GlossyMix m = glossy_mix(roughness);
  return m.upper == 0 ? m.part : 1;
}

// KHR_lights_punctual: what arrives across the light, and from where.
vec3 arriving(Light light, vec3 position, out vec3 from) {
  from = -light.direction.xyz;
  if (light.position.w == DIRECTIONAL) return light.intensity.rgb;
  vec3 way = light.position.xyz - position;
  float square = max(dot(way, way), 1e-12);
  from = way * inversesqrt(square);
  vec3 there = light.intensity.rgb / square;
  if (light.direction.w > 0) {
    float part = square / (light.direction.w * light.direction.w);
    there *= clamp(1 - part * part, 0, 1);
  }
  if (light.position.w == SPOT) {
    float part = clamp((dot(-from, light.direction.xyz) - light.cone.y) / max(1e-4, light.cone.x - light.cone.y), 0, 1);
    there *= part * part;
  }
  return there;
}

float specular(float alpha, vec3 n, vec3 h, float nv, float nl) {
  float a2 = alpha * alpha, nh = max(0, dot(n, h));
  vec3 side = cross(n, h);
  float q = a2 * nh * nh + dot(side, side);
  float masking = nl * sqrt(nv * nv * (1 - a2) + a2) + nv * sqrt(nl * nl * (1 - a2) + a2);
  return a2 / (PI * q * q) * 0.5 / masking;
}

// By scale and bias of the split sum, for a reflectance at normal incidence and at grazing angles.
vec3 once(vec3 f0, float f90, vec2 table) { return f0 * table.x + f90 * table.y; }
vec3 later(vec3 f0, float f90, vec2 table) {
  float more = 1 - table.x - table.y;
  vec3 mean = f0 + (f90 - f0) / 21;
  return once(f0, f90, table) * mean / (1 - more * mean) * more;
}

float alpha_of(float roughness) { return max(1e-3, roughness * roughness); }

// x: alpha for a light; y: the part of its reflection that sharp ones do not have.
vec2 glint_of(Light light, float roughness, float blur) {
  float spread = light.intensity.w, alpha = alpha_of(roughness);
  if (spread == 0) return vec2(alpha, 1);
  float widened = length(vec2(alpha, 0.5 * spread));
#if SAMPLED
  if (blur * roughness >= LEAST_LOBE_ROUGHNESS) return vec2(widened, 1);
#endif
  return vec2(widened, blurred_part(blur * roughness));
}

// The lobe of Ggx of prefilter/lobe.h. @param x 1 - cosine.
float ggx_lobe(float roughness, float x) {
  float alpha = max(1e-6, roughness * roughness), a = 2 * alpha * alpha, b = (1 - alpha) * (1 + alpha), t = b / a;
  float whole = (t < 0.01 ? 0.5 - t / 3 : (t - log(1 + t)) / (t * t)) / (a * a), q = a + b * x;
  return x < 1 ? (1 - x) / (q * q * 2 * PI * whole) : 0;
}

// What rough glass lets through of the suns, which its levels are without.
vec3 suns_through(vec3 v, vec3 n, float bend, float roughness) {
  float part = blurred_part(roughness);
  vec3 from = turned(-v, n, bend), sum = vec3(0);
  if (part == 0) return sum;
  for (int k = 0; k < light_count; ++k)
    if (lights[k].intensity.w > 0)
      sum += part * ggx_lobe(roughness, 1 + dot(from, lights[k].direction.xyz)) * lights[k].intensity.rgb;
  return sum;
}
float grazing(float cosine) { return pow(1 - clamp(cosine, 0, 1), 5); }

struct Base {
  float nv;
  vec3 colour, dielectric, plain;
  float edge;
};

Base base_of(ShadingPoint s, vec3 v) {
  float part = (s.ior - 1) / (s.ior + 1);
  return Base(clamp(dot(s.normal, v), 1e-3, 1.0), s.base_colour.rgb, s.base_colour.rgb * (1 - s.metallic),
              vec3(part * part), s.ior > 1 ? 1 : 0);
}

// @param glint of glint_of().
vec3 lit(Base b, ShadingPoint s, vec3 v, vec3 from, vec2 glint) {
  float nl = dot(s.normal, from);
  if (nl <= 0) return vec3(0);
  vec3 h = normalize(from + v);
  float side = grazing(dot(v, h));
  vec3 of_plain = b.plain + (b.edge - b.plain) * side, fresnel = mix(of_plain, b.colour + (1 - b.colour) * side, s.metallic);
  vec3 diffuse = (1 - of_plain) * (1 - s.transmission) / PI;
  return nl * (diffuse * b.dielectric + glint.y * fresnel * specular(glint.x, s.normal, h, b.nv, nl));
}

#if SHEEN
struct Sheen {
  float nv, most, albedo;
};

Sheen sheen_of(ShadingPoint s, vec3 v) {
  float nv = clamp(dot(s.normal, v), 1e-3, 1.0);
  return Sheen(nv, max(s.sheen.r, max(s.sheen.g, s.sheen.b)), sheen_albedo(nv, s.sheen_roughness));
}

vec3 lit(Sheen f, ShadingPoint s, vec3 v, vec3 from, vec3 base) {
  float nl = dot(s.normal, from);
  if (nl <= 0) return vec3(0);
  float left = 1 - f.most * max(f.albedo, sheen_albedo(nl, s.sheen_roughness));
  return left * base + nl * sheen(s.normal, normalize(from + v), f.nv, nl, s.sheen_roughness) * s.sheen;
}
#endif

#if COATED
struct Coat {
  float nv, part, once;
};

Coat coat_of(ShadingPoint s, vec3 v) {
  float nv = clamp(dot(s.coat_normal, v), 1e-3, 1.0);
  vec2 table = textureLod(split_sum, vec2(nv, s.coat_roughness), 0).rg;
  return Coat(nv, s.coat * (0.04 + 0.96 * grazing(nv)), table.x + table.y);
}

float lit(Coat c, ShadingPoint s, vec3 v, vec3 from, vec2 glint) {
  float nl = dot(s.coat_normal, from);
  return nl <= 0 ? 0 : nl * glint.y * specular(glint.x, s.coat_normal, normalize(from + v), c.nv, nl);
}
#endif

// What a layer of the surface reflects once, over once().
vec3 reflected_radiance(vec3 v, vec3 n, float roughness, vec3 f0, float f90) {
#if SAMPLED
  if (roughness >= LEAST_LOBE_ROUGHNESS) return ambient + sampled_mean(v, n, alpha_of(roughness), f0, f90);
#endif
  return glossy_radiance(v, n, 0, roughness);
}

vec3 shade(ShadingPoint s, vec3 v) {
  vec3 n = s.normal;
  Base b = base_of(s, v);

  // The environment: what is reflected once, and what after bouncing between microfacets, of either material.
  vec2 table = textureLod(split_sum, vec2(b.nv, s.roughness), 0).rg;
  vec3 even = s.reached * irradiance_over_pi(n, unoccluded(s.shadow_origin, s.smooth_normal));
  vec3 rest = 1 - once(b.plain, b.edge, table) - later(b.plain, b.edge, table);
  vec3 bounced = mix(later(b.plain, b.edge, table), later(b.colour, 1, table), s.metallic);
  vec3 sum = rest * b.dielectric * (1 - s.transmission) * even +
             bounced * even +
             s.reached * mix(once(b.plain, b.edge, table), once(b.colour, 1, table), s.metallic) *
                 reflected_radiance(v, n, blur * s.roughness, mix(b.plain, b.colour, s.metallic), mix(b.edge, 1.0, s.metallic));
  if (s.transmission > 0) {
    vec3 through = glossy_radiance(v, n, s.bend, blur * s.roughness);  // Which finds `way`.
    vec3 kept = exp(-s.volume.rgb * min(s.volume.a, way));
    through += suns_through(v, n, s.bend, blur * s.roughness);
    sum += rest * b.dielectric * s.transmission * kept * through;
  }
#if SHEEN
  Sheen f = sheen_of(s, v);
  sum = (1 - f.most * f.albedo) * sum + f.albedo * s.sheen * even;
#endif
  sum += s.emissive;
#if COATED
  Coat c = coat_of(s, v);
  float coat_blur = s.coat_roughness < SMOOTH_GLASS ? blur : 1;
  sum = (1 - c.part) * sum + c.part * (1 - c.once) * even +
        c.part * c.once * s.reached *
            reflected_radiance(v, s.coat_normal, coat_blur * s.coat_roughness, vec3(1), 1);
#endif

  for (int k = 0; k < light_count; ++k) {
    vec3 from, there = arriving(lights[k], s.position, from);
    if (dot(s.smooth_normal, from) <= 0) continue;
    vec3 part = lit(b, s, v, from, glint_of(lights[k], s.roughness, blur));
    if (lights[k].intensity.w > 0) part += max(0, dot(n, from)) / PI * bounced;
#if SHEEN
    part = lit(f, s, v, from, part);
#endif
#if COATED
    part = (1 - c.part) * part + c.part * lit(c, s, v, from, glint_of(lights[k], s.coat_roughness, coat_blur));
#endif
    if (part == vec3(0) || in_shadow(lights[k], s.shadow_origin, s.smooth_normal)) continue;
    sum += there * part;
  }
  return sum;
}
