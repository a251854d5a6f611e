// Where the meshes of the scene are: one element an instance, numbered as by instances() in draw.h.
struct Instance {
  mat4 to_map;       // From the mesh to the frame of the map, the viewpoint at the origin.
  mat4 normals;      // From the mesh to the world; 3x3.
  int material;
  int first_index;
  int facing;        // Which side is drawn: 1 the counter-clockwise one, -1 the other (mirrored), 0 both.
  int mirrored;      // Whether its transform turns right into left.
};
layout(std430, binding = 0) readonly buffer Instances { Instance instances[]; };
uniform int instance;
uniform vec2 range;  // Distances of the near and the far sphere.
