// Calibrated cameras in three.js' convention: x right, y up, looking along -z.

import type { Camera } from "pcmvs";
import { Matrix4, Quaternion, Vector3 } from "three";

export type Vec3 = [number, number, number];

/** Transforms from a camera's axes to the scene's frame. */
export function cameraToWorld(camera: Camera): Matrix4 {
    const { R, t } = camera;
    // biome-ignore format: a matrix by rows
    const worldToCamera = new Matrix4().set(
        R[0][0], R[0][1], R[0][2], t[0],
        R[1][0], R[1][1], R[1][2], t[1],
        R[2][0], R[2][1], R[2][2], t[2],
        0, 0, 0, 1,
    );
    return worldToCamera.invert().multiply(new Matrix4().makeScale(1, -1, -1));
}

/** A window in CSS pixels. Its parts at the top and at the bottom are covered by controls. */
export interface Window {
    width: number;
    height: number;
    covered: { top: number; bottom: number };
}

/** Scale and place of a picture that fills as much of a window as it can without being cropped or covered. */
export function fit(camera: Camera, { width, height, covered }: Window) {
    const free = height - covered.top - covered.bottom;
    const scale = Math.min(width / camera.width, free / camera.height);
    return {
        scale,
        left: (width - scale * camera.width) / 2,
        top: covered.top + (free - scale * camera.height) / 2,
    };
}

/** Projects as the camera does, with its picture fitted into a window. */
export function projection(camera: Camera, window: Window, near: number, far: number): Matrix4 {
    const { width, height } = window;
    const { scale, left, top } = fit(camera, window);
    const [[fx, skew, cx], [, fy, cy]] = camera.K;
    const [x, y] = [(2 * scale) / width, (2 * scale) / height];
    // The first pixel's centre is at (0, 0), and so its corner is at (-0.5, -0.5).
    // biome-ignore format: a matrix by rows
    return new Matrix4().set(
        x * fx, -x * skew, 1 - x * (cx + 0.5) - (2 * left) / width, 0,
        0, y * fy, -1 + y * (cy + 0.5) + (2 * top) / height, 0,
        0, 0, -(far + near) / (far - near), (-2 * far * near) / (far - near),
        0, 0, -1, 0,
    );
}

/** Rotates the scene's upward direction to +y. */
export function upright(up: readonly number[] | undefined): Quaternion {
    const [x, y, z] = up ?? [0, 1, 0];
    return new Quaternion().setFromUnitVectors(new Vector3(x, y, z).normalize(), new Vector3(0, 1, 0));
}

/** Mean upward direction of the cameras, for scenes that give none. */
export function meanUp(cameras: Camera[]): Vec3 {
    const sum = new Vector3();
    for (const { R } of cameras) sum.sub(new Vector3(...R[1]));
    sum.normalize();
    return [sum.x, sum.y, sum.z];
}
