// Where directions lie in the image of a face. IMAGE is the enumerator of Projection in projection.h. Discs and latlong
// maps are images of two angles: from an axis, and round it. `to_face` turns the frame of the map so that the axis is
// Z and the azimuth 0 lies along X; for a cube X is right, Y up and Z into the face.
#define LATLONG 0
#define CUBE 1
#define SPHERE 2
#define PARABOLOID 3
#define ANGULAR 4
const float pi = 3.14159265358979;
uniform mat3 to_face;
uniform vec2 pixel;  // Of the image, in clip space.
uniform vec2 shift;  // Brings where a sample lies to the centre of its texel, where the rasteriser looks.

#if IMAGE != CUBE && IMAGE != LATLONG
float radius(float angle) {
#if IMAGE == SPHERE
  return sin(0.5 * angle);
#elif IMAGE == PARABOLOID
  return tan(0.5 * min(angle, 3.1));
#else
  return angle / pi;
#endif
}
#endif
