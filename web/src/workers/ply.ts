// A mesh as binary PLY, in the same layout as the command line's.

import { version } from "../version";
import type { PlyInput } from "./protocol";

const properties = (type: string, names: string[]) => names.map((name) => `property ${type} ${name}\n`);

export function writePly({ offset, positions, normals, colours, triangles }: PlyInput): ArrayBuffer {
    const vertices = positions.length / 3;
    const corners = triangles ?? Array.from({ length: vertices }, (_, i) => i);
    // An object far from the scene's origin has an offset. Single precision would spoil its shape.
    const far = offset.some((v) => v !== 0);
    const layout = [
        ...properties(far ? "double" : "float", ["x", "y", "z"]),
        ...(normals ? properties("float", ["nx", "ny", "nz"]) : []),
        ...(colours ? properties("uchar", ["red", "green", "blue"]) : []),
    ];
    const header = new TextEncoder().encode(
        `ply\nformat binary_little_endian 1.0\ncomment pcmvs ${version}\nelement vertex ${vertices}\n${layout.join("")}` +
            `element face ${corners.length / 3}\nproperty list uchar uint vertex_indices\nend_header\n`,
    );
    const row = (far ? 24 : 12) + (normals ? 12 : 0) + (colours ? 3 : 0);
    const out = new ArrayBuffer(header.length + vertices * row + (corners.length / 3) * 13);
    new Uint8Array(out).set(header);
    const view = new DataView(out);
    let at = header.length;
    const floats = (from: ArrayLike<number>, i: number) => {
        for (let k = 0; k < 3; k++, at += 4) view.setFloat32(at, from[3 * i + k], true);
    };
    const channels = (colours?.length ?? 0) / vertices;
    const one = colours instanceof Uint8Array ? 255 : colours instanceof Uint16Array ? 65535 : 1;
    for (let i = 0; i < vertices; i++) {
        if (far) for (let k = 0; k < 3; k++, at += 8) view.setFloat64(at, offset[k] + positions[3 * i + k], true);
        else floats(positions, i);
        if (normals) floats(normals, i);
        if (colours) for (let k = 0; k < 3; k++) view.setUint8(at++, srgb(colours[channels * i + k] / one));
    }
    for (let i = 0; i < corners.length; i += 3) {
        view.setUint8(at++, 3);
        for (let k = 0; k < 3; k++, at += 4) view.setUint32(at, corners[i + k], true);
    }
    return out;
}

/** The sRGB code of linear light, IEC 61966-2-1. */
function srgb(linear: number): number {
    return Math.round(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055));
}
