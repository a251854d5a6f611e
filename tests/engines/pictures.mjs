// Balls in a real probe: what every engine, `envmap view` and Cycles are asked to draw.
export const size = 64, fov = 11.6, eye = [6, 4, 8];
export const balls = [[1, 0], [1, 0.25], [1, 0.5], [1, 1], [0, 0.5], [0, 1]].map(([metallic, roughness]) => ({ metallic, roughness }));
export const name_of = ({ metallic, roughness }) => `${metallic ? 'metal' : 'dielectric'} ${roughness}`;

// Of an engine, for its module: rows from the bottom, r g b a.
export async function pictures(engine, folder) {
  const scene = await engine.open(folder), drawn = {};
  for (const ball of balls)
    drawn[name_of(ball)] = Array.from(await scene.render({
      eye: engine.world(eye), target: [0, 0, 0], up: [0, 1, 0], fov, size, ball, exposure: 0.25 }));
  return drawn;
}
