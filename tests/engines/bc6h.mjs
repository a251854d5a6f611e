// An image by Basis Universal's encoder (ktx2-encoder carries it) as UASTC HDR, and what its transcoder (three.js carries it) makes
// of that in BC6H, as a DDS file.
//
//   node bc6h.mjs IMAGE.exr OUT.dds QUALITY     0 to 4, as basisu's -hdr_uastc_level
//
// Prints the seconds of processor time that the encoder took, in WebAssembly.
import fs from 'fs';
import { createRequire } from 'module';
import { encodeToKTX2 } from 'ktx2-encoder';

const [, , input, output, quality] = process.argv;
const image = new Uint8Array(fs.readFileSync(input));
const start = process.cpuUsage();
const ktx2 = await encodeToKTX2(image, {
  isHDR: true, imageType: 'exr', isUASTC: true, hdrQualityLevel: Number(quality), generateMipmap: false,
  needSupercompression: false, enableDebug: false,
});
const used = process.cpuUsage(start);

// The transcoder is a script for pages, which leaves its maker in BASIS.
const folder = 'node_modules/three/examples/jsm/libs/basis/';
const script = fs.readFileSync(folder + 'basis_transcoder.js', 'utf8') + '\nreturn BASIS;';
const maker = new Function('require', '__filename', '__dirname', script)(createRequire(import.meta.url), folder, folder);
const basis = await maker({ wasmBinary: fs.readFileSync(folder + 'basis_transcoder.wasm') });
basis.initializeBasis();
const file = new basis.KTX2File(ktx2), to_bc6h = 22; // transcoder_texture_format::cTFBC6H
if (!file.isValid() || !file.startTranscoding()) throw new Error(`${input}: not transcoded`);
const blocks = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, to_bc6h));
if (!file.transcodeImage(blocks, 0, 0, 0, to_bc6h, 0, -1, -1)) throw new Error(`${input}: no BC6H`);

const head = new Uint32Array(37); // 'DDS ', DDS_HEADER, DDS_HEADER_DXT10 with DXGI_FORMAT_BC6H_UF16
head.set([0x20534444, 124, 0x81007, file.getHeight(), file.getWidth(), blocks.length, 1, 1]);
head.set([32, 4, 0x30315844], 19);
head.set([0x1000], 27);
head.set([95, 3, 0, 1, 0], 32);
fs.writeFileSync(output, Buffer.concat([Buffer.from(head.buffer), blocks]));
console.log(((used.user + used.system) / 1e6).toFixed(2));
