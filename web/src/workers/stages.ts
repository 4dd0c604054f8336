// The outputs of a frame's stages that can be looked at.

import type { Cloud, Reconstruction, Rig } from "pcmvs";
import type { FrameStages, StageCloud } from "./protocol";

export function stagesOf(made: Reconstruction, rig: Rig): FrameStages {
    const mesh = made.mesh("hull");
    const cloud = (points: Cloud, tags: Uint16Array): StageCloud => ({
        kind: "cloud",
        positions: points.positions,
        tags,
    });
    const [detected, contours, merged] = [made.detected(), made.contours(), made.merged()];
    const outputs: FrameStages["outputs"] = {
        hull: { kind: "mesh", positions: mesh.positions, normals: mesh.normals, triangles: mesh.triangles },
        detected: cloud(detected, detected.views),
        contours: cloud(contours, Uint16Array.from(contours.ranks)),
        merged: cloud(merged, merged.views),
    };
    for (const object of [mesh, detected, contours, merged]) object.free();
    return { origin: [...rig.origin], outputs };
}
