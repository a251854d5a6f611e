// Faces of a mirror's map in colours that tell them apart.
uniform bool tinted;

vec3 tint(int face) {
  if (!tinted) return vec3(1);
  const vec3 warm = vec3(1.25, 0.85, 0.65), cold = vec3(0.65, 0.85, 1.25);
  return (face & 1) == 0 ? (face == 2 ? warm.grb : face == 4 ? warm.bgr : warm)
                         : (face == 3 ? cold.grb : face == 5 ? cold.bgr : cold);
}
