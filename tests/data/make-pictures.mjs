// Makes the KTX2 files of pictures/ from waves.png, and for each a PNG decoded by Basis Universal's own
// transcoder. Run next to node_modules with ktx2-encoder 0.6.0 (which holds Basis Universal as WebAssembly) and sharp:
//     node make-pictures.mjs FOLDER
import { writeFileSync } from 'node:fs';
import { encodeToKTX2 } from 'ktx2-encoder';
import basis from './node_modules/ktx2-encoder/dist/basis/basis_encoder.js';
import sharp from 'sharp';

const folder = process.argv[2];
const raw = async (file) => sharp(file).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
const opaque = (data) => data.map((v, i) => (i % 4 === 3 ? 255 : v));

/** The texels of the largest level. */
function transcoded(module, bytes) {
  const file = new module.KTX2File(bytes);
  if (!file.isValid() || !file.startTranscoding()) throw new Error('not valid');
  const { value: rgba32 } = module.transcoder_texture_format.cTFRGBA32;
  const texels = new Uint8Array(file.getImageTranscodedSizeInBytes(0, 0, 0, rgba32));
  if (!file.transcodeImage(texels, 0, 0, 0, rgba32, 0, -1, -1)) throw new Error('not transcoded');
  file.close();
  file.delete();
  return texels;
}

const module = await basis();
module.initializeBasis();
const { data, info } = await raw(`${folder}/waves.png`);
const make = async (name, texels, options) => {
  const imageDecoder = async () => ({ data: texels, width: info.width, height: info.height });
  const bytes = await encodeToKTX2(new Uint8Array(1), { imageDecoder, generateMipmap: false, isKTX2File: true, ...options });
  writeFileSync(`${folder}/${name}.ktx2`, bytes);
  const shape = { raw: { width: info.width, height: info.height, channels: 4 } };
  const picture = sharp(transcoded(module, bytes), shape);
  await (options.alpha ? picture : picture.removeAlpha()).png({ compressionLevel: 9 }).toFile(`${folder}/${name}.png`);
};
await make('etc1s', opaque(data), { isUASTC: false, qualityLevel: 200 });
await make('etc1s-alpha', data, { isUASTC: false, qualityLevel: 200, generateMipmap: true, alpha: true });
await make('uastc-alpha', data, { isUASTC: true, needSupercompression: false, alpha: true });
await make('uastc-zstd', opaque(data), { isUASTC: true, needSupercompression: true, generateMipmap: true });
