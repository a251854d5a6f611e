// Images of lights, in their order.
layout(std430, binding = BUFFER_LIGHT_FACES) readonly buffer LightFaces { LightFace light_faces[]; };
