// Prints the messages of the Khronos validator about a glTF file: `node validate.mjs model.glb`.
import { readFile } from "node:fs/promises";
import { dirname, resolve } from "node:path";
import validator from "gltf-validator";

const path = process.argv[2];
const sibling = (uri) => readFile(resolve(dirname(path), decodeURIComponent(uri))).then((bytes) => new Uint8Array(bytes));
const options = { uri: path, maxIssues: 0, writeTimestamp: false, externalResourceFunction: sibling };
const report = await validator.validateBytes(new Uint8Array(await readFile(path)), options);
console.log(JSON.stringify(report.issues.messages));
