// Draws the scene in FOLDER's scene.json with WebGL 2 into floats: one mesh, shared textures and blocks, many
// shaders. The pixels of shader N, from the top left, are written to N.json.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { complaintsOfReader, folder, launch, newPage } from "./browser.mjs";

const { shaders, ...scene } = JSON.parse(await readFile(path.join(folder, "scene.json"), "utf8"));

// WebGL without a graphics card.
const browser = await launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
const page = await newPage(browser, [64, 64]);
await page.goto("about:blank");
const missing = await page.evaluate((scene) => {
    const gl = document.createElement("canvas").getContext("webgl2");
    const missing = ["EXT_color_buffer_float", "OES_texture_float_linear"].filter((name) => !gl?.getExtension(name));
    if (missing.length) return missing;
    const [width, height] = scene.size;
    const target = (format, attachment) => {
        const buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
    };
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    target(gl.RGBA32F, gl.COLOR_ATTACHMENT0);
    target(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    const buffer = (kind, data) => {
        const made = gl.createBuffer();
        gl.bindBuffer(kind, made);
        gl.bufferData(kind, data, gl.STATIC_DRAW);
        return made;
    };
    const texture = ({ filtered, levels }) => {
        const made = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, made);
        levels.forEach(({ size: [w, h], texels }, level) => {
            gl.texImage2D(gl.TEXTURE_2D, level, gl.RGBA32F, w, h, 0, gl.RGBA, gl.FLOAT, new Float32Array(texels));
        });
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAX_LEVEL, levels.length - 1);
        const [near, far] = filtered ? [gl.LINEAR, gl.LINEAR_MIPMAP_LINEAR] : [gl.NEAREST, gl.NEAREST];
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, near);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, far);
        return made;
    };
    const textures = Object.fromEntries(Object.entries(scene.textures).map(([name, each]) => [name, texture(each)]));
    const attributes = Object.entries(scene.vertices).map(([name, { numbers, data }]) => {
        return { name, numbers, buffer: buffer(gl.ARRAY_BUFFER, new Float32Array(data)) };
    });
    const indices = buffer(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(scene.triangles.flat()));
    const compiled = (type, text) => {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        return shader;
    };
    window.draw = ({ vertex, fragment, blocks }) => {
        const program = gl.createProgram();
        gl.attachShader(program, compiled(gl.VERTEX_SHADER, vertex));
        gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, fragment));
        gl.linkProgram(program);
        gl.useProgram(program);
        Object.entries({ ...scene.blocks, ...blocks }).forEach(([name, bytes], binding) => {
            const index = gl.getUniformBlockIndex(program, name);
            if (index === gl.INVALID_INDEX) return;
            gl.uniformBlockBinding(program, index, binding);
            gl.bindBufferBase(gl.UNIFORM_BUFFER, binding, buffer(gl.UNIFORM_BUFFER, new Uint8Array(bytes)));
        });
        let unit = 0;
        for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
            const { name, type } = gl.getActiveUniform(program, i);
            if (type !== gl.SAMPLER_2D) continue;
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, textures[name] ?? textures.map);
            gl.uniform1i(gl.getUniformLocation(program, name), unit++);
        }
        for (const { name, numbers, buffer } of attributes) {
            const location = gl.getAttribLocation(program, name);
            if (location < 0) continue;
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.enableVertexAttribArray(location);
            gl.vertexAttribPointer(location, numbers, gl.FLOAT, false, 0, 0);
        }
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.drawElements(gl.TRIANGLES, scene.triangles.length * 3, gl.UNSIGNED_INT, 0);
        const pixels = new Float32Array(width * height * 4);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
        const log = gl.getProgramInfoLog(program);
        for (let location = 0; location < 8; location++) gl.disableVertexAttribArray(location);
        gl.deleteProgram(program);
        const row = (y) => Array.from(pixels.subarray((height - 1 - y) * width * 4, (height - y) * width * 4));
        const fault = log || (gl.getError() ? "a WebGL error" : "");
        return { fault, pixels: Array.from({ length: height }, (_, y) => row(y)).flat() };
    };
    return [];
}, scene);
assert.deepEqual(missing, []);
for (const [number, shader] of shaders.entries()) {
    const { fault, pixels } = await page.evaluate((shader) => window.draw(shader), shader);
    assert.equal(fault, "", `shader ${number}`);
    await writeFile(path.join(folder, `${number}.json`), JSON.stringify(pixels));
}
assert.deepEqual(complaintsOfReader(page), []);
await browser.close();
