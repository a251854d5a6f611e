// Where directions lie in the image of a face, by its SHAPE (face_image.h). Discs and bands are images of two angles: from an
// axis, and round it. `to_face` turns the frame of the map so that the axis is Z and the azimuth 0 lies along X; of a
// plane X is right, Y up and Z into the face.
uniform mat3 to_face;
uniform vec2 pixel;  // Of the image, in clip space.
uniform vec2 shift;  // Brings where a sample lies to the centre of its texel, where the rasteriser looks.

#if SHAPE == DISC
float radius(float angle) { return RADIUS(angle); }
#elif SHAPE != PLANE && SHAPE != BAND
#error "no formula for images of this shape"
#endif
