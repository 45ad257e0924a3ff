// Runs the shaders of FOLDER's points.json over its points with WebGL 2 into floats. The pixels of all draws of
// shader N, row by row in the requested order, are written to N.bin.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { complaintsOfReader, folder, launch, newPage } from "./browser.mjs";

const { shaders, ...scene } = JSON.parse(await readFile(path.join(folder, "points.json"), "utf8"));

// There is no server at this address: requests are answered below.
const SITE = "http://localhost/";

// WebGL without a graphics card.
const browser = await launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
const page = await newPage(browser, [64, 64]);
await page.route(`${SITE}**`, (route) => {
    const name = new URL(route.request().url()).pathname.slice(1);
    if (name) return route.fulfill({ path: path.join(folder, name) });
    return route.fulfill({ body: "<link rel=icon href='data:,'>", contentType: "text/html" });
});
await page.goto(SITE);
const missing = await page.evaluate(async (scene) => {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl?.getExtension("EXT_color_buffer_float")) return "no WebGL 2 with floats";
    const [width, height] = scene.size;
    const target = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, target);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
    gl.viewport(0, 0, width, height);
    const texture = async ([name, { size: [w, h], file }]) => {
        const texels = new Float32Array(await (await fetch(file)).arrayBuffer());
        const made = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, made);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, w, h, 0, gl.RGBA, gl.FLOAT, texels);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAX_LEVEL, 0);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        return [name, made];
    };
    const textures = async (described) => Object.fromEntries(await Promise.all(Object.entries(described).map(texture)));
    const block = (bytes) => {
        const made = gl.createBuffer();
        gl.bindBuffer(gl.UNIFORM_BUFFER, made);
        gl.bufferData(gl.UNIFORM_BUFFER, new Uint8Array(bytes), gl.STATIC_DRAW);
        return made;
    };
    const blocks = (described) => Object.entries(described).map(([name, bytes]) => [name, block(bytes)]);
    const shared = await textures(scene.shared);
    const draws = [];
    for (const draw of scene.draws) {
        draws.push({ textures: { ...shared, ...(await textures(draw.textures)) }, blocks: blocks(draw.blocks) });
    }
    const compiled = (type, text) => {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        return shader;
    };
    const vertex = compiled(gl.VERTEX_SHADER, scene.vertex);
    const bindBlocks = (program, all) => {
        all.forEach(([name, buffer], binding) => {
            const index = gl.getUniformBlockIndex(program, name);
            if (index === gl.INVALID_INDEX) return;
            gl.uniformBlockBinding(program, index, binding);
            gl.bindBufferBase(gl.UNIFORM_BUFFER, binding, buffer);
        });
    };
    const bindTextures = (program, all, pictures) => {
        let unit = 0;
        for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
            const { name, type } = gl.getActiveUniform(program, i);
            if (type !== gl.SAMPLER_2D) continue;
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, all[pictures[name] ?? name]);
            gl.uniform1i(gl.getUniformLocation(program, name), unit++);
        }
    };
    const dataUrl = (blob) =>
        new Promise((done) => {
            const reader = new FileReader();
            reader.onload = () => done(reader.result);
            reader.readAsDataURL(blob);
        });
    window.draw = async ({ fragment, blocks: materials, pictures }) => {
        const program = gl.createProgram();
        const shader = compiled(gl.FRAGMENT_SHADER, fragment);
        gl.attachShader(program, vertex);
        gl.attachShader(program, shader);
        gl.linkProgram(program);
        const log = gl.getShaderInfoLog(shader) || gl.getProgramInfoLog(program);
        if (log) return { fault: log };
        gl.useProgram(program);
        const pixels = new Float32Array(draws.length * width * height * 4);
        draws.forEach((draw, number) => {
            const material = block(materials[number]);
            bindBlocks(program, [...draw.blocks, ["MaterialBlock", material]]);
            bindTextures(program, draw.textures, pictures);
            gl.clearColor(NaN, NaN, NaN, NaN);
            gl.clear(gl.COLOR_BUFFER_BIT);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
            const size = width * height * 4;
            gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels.subarray(number * size, (number + 1) * size));
            gl.deleteBuffer(material);
        });
        gl.deleteProgram(program);
        gl.deleteShader(shader);
        return { fault: gl.getError() ? "a WebGL error" : "", pixels: await dataUrl(new Blob([pixels])) };
    };
    return "";
}, scene);
assert.equal(missing, "");
for (const [number, shader] of shaders.entries()) {
    const { fault, pixels } = await page.evaluate((shader) => window.draw(shader), shader);
    assert.equal(fault, "", `shader ${number}`);
    await writeFile(path.join(folder, `${number}.bin`), Buffer.from(pixels.split(",")[1], "base64"));
}
assert.deepEqual(complaintsOfReader(page), []);
await browser.close();
