// Compiles FOLDER's shaders.json: as pairs of WebGL 2 vertex and fragment shaders, checking the layout of their
// uniform blocks; and as WebGPU modules in WGSL. Fails if Chromium rejects a shader, warns about it, or uses another
// layout.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { complaints, folder, launch, newPage } from "./browser.mjs";

const shaders = JSON.parse(await readFile(path.join(folder, "shaders.json"), "utf8"));
assert(shaders.length > 0, "there are shaders");

// WebGPU is available only to pages with a secure address. There is no server at this one.
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
    // Returns the browser's messages about a pair; empty if there are none.
    const check = ({ name, vertex, fragment, offsets }) => {
        const pair = [compiled(gl.VERTEX_SHADER, vertex), compiled(gl.FRAGMENT_SHADER, fragment)];
        const program = gl.createProgram();
        pair.forEach((shader) => gl.attachShader(program, shader));
        gl.linkProgram(program);
        const logs = [...pair.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(program)];
        const linked = gl.getProgramParameter(program, gl.LINK_STATUS);
        const names = linked ? Object.keys(offsets) : [];
        const indices = gl.getUniformIndices(program, names) ?? [];
        const found = names.length ? gl.getActiveUniforms(program, indices, gl.UNIFORM_OFFSET) : [];
        const moved = names.filter((name, i) => found[i] !== offsets[name]).map((name) => `${name} has another offset`);
        pair.forEach((shader) => gl.deleteShader(shader));
        gl.deleteProgram(program);
        const faults = [...logs.filter((log) => log), ...moved, ...(linked ? [] : ["not linked"])];
        return faults.map((fault) => `${name}: ${fault}`);
    };
    return shaders.flatMap(check);
}, shaders);
assert.deepEqual(faults, []);

// The WebGPU messages about the modules; null without WebGPU.
const messages = await page.evaluate(async (shaders) => {
    const device = await (await navigator.gpu?.requestAdapter())?.requestDevice();
    if (!device) return null;
    const check = async ({ name, wgsl }) => {
        const { messages } = await device.createShaderModule({ code: wgsl }).getCompilationInfo();
        return messages.map(({ type, message, lineNum }) => `${name}: ${type} in line ${lineNum}: ${message}`);
    };
    return (await Promise.all(shaders.map(check))).flat();
}, shaders);
assert.deepEqual(messages ?? [], []);
assert.deepEqual(complaints(page), []);
console.log(`${shaders.length} shaders compiled${messages ? "" : ", none in WGSL: no WebGPU"}`);
await browser.close();
