// A scan, and what the native program makes of it: TAOTIE is the program.

import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";

/** Returns an OBJ of a sphere with waves. */
export function waves() {
    const [columns, rows] = [96, 48];
    const lines = [];
    for (let row = 0; row <= rows; row++) {
        for (let column = 0; column < columns; column++) {
            const [u, v] = [(column / columns) * 2 * Math.PI, (row / rows) * Math.PI];
            const radius = 1 + 0.02 * Math.sin(12 * u) * Math.sin(11 * v);
            const point = [Math.sin(v) * Math.cos(u), Math.cos(v), Math.sin(v) * Math.sin(u)];
            lines.push(`v ${point.map((part) => (radius * part).toFixed(6)).join(" ")}`);
        }
    }
    const at = (row, column) => 1 + row * columns + (column % columns);
    for (let row = 0; row < rows; row++) {
        for (let column = 0; column < columns; column++) {
            const [a, b, c, d] = [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
            if (row > 0) lines.push(`f ${a} ${b} ${c}`);
            if (row < rows - 1) lines.push(`f ${a} ${c} ${d}`);
        }
    }
    return `${lines.join("\n")}\n`;
}

export const BROKEN = "ply\nformat ascii 1.0\nelement vertex three\nend_header\n";

/** A new folder with the scan, and with a file that is not one. */
export const folder = mkdtempSync(path.join(os.tmpdir(), "taotie-wasm-"));
writeFileSync(path.join(folder, "waves.obj"), waves());
writeFileSync(path.join(folder, "broken.ply"), BROKEN);

/** Runs a program in the folder. */
export function ran(program, args) {
    const { status, stdout, stderr } = spawnSync(program[0], [...program.slice(1), ...args], { cwd: folder, encoding: "utf8" });
    return { code: status, stdout, stderr };
}

export const native = (args) => ran([process.env.TAOTIE], args);
export const bytes = (name) => readFileSync(path.join(folder, name));

/** Returns a report without what differs from run to run: its times. */
export const timeless = (report) => ({ ...report, stages: report.stages.map(({ stage }) => stage) });
