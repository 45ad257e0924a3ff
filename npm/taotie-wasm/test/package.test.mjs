// Tests the built package in Node: results like those of the native program, to the byte.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readdirSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { TaotieError, load } from "taotie-wasm";
import { BROKEN, bytes, folder, native, ran, timeless, waves } from "./native.mjs";

const CLI = [process.execPath, fileURLToPath(import.meta.resolve("taotie-wasm/cli"))];
const OPTIONS = { output: "asset.glb", triangles: 500, size: 256 };
const ARGS = ["bake", "waves.obj", "--output=asset.glb", "--triangles=500", "--size=256", "--json"];
const files = { "waves.obj": waves(), "broken.ply": BROKEN };

const taotie = await load();
const expected = native(ARGS);
const asset = bytes("asset.glb");
const page = bytes("asset.report.html");
assert.equal(expected.code, 0, expected.stderr);

test("a bake in memory is that of the native program, and reports its progress", async () => {
    const heard = [];
    const { code, stdout, files: made } = await taotie.bake("waves.obj", OPTIONS, { files, onProgress: (progress) => heard.push(progress) });
    assert.equal(code, 0);
    assert.deepEqual(Object.keys(made).sort(), ["asset.glb", "asset.report.html", "asset.report.json"]);
    assert(asset.equals(made["asset.glb"]), "the asset differs");
    assert.deepEqual(timeless(stdout), timeless(JSON.parse(expected.stdout)));
    assert(withoutTimes(Buffer.from(made["asset.report.html"])) === withoutTimes(page), "the report differs");
    assert(heard.length > 10, `${heard.length} reports of progress`);
    assert(heard.every(({ stage, done, left_s: left }) => stage && done >= 0 && done <= 1 && (left === null || left >= 0)));
    assert(heard.some(({ left_s: left }) => left !== null), "no time left");
});

/** A report page without the milliseconds of its stages. */
const withoutTimes = (html) => html.toString().replace(/\{"title":"Time".*?\]\]\}/s, "");

test("pictures and figures are those of the native program", async () => {
    const given = { ...files, "asset.glb": asset };
    const size = "200x160";
    const { files: made } = await taotie.render("asset.glb", { output: "asset.png", size }, { files: given });
    native(["render", "asset.glb", "-o", "asset.png", "--size", size]);
    assert(bytes("asset.png").equals(made["asset.png"]), "the picture differs");
    const verified = await taotie.verify("asset.glb", { scan: "waves.obj", require: "standard" }, { files: given });
    const { code, stdout } = native(["verify", "asset.glb", "--scan", "waves.obj", "--require", "standard", "--json"]);
    assert.equal(verified.code, code);
    assert.deepEqual(timeless(verified.stdout), timeless(JSON.parse(stdout)));
    const { stdout: listed } = await taotie.inspect("asset.glb", {}, { files: given });
    assert.deepEqual(listed, JSON.parse(native(["inspect", "asset.glb", "--json"]).stdout));
});

test("errors are those of the program", async () => {
    const wanted = native(["bake", "broken.ply", "-o", "x.glb"]).stderr.replace(/^taotie: error: /, "").trim();
    const refused = (error) => error instanceof TaotieError && error.code === 2 && error.message === wanted;
    await assert.rejects(taotie.bake("broken.ply", { output: "x.glb" }, { files }), refused);
    const { code, stderr } = await taotie.run(["bake", "broken.ply", "-o", "x.glb"], { files });
    assert.deepEqual([code, stderr], [2, `taotie: error: ${wanted}`]);
    const untranslated = await taotie.run(["shader", "--target", "hlsl", "-o", "x"], { files });
    assert.equal(untranslated.code, 2);
    assert.match(untranslated.stderr, /in hlsl: not in the WebAssembly module; use wgsl/);
    const unknown = (error) => error instanceof TaotieError && error.message.includes("--no-such-option");
    await assert.rejects(taotie.bake("waves.obj", { "no-such-option": 1 }, { files }), unknown);
    await assert.rejects(taotie.run(["inspect", "../a.ply"], { files: { "../a.ply": "" } }), /invalid file name/);
});

test("a run can be cancelled", async () => {
    const controller = new AbortController();
    setTimeout(() => controller.abort(), 200);
    await assert.rejects(taotie.bake("waves.obj", OPTIONS, { files, signal: controller.signal }), { name: "AbortError" });
    await assert.rejects(taotie.bake("waves.obj", OPTIONS, { files, signal: AbortSignal.abort() }), { name: "AbortError" });
});

test("names may have any letters", async () => {
    const { stdout } = await taotie.inspect("Büste – 鼎/waves.obj", {}, { files: { "Büste – 鼎/waves.obj": waves() } });
    assert.equal(stdout.counts.triangles, 9024);
});

test("the command reads and writes the files of the machine, with the native exit codes", () => {
    const named = ARGS.map((arg) => arg.replace("asset", "own"));
    const { code, stdout } = ran(CLI, named);
    assert.equal(code, 0);
    assert(bytes("own.glb").equals(asset), "the asset differs");
    assert.equal(JSON.parse(stdout).kind, "taotie bake");
    assert.equal(ran(CLI, ["bake", path.join(folder, "waves.obj"), "-o", path.join(folder, "absolute.glb"), "--size=64", "--no-verify"]).code, 0);
    assert(bytes("absolute.glb").length > 0);
    const wrong = ["bake", "broken.ply", "-o", "x.glb"];
    assert.deepEqual(ran(CLI, wrong), native(wrong));
    assert.equal(ran(CLI, ["verify", "own.glb", "--scan", "waves.obj", "--require", "mean-angle=0.001"]).code, 1);
});

test("a signal ends the command and leaves nothing behind", async () => {
    const before = readdirSync(folder).sort();
    const child = spawn(CLI[0], [...CLI.slice(1), "bake", "waves.obj", "-o", "late.glb", "--size", "4096"], { cwd: folder, stdio: "ignore" });
    const ended = new Promise((done) => child.on("close", done));
    const isAtWork = () => readdirSync(folder).some((name) => name.startsWith(".taotie-"));
    for (const end = Date.now() + 60_000; !isAtWork() && Date.now() < end; ) await new Promise((done) => setTimeout(done, 20));
    assert(isAtWork(), "the command made no folder");
    child.kill("SIGINT");
    assert.equal(await ended, 130);
    assert.deepEqual(readdirSync(folder).sort(), before);
});
