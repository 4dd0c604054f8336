// How the camera moves through a video.

import { CubicInterpolant, Spherical, Vector3 } from "three";
import { type OrbitView, type SceneCopy, type Standpoint, turned } from "../viewer/copy";
import type { PictureSize } from "./studio";

export type Motion = { kind: "still" } | { kind: "turntable" } | { kind: "path"; views: OrbitView[] };

/** Numbers of a view that are interpolated: its target, the logarithm of the distance, and two angles. */
const NUMBERS = 6;
/** Looking straight down, a camera has no upright direction. */
const STEEPEST = 0.01;

/** The standpoint of each of `count` pictures. */
export function standpoints(
    motion: Motion,
    shown: SceneCopy,
    { width, height }: PictureSize,
    count: number,
): (picture: number) => Standpoint {
    const start = shown.standpoint(width, height);
    switch (motion.kind) {
        case "still":
            return () => start;
        case "turntable":
            // The picture after the last one would be the first, so that the video can be repeated.
            return (picture) => turned(start, shown.target, (2 * Math.PI * picture) / count);
        case "path": {
            const path = curve(motion.views);
            return (picture) => shown.standAt(path(picture / Math.max(1, count - 1)), width, height);
        }
    }
}

/** A smooth curve through views, by the share of its time. It turns around the targets instead of cutting through the object. */
function curve(views: OrbitView[]): (share: number) => OrbitView {
    const numbers = views.map(({ position, target }) => {
        const { radius, phi, theta } = new Spherical().setFromVector3(position.clone().sub(target));
        return [...target.toArray(), Math.log(radius), phi, theta];
    });
    // Each angle is the one that is nearest to the angle before.
    for (let i = 1; i < numbers.length; i++) {
        const turns = Math.round((numbers[i - 1][5] - numbers[i][5]) / (2 * Math.PI));
        numbers[i][5] += 2 * Math.PI * turns;
    }
    const times = Float64Array.from(views, (_, i) => i / (views.length - 1));
    const values = Float64Array.from(numbers.flat());
    const spline = new CubicInterpolant(times, values, NUMBERS, new Float64Array(NUMBERS));
    return (share) => {
        const [x, y, z, distance, phi, theta] = spline.evaluate(share);
        const target = new Vector3(x, y, z);
        const steep = Math.min(Math.PI - STEEPEST, Math.max(STEEPEST, phi));
        const position = new Vector3().setFromSphericalCoords(Math.exp(distance), steep, theta).add(target);
        return { position, target };
    };
}
