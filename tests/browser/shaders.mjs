// Compiles FOLDER's shaders.json: as WebGL 2 pairs of vertex and fragment shaders, and where the fields of their uniform
// blocks lie; as WebGPU modules in WGSL. Fails where Chromium refuses one, warns of one, or lays a block out otherwise.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { complaints, folder, launch, newPage } from "./browser.mjs";

const shaders = JSON.parse(await readFile(path.join(folder, "shaders.json"), "utf8"));
assert(shaders.length > 0, "there are shaders");

// WebGPU is given to pages of a secure address alone. No server stands behind this one.
const SITE = "http://localhost/";

// WebGL and WebGPU without a graphics card.
const webgl = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const webgpu = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan", "--use-vulkan=swiftshader"];
const browser = await launch([...webgl, ...webgpu]);
const page = await newPage(browser, [64, 64]);
await page.route(SITE, (route) => route.fulfill({ body: "<link rel=icon href='data:,'>", contentType: "text/html" }));
await page.goto(SITE);
const faults = await page.evaluate((shaders) => {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl) return ["no WebGL 2"];
    const compiled = (type, text) => {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        return shader;
    };
    // What the browser says of a pair; empty where all is well.
    const told = ({ name, vertex, fragment, offsets }) => {
        const pair = [compiled(gl.VERTEX_SHADER, vertex), compiled(gl.FRAGMENT_SHADER, fragment)];
        const program = gl.createProgram();
        pair.forEach((shader) => gl.attachShader(program, shader));
        gl.linkProgram(program);
        const logs = [...pair.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(program)];
        const linked = gl.getProgramParameter(program, gl.LINK_STATUS);
        const names = linked ? Object.keys(offsets) : [];
        const indices = gl.getUniformIndices(program, names) ?? [];
        const found = names.length ? gl.getActiveUniforms(program, indices, gl.UNIFORM_OFFSET) : [];
        const moved = names.filter((name, i) => found[i] !== offsets[name]).map((name) => `${name} is elsewhere`);
        pair.forEach((shader) => gl.deleteShader(shader));
        gl.deleteProgram(program);
        const faults = [...logs.filter((log) => log), ...moved, ...(linked ? [] : ["not linked"])];
        return faults.map((fault) => `${name}: ${fault}`);
    };
    return shaders.flatMap(told);
}, shaders);
assert.deepEqual(faults, []);

// What WebGPU says of the modules; none where there is no WebGPU.
const messages = await page.evaluate(async (shaders) => {
    const device = await (await navigator.gpu?.requestAdapter())?.requestDevice();
    if (!device) return null;
    const told = async ({ name, wgsl }) => {
        const { messages } = await device.createShaderModule({ code: wgsl }).getCompilationInfo();
        return messages.map(({ type, message, lineNum }) => `${name}: ${type} in line ${lineNum}: ${message}`);
    };
    return (await Promise.all(shaders.map(told))).flat();
}, shaders);
assert.deepEqual(messages ?? [], []);
assert.deepEqual(complaints(page), []);
console.log(`${shaders.length} shaders compiled${messages ? "" : ", in WGSL none: no WebGPU"}`);
await browser.close();
