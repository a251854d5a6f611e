// The instance (as by instances() in draw.h) that is drawn.
uniform mat4 to_map;      // From the mesh to the frame of the map, the viewpoint at the origin.
uniform int instance;
uniform int first_triangle;
uniform int facing;       // Which side is drawn: 1 the counter-clockwise one, -1 the other, 0 both.
uniform vec2 range;       // Distances of the near and the far sphere.
