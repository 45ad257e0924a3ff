// The codes of an image.

import { Texture, type WebGLRenderer, WebGLRenderTarget } from "three";
import { texts } from "./texts";

/**
 * Returns the codes of an image as stored, four per texel, row by row. They are read through a texture: a 2D canvas
 * would multiply colours by alpha. Throws if the graphics context is lost.
 */
export async function pixels(renderer: WebGLRenderer, image: ImageBitmap): Promise<Uint8Array> {
    const { width, height } = image;
    const isLost = () => renderer.getContext().isContextLost();
    const codes = new Uint8Array(4 * width * height);
    const target = new WebGLRenderTarget(width, height, { depthBuffer: false });
    try {
        if (isLost()) throw new Error(texts.noPicture);
        renderer.initRenderTarget(target);
        renderer.copyTextureToTexture(new Texture(image), target.texture);
        await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height, codes);
        return codes;
    } catch (error) {
        // Then three.js gives no reason.
        throw isLost() ? new Error(texts.noPicture) : error;
    } finally {
        target.dispose();
    }
}
