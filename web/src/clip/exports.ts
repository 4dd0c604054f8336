// Files of single frames that a person can save. They are the same as the command line's.

import type { Pool } from "../workers/pool";
import type { Clip, ClipFrame } from "./clip";
import { offsetOf } from "./glb";

export const fileName = (index: number, extension: string) => `frame_${String(index).padStart(4, "0")}.${extension}`;

export function save(blob: Blob, name: string) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    // The download has its own reference long before this.
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A frame as PLY, which has no textures. It differs from the command line's only in the last digits of normals, which a GLB normalises. */
export async function ply(clip: Clip, frame: ClipFrame, pool: Pool): Promise<Blob> {
    const geometry = await clip.geometry(frame);
    if (geometry.userData.texture) {
        const remedy = "save it as GLB, or reconstruct with the result “Full mesh”, which has colours at its vertices";
        throw new Error(`This mesh has a texture, and PLY files have none: ${remedy}.`);
    }
    const { attributes, index } = geometry;
    return pool.run({
        type: "ply",
        offset: offsetOf(geometry),
        positions: attributes.position.array,
        normals: attributes.normal?.array,
        colours: attributes.color?.array,
        triangles: index?.array,
    });
}
