// PlayCanvas: an .hdr file as an equirectangular texture, EnvLighting makes the rest; drawn into floats.
import * as pc from 'playcanvas';

// EnvLighting samples GGX itself, and takes mips of the map for speed.
export const limits = { width: Infinity };

export const world = (d) => d;

const canvas = document.getElementById('canvas');
const app = new pc.Application(canvas, { graphicsDeviceOptions: { antialias: false } });
app.autoRender = false;
app.start();

const load = (url) => new Promise((loaded, failed) => {
  const asset = new pc.Asset('probe', 'texture', { url }, { mipmaps: false });
  asset.ready(() => loaded(asset.resource));
  asset.once('error', failed);
  app.assets.add(asset);
  app.assets.load(asset);
});

export async function open(folder) {
  while (app.root.children.length > 0) app.root.children[0].destroy();
  const probe = await load(`${folder}/background.hdr`);
  probe.projection = pc.TEXTUREPROJECTION_EQUIRECT;
  app.scene.skybox = pc.EnvLighting.generateSkyboxCubemap(probe);
  app.scene.envAtlas = pc.EnvLighting.generateAtlas(pc.EnvLighting.generateLightingSource(probe));
  app.scene.skyboxMip = 0;
  app.scene.exposure = 1;
  const sphere = new pc.Entity(), material = new pc.StandardMaterial();
  sphere.addComponent('render', { meshInstances: [new pc.MeshInstance(
    pc.Mesh.fromGeometry(app.graphicsDevice, new pc.SphereGeometry({ radius: 1, latitudeBands: 128, longitudeBands: 128 })), material)] });
  material.diffuse = pc.Color.WHITE;
  material.useMetalness = true;
  app.root.addChild(sphere);
  const camera = new pc.Entity();
  camera.addComponent('camera', { toneMapping: pc.TONEMAP_LINEAR, gammaCorrection: pc.GAMMA_NONE, nearClip: 0.1, farClip: 100 });
  app.root.addChild(camera);
  return {
    async render({ eye, target, up, fov, size, ball }) {
      sphere.enabled = ball !== null;
      material.metalness = ball?.metallic ?? 0;
      material.gloss = 1 - (ball?.roughness ?? 0);
      material.update();
      camera.setPosition(...eye);
      camera.lookAt(new pc.Vec3(...target), new pc.Vec3(...up));
      camera.camera.fov = fov;
      const texture = new pc.Texture(app.graphicsDevice, {
        width: size, height: size, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST });
      const image = new pc.RenderTarget({ colorBuffer: texture, depth: true });
      camera.camera.renderTarget = image;
      app.render();
      const pixels = await texture.read(0, 0, size, size, { renderTarget: image, immediate: true });
      camera.camera.renderTarget = null;
      image.destroy();
      texture.destroy();
      return Float32Array.from(pixels);
    },
  };
}
