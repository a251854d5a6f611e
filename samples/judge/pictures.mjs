// In place of tests/engines' module of this name: red in the middle of a white metal ball as seen from each direction.
export async function pictures(engine, folder) {
  const { directions, roughness } = await (await fetch('asked/asked.json')).json();
  const scene = await engine.open(folder), shown = [];
  for (const d of directions) {
    const eye = engine.world(d).map((x) => 10 * x), up = Math.abs(d[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0];
    const pixels = await scene.render({ eye, target: [0, 0, 0], up, fov: 1, size: 9, ball: { metallic: 1, roughness } });
    shown.push(pixels[4 * (4 * 9 + 4)]);
  }
  return shown;
}
