// A section: the intersection of a plane and the model, and its profile between two points.

import { type BufferGeometry, Vector3 } from "three";

/** A piece of a profile: its two ends, as distances along and above the line between the points, model units. */
export type Piece = [[number, number], [number, number]];

/** The plane through two points that contains the view direction: its axes along the line, above it, and across. */
interface Plane {
    from: Vector3;
    along: Vector3;
    above: Vector3;
    across: Vector3;
    length: number;
}

function plane(from: Vector3, to: Vector3, sight: Vector3): Plane {
    const along = new Vector3().subVectors(to, from);
    const length = along.length();
    along.normalize();
    const above = sight.clone().addScaledVector(along, -sight.dot(along)).normalize();
    return { from, along, above, across: new Vector3().crossVectors(along, above), length };
}

const seen = (p: Vector3, { from, along, above }: Plane): [number, number] => {
    const d = new Vector3().subVectors(p, from);
    return [d.dot(along), d.dot(above)];
};

/** The intersection of the plane and a triangle; undefined if there is none. */
function cut(corners: Vector3[], at: Plane): Piece | undefined {
    const sides = corners.map((corner) => new Vector3().subVectors(corner, at.from).dot(at.across));
    const points: [number, number][] = [];
    for (let i = 0; i < 3; i++) {
        const j = (i + 1) % 3;
        const [a, b] = [sides[i]!, sides[j]!];
        if (a < 0 === b < 0) continue;
        points.push(seen(new Vector3().lerpVectors(corners[i]!, corners[j]!, a / (a - b)), at));
    }
    const [p, q] = points;
    if (!p || !q) return undefined;
    return p[0] <= q[0] ? [p, q] : [q, p];
}

/** The part of a piece between the points. */
function clipped([p, q]: Piece, length: number): Piece | undefined {
    if (q[0] < 0 || p[0] > length) return undefined;
    const at = (s: number): [number, number] => [s, p[1] + ((q[1] - p[1]) * (s - p[0])) / (q[0] - p[0])];
    return [p[0] < 0 ? at(0) : p, q[0] > length ? at(length) : q];
}

/** The profile of geometries between two points, as seen by the viewer, with the pieces in order. */
export function profile(geometries: BufferGeometry[], ends: [Vector3, Vector3], sight: Vector3): Piece[] {
    const at = plane(...ends, sight);
    const pieces: Piece[] = [];
    for (const geometry of geometries) {
        const [index, positions] = [geometry.index, geometry.attributes["position"]];
        if (!index || !positions) continue;
        const corners = [new Vector3(), new Vector3(), new Vector3()];
        for (let t = 0; t < index.count; t += 3) {
            corners.forEach((corner, i) => corner.fromBufferAttribute(positions, index.getX(t + i)));
            const piece = cut(corners, at);
            const kept = piece && clipped(piece, at.length);
            if (kept) pieces.push(kept);
        }
    }
    return pieces.sort((a, b) => a[0][0] - b[0][0]);
}

/** The profile as comma-separated values, one line per piece; `unit` is the unit of the model's lengths. */
export function csv(pieces: Piece[], unit: string): string {
    const names = ["along_from", "above_from", "along_to", "above_to"];
    const head = names.map((name) => `${name} (${unit})`).join();
    return [head, ...pieces.map((piece) => piece.flat().map((v) => v.toPrecision(7)).join())].join("\n") + "\n";
}

/** The profile as a drawing with a line from end to end; `unit` is the unit of the model and of the drawing. */
export function svg(pieces: Piece[], length: number, unit: string): string {
    const heights = pieces.flat().map(([, above]) => above);
    const [low, high] = [Math.min(0, ...heights), Math.max(0, ...heights)];
    const gap = 0.05 * length;
    const n = (v: number) => v.toPrecision(7);
    const d = pieces.map(([p, q]) => `M${n(p[0])} ${n(-p[1])}L${n(q[0])} ${n(-q[1])}`).join("");
    const box = [-gap, -high - gap, length + 2 * gap, high - low + 2 * gap].map(n).join(" ");
    const stroke = `fill="none" stroke-width="${n(length / 400)}"`;
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="${box}"><title>Profile, lengths in ${unit}</title><path d="M0 0H${n(length)}" ${stroke} stroke="#999"/><path d="${d}" ${stroke} stroke="#000"/></svg>\n`;
}
