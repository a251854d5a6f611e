// A mirror's map on a cube: a place is the direction itself.
layout(binding = UNIT_MIRROR) uniform samplerCube mirror;  // Z mirrored: MapTexture::layer().

vec3 place_of(vec3 d) { return d; }
vec3 in_face(vec3 place, float face) { return place; }

vec3 mirror_at_place(vec3 at, float level) {
  return tint(int(cube_located(at).z)) * textureLod(mirror, vec3(at.xy, -at.z), level).rgb;
}

float nearness_at(vec3 d) { return textureLod(mirror, vec3(d.xy, -d.z), 0).a; }

vec3 mirror_at(vec3 d, float level) { return mirror_at_place(d, level); }
