// The camera of a state.

import { Matrix4, PerspectiveCamera, Vector3 } from "three";
import type { Orbit } from "./data";
import type { State } from "./state";

export const radians = (degrees: number): number => (degrees * Math.PI) / 180;
export const degrees = (angle: number): number => (angle * 180) / Math.PI;

/** The unit direction at `azimuth` degrees to the right of +z and `elevation` degrees above the horizon. */
export function direction(azimuth: number, elevation: number): Vector3 {
    const [a, e] = [radians(azimuth), radians(elevation)];
    return new Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
}

/** Azimuth and elevation of a unit direction, degrees. */
export function angles(to: Vector3): [number, number] {
    return [degrees(Math.atan2(to.x, to.z)), degrees(Math.asin(Math.min(Math.max(to.y, -1), 1)))];
}

/** The right, up and back axes of the camera. */
export function axes({ view: [azimuth, elevation] }: State): [Vector3, Vector3, Vector3] {
    const a = radians(azimuth);
    const right = new Vector3(Math.cos(a), 0, -Math.sin(a));
    const back = direction(azimuth, elevation);
    return [right, new Vector3().crossVectors(back, right), back];
}

/** Places a camera; `size` is the picture size, pixels, and `offset` the sample position in the pixel, [0, 1]. */
export function place(
    camera: PerspectiveCamera,
    state: State,
    lens: Orbit,
    picture: { size: [number, number]; offset: [number, number] },
): void {
    const [right, up, back] = axes(state);
    const distance = state.view[2];
    const eye = new Vector3(...state.target).addScaledVector(back, distance);
    camera.matrixAutoUpdate = false;
    camera.matrix.makeBasis(right, up, back).setPosition(eye);
    camera.updateMatrixWorld(true);
    const [width, height] = picture.size;
    const aspect = width / height;
    const half = Math.tan(radians(lens.fov_y) / 2) * Math.max(1, lens.aspect / aspect);
    const away = eye.distanceTo(new Vector3(...lens.center));
    const near = Math.max(away - 1.01 * lens.radius, Math.max(away, lens.radius) * 1e-3);
    const far = Math.max(away + 1.01 * lens.radius, 2 * near);
    const top = near * half;
    camera.near = near;
    camera.far = far;
    camera.projectionMatrix.makePerspective(-top * aspect, top * aspect, top, -top, near, far);
    const [x, y] = picture.offset;
    const shift = new Matrix4().makeTranslation((1 - 2 * x) / width, (2 * y - 1) / height, 0);
    camera.projectionMatrix.premultiply(shift);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
}
