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

/** Scale and place of a picture that fills as much of a window as it can without being cropped. */
export function fit(camera: Camera, width: number, height: number) {
    const scale = Math.min(width / camera.width, height / camera.height);
    return { scale, left: (width - scale * camera.width) / 2, top: (height - scale * camera.height) / 2 };
}

/** Projects as the camera does, with its picture fitted into a window. */
export function projection(camera: Camera, width: number, height: number, near: number, far: number): Matrix4 {
    const { scale, left, top } = fit(camera, width, height);
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
