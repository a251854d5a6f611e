// A mirror's map on a cube: a place is the direction itself.
layout(binding = UNIT_MIRROR) uniform samplerCube mirror;  // Z mirrored: MapTexture::layer().
// @param at as GL has it: surfaces.glsl.
vec4 shown_at(vec3 at, vec2 on_face, float level);

vec3 place_of(vec3 d) { return d; }
vec3 in_face(vec3 place, float face) { return place; }

int face_of(vec3 place) { return int(cube_located(place).z); }

vec4 mirror_at_place(vec3 at, float level) { return shown_at(vec3(at.xy, -at.z), cube_located(at).xy, level); }

float nearness_at(vec3 d) { return textureLod(mirror, vec3(d.xy, -d.z), 0).a; }

vec4 mirror_at(vec3 d, float level) { return mirror_at_place(d, level); }
