// A white ball of radius 1 as a GLB file.
export function ball_glb({ metallic, roughness }, columns = 256, rows = 128) {
  const places = [], triangles = [];
  for (let j = 0; j <= rows; ++j)
    for (let i = 0; i <= columns; ++i) {
      const a = (2 * Math.PI * i) / columns, b = (Math.PI * j) / rows;
      places.push(Math.sin(b) * Math.cos(a), Math.cos(b), Math.sin(b) * Math.sin(a));
      if (i === columns || j === rows) continue;
      const at = j * (columns + 1) + i, below = at + columns + 1;
      triangles.push(at, at + 1, below, below, at + 1, below + 1);
    }
  const vertices = new Float32Array(places), indices = new Uint32Array(triangles);
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 0 }, indices: 1, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { metallicFactor: metallic, roughnessFactor: roughness } }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: vertices.length / 3, type: 'VEC3', min: [-1, -1, -1], max: [1, 1, 1] },
      { bufferView: 1, componentType: 5125, count: indices.length, type: 'SCALAR' },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: vertices.byteLength },
      { buffer: 0, byteOffset: vertices.byteLength, byteLength: indices.byteLength },
    ],
    buffers: [{ byteLength: vertices.byteLength + indices.byteLength }],
  };
  let text = JSON.stringify(json);
  text += ' '.repeat((4 - (text.length % 4)) % 4);
  const binary = vertices.byteLength + indices.byteLength, file = new Uint8Array(28 + text.length + binary);
  const header = new Uint32Array([0x46546c67, 2, file.length, text.length, 0x4e4f534a]);
  file.set(new Uint8Array(header.buffer), 0);
  file.set(new TextEncoder().encode(text), 20);
  file.set(new Uint8Array(new Uint32Array([binary, 0x004e4942]).buffer), 20 + text.length);
  file.set(new Uint8Array(vertices.buffer), 28 + text.length);
  file.set(new Uint8Array(indices.buffer), 28 + text.length + vertices.byteLength);
  return file;
}
