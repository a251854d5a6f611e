// What rough surfaces reflect of the environment by samples of their lobe: render/sampled_reflection.h.
layout(binding = UNIT_SAMPLED) uniform samplerCube sampled_levels;  // Faces as GL turns them (Layout::api).

float grazing(float cosine);  // Of shading.glsl.
float masked(float cosine, float a2) { return sqrt(a2 + (1 - a2) * cosine * cosine); }

vec3 sampled_mean(vec3 v, vec3 n, float alpha, vec3 f0, float f90) {
  float nv = clamp(dot(n, v), 1e-3, 1.0), a2 = alpha * alpha, masked_v = masked(nv, a2);
  vec3 aside = v - dot(n, v) * n, local = vec3(sqrt(1 - nv * nv), 0, nv);
  vec3 other = abs(n.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0);
  vec3 t = normalize(dot(aside, aside) > 1e-8 ? aside : cross(other, n)), b = cross(n, t);
  vec3 stretched = normalize(vec3(alpha * local.x, 0, local.z)), sum = vec3(0), weights = vec3(0);
  float face = textureSize(sampled_levels, 0).x;
  for (int k = 0; k < REFLECTION_SAMPLES; ++k) {
    float turn = 2.39996323 * k, x = sqrt((k + 0.5) / REFLECTION_SAMPLES) * cos(turn);
    float y = mix(sqrt(1 - x * x), sqrt((k + 0.5) / REFLECTION_SAMPLES) * sin(turn), 0.5 * (1 + stretched.z));
    float z = sqrt(max(0, 1 - x * x - y * y));
    vec3 m = vec3(z * stretched.x - y * stretched.z, x, z * stretched.z + y * stretched.x);
    vec3 h = normalize(vec3(alpha * m.xy, max(0, m.z)));
    float vh = dot(local, h), nl = 2 * vh * h.z - nv;
    if (nl <= 0) continue;
    float g = nl * (nv + masked_v) / (nl * masked_v + nv * masked(nl, a2));
    float q = dot(h.xy, h.xy) + a2 * h.z * h.z, density = a2 / (2 * PI * q * q * (nv + masked_v));
    vec3 l = (2 * vh * h.x - local.x) * t + 2 * vh * h.y * b + nl * n, size = abs(l);
    float c = max(size.x, max(size.y, size.z));
    float texels = face * face * REFLECTION_TEXEL / (4 * c * c * c * REFLECTION_SAMPLES * density);
    vec3 weight = g * (f0 + (f90 - f0) * grazing(vh));
    sum += weight * textureLod(sampled_levels, l, 0.5 * log2(texels)).rgb;
    weights += weight;
  }
  return sum / max(weights, 1e-30);
}
