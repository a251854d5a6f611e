// The sheen of cloth, as render/sheen.h has it, function by function.
layout(binding = UNIT_SHEEN_TABLE) uniform sampler2D sheen_table;  // Edges clamped.

float lambda(float cosine, float alpha) {
  float t = (1 - alpha) * (1 - alpha);
  vec4 k = mix(vec4(21.5473, 3.82987, -1.97760, -4.32054), vec4(25.3245, 3.32435, -1.27393, -4.85967), t);
  float power = mix(0.19823, 0.16801, t), x = max(0, cosine < 0.5 ? cosine : 1 - cosine);
  float l = k.x / (1 + k.y * pow(x, power)) + k.z * x + k.w;
  return exp(cosine < 0.5 ? l : 2 * (k.x / (1 + k.y * pow(0.5, power)) + 0.5 * k.z + k.w) - l);
}

float sheen(vec3 n, vec3 h, float nv, float nl, float roughness) {
  float alpha = pow(max(LEAST_SHEEN_ROUGHNESS, roughness), 2);
  vec3 side = cross(n, h);
  float distribution = (2 + 1 / alpha) * pow(min(1, dot(side, side)), 0.5 / alpha) / (2 * PI);
  return distribution / ((1 + lambda(nv, alpha) + lambda(nl, alpha)) * 4 * nv * nl);
}

float sheen_albedo(float nv, float roughness) { return textureLod(sheen_table, vec2(nv, roughness), 0).r; }
