// A copy of what the view shows, to be drawn elsewhere: in another size, from elsewhere, with other meshes.

import { Matrix4, type Object3D, Quaternion, type Scene, Vector3 } from "three";
import type { Surface } from "./surface";

/** From where a picture is taken, in the view's world, in which +y is up. */
export interface Standpoint {
    /** From the camera's axes to the world. */
    pose: Matrix4;
    /** The same of the lamp, which usually goes with the camera. */
    lamp: Matrix4;
    projection: Matrix4;
}

/** A view from outside, which the person has chosen. */
export interface OrbitView {
    position: Vector3;
    target: Vector3;
}

export interface SceneCopy {
    scene: Scene;
    surface: Surface;
    lamp: Object3D;
    grid: Object3D;
    /** The point that the view turns around. */
    target: Vector3;
    /** The point of view of the window, for a picture of this size. */
    standpoint(width: number, height: number): Standpoint;
    /** One that stands and looks as asked, with the lens of the view from outside. */
    standAt(view: OrbitView, width: number, height: number): Standpoint;
    /** The narrower side of the window's picture, in its pixels. */
    narrow: number;
}

const UP = new Vector3(0, 1, 0);

/** The pose of a camera that looks from one point at another. */
export function lookingAt({ position, target }: OrbitView): Matrix4 {
    const turn = new Matrix4().lookAt(position, target, UP);
    return new Matrix4().compose(position, new Quaternion().setFromRotationMatrix(turn), new Vector3(1, 1, 1));
}

/** A standpoint after a turn around the vertical axis through a point, in radians. */
export function turned({ pose, lamp, projection }: Standpoint, target: Vector3, angle: number): Standpoint {
    const turn = new Matrix4()
        .makeTranslation(target)
        .multiply(new Matrix4().makeRotationY(angle))
        .multiply(new Matrix4().makeTranslation(target.clone().negate()));
    return { pose: turn.clone().multiply(pose), lamp: turn.multiply(lamp), projection };
}
