// Files without EXT_meshopt_compression, which the validator does not know.
import { MeshoptDecoder } from "meshoptimizer/decoder";

const EXTENSION = "EXT_meshopt_compression";
const [HEADER, CHUNK_HEADER] = [12, 8];

/** The same GLB with decompressed buffer views, or null if it has none that are compressed. */
export async function decompressed(glb) {
    await MeshoptDecoder.ready;
    const view = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
    const start = HEADER + CHUNK_HEADER;
    const jsonLength = view.getUint32(HEADER, true);
    const json = JSON.parse(new TextDecoder().decode(glb.subarray(start, start + jsonLength)));
    if (!json.extensionsUsed?.includes(EXTENSION)) return null;
    const stored = glb.subarray(start + jsonLength + CHUNK_HEADER);

    const parts = [];
    let length = 0;
    for (const one of json.bufferViews) {
        const bytes = decoded(one, stored);
        // Attributes begin at multiples of four.
        const padded = new Uint8Array(Math.ceil(bytes.length / 4) * 4);
        padded.set(bytes);
        parts.push(padded);
        Object.assign(one, { buffer: 0, byteOffset: length, byteLength: bytes.length });
        delete one.extensions;
        length += padded.length;
    }
    json.buffers = [{ byteLength: length }];
    for (const key of ["extensionsUsed", "extensionsRequired"]) {
        json[key] = json[key].filter((name) => name !== EXTENSION);
        if (json[key].length === 0) delete json[key];
    }
    return file(json, parts);
}

function decoded(view, stored) {
    const packed = view.extensions?.[EXTENSION];
    const { byteOffset = 0, byteLength } = packed ?? view;
    const source = stored.subarray(byteOffset, byteOffset + byteLength);
    if (!packed) return source;
    const bytes = new Uint8Array(packed.count * packed.byteStride);
    MeshoptDecoder.decodeGltfBuffer(bytes, packed.count, packed.byteStride, source, packed.mode, packed.filter);
    return bytes;
}

function file(json, parts) {
    const text = new TextEncoder().encode(JSON.stringify(json));
    const description = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(32);
    description.set(text);
    const binary = Buffer.concat(parts);
    const header = new Uint32Array([0x46546c67, 2, HEADER + 2 * CHUNK_HEADER + description.length + binary.length]);
    const chunk = (bytes, kind) => [new Uint8Array(new Uint32Array([bytes.length, kind]).buffer), bytes];
    const [JSON_CHUNK, BIN_CHUNK] = [0x4e4f534a, 0x004e4942];
    const chunks = [...chunk(description, JSON_CHUNK), ...chunk(binary, BIN_CHUNK)];
    return new Uint8Array(Buffer.concat([new Uint8Array(header.buffer), ...chunks]));
}
