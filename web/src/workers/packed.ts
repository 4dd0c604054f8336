// The mesh of a frame alone as blobs, so that the page can hand it on without a copy.

import type { OwnMesh } from "pcmvs";
import type { PackedMesh } from "./protocol";

export function pack({ positions, normals, colours, triangles, ...rest }: OwnMesh): PackedMesh {
    const blob = (array: ArrayBufferView) => new Blob([array as ArrayBufferView<ArrayBuffer>]);
    return {
        positions: blob(positions),
        normals: blob(normals),
        colours: blob(colours),
        triangles: blob(triangles),
        ...rest,
    };
}

export async function unpack({ positions, normals, colours, triangles, ...rest }: PackedMesh): Promise<OwnMesh> {
    return {
        positions: new Float32Array(await positions.arrayBuffer()),
        normals: new Float32Array(await normals.arrayBuffer()),
        colours: new Uint8Array(await colours.arrayBuffer()),
        triangles: new Uint32Array(await triangles.arrayBuffer()),
        ...rest,
    };
}
