// Opens meshes that other programs have compressed with Draco (KHR_draco_mesh_compression). The decoder, 73 KiB by gzip, is
// loaded with the first such mesh.

import { BufferAttribute, BufferGeometry } from "three";
import wasm from "three/addons/libs/draco/gltf/draco_decoder.wasm?url";
import script from "three/addons/libs/draco/gltf/draco_wasm_wrapper.js?url";
import type { DRACOLoader } from "three/addons/loaders/DRACOLoader.js";

/** What is used of the decoder. Pointers are addresses in its memory. */
interface Decoder {
    HEAPU8: Uint8Array;
    DT_INT8: number;
    DT_UINT8: number;
    DT_INT16: number;
    DT_UINT16: number;
    DT_UINT32: number;
    DT_FLOAT32: number;
    Decoder: new () => {
        DecodeArrayToMesh(data: Int8Array, bytes: number, mesh: Mesh): { ok(): boolean; error_msg(): string };
        GetTrianglesUInt32Array(mesh: Mesh, bytes: number, to: number): boolean;
        GetAttributeByUniqueId(mesh: Mesh, id: number): { ptr: number; num_components(): number };
        GetAttributeDataArrayForAllPoints(
            mesh: Mesh,
            attribute: object,
            type: number,
            bytes: number,
            to: number,
        ): boolean;
    };
    Mesh: new () => Mesh;
    destroy(object: object): void;
    _malloc(bytes: number): number;
    _free(pointer: number): void;
}

interface Mesh {
    num_faces(): number;
    num_points(): number;
}

/** The types of numbers in glTF, as GLTFLoader and the decoder name them. */
const TYPES = {
    Int8Array: [Int8Array, "DT_INT8"],
    Uint8Array: [Uint8Array, "DT_UINT8"],
    Int16Array: [Int16Array, "DT_INT16"],
    Uint16Array: [Uint16Array, "DT_UINT16"],
    Uint32Array: [Uint32Array, "DT_UINT32"],
    Float32Array: [Float32Array, "DT_FLOAT32"],
} as const;
type TypeName = keyof typeof TYPES;

/** Set by the decoder's script. */
declare const DracoDecoderModule: (options: { wasmBinary: ArrayBuffer }) => Promise<Decoder>;

let decoder: Promise<Decoder> | null = null;

/** Loads the decoder: its script, which sets a variable, and its module. If that fails, the next mesh tries again. */
async function load(): Promise<Decoder> {
    const element = document.createElement("script");
    element.src = script;
    const loaded = new Promise<boolean>((resolve) => {
        element.onload = () => resolve(true);
        element.onerror = () => resolve(false);
    });
    document.head.append(element);
    const [response, isLoaded] = await Promise.all([fetch(wasm), loaded]);
    element.remove();
    if (!isLoaded || !response.ok) throw new Error("the decoder of Draco cannot be loaded: check the connection");
    return DracoDecoderModule({ wasmBinary: await response.arrayBuffer() });
}

/** The geometry of a compressed mesh, with its attributes' numbers in the file, and their types. Throws if it is damaged. */
function decoded(
    draco: Decoder,
    data: ArrayBuffer,
    attributes: Record<string, number>,
    types: Record<string, TypeName>,
): BufferGeometry {
    const reader = new draco.Decoder();
    const mesh = new draco.Mesh();
    /** As many bytes as `write` writes. */
    const read = (bytes: number, write: (bytes: number, to: number) => boolean): ArrayBuffer => {
        const pointer = draco._malloc(bytes);
        try {
            if (!write(bytes, pointer)) throw new Error("this GLB is damaged: it has fewer numbers than it says");
            return draco.HEAPU8.slice(pointer, pointer + bytes).buffer as ArrayBuffer;
        } finally {
            draco._free(pointer);
        }
    };
    try {
        const status = reader.DecodeArrayToMesh(new Int8Array(data), data.byteLength, mesh);
        if (!status.ok()) throw new Error(`this GLB is damaged: ${status.error_msg()}`);
        const geometry = new BufferGeometry();
        const corners = read(12 * mesh.num_faces(), (bytes, to) => reader.GetTrianglesUInt32Array(mesh, bytes, to));
        geometry.setIndex(new BufferAttribute(new Uint32Array(corners), 1));
        for (const [name, id] of Object.entries(attributes)) {
            const attribute = reader.GetAttributeByUniqueId(mesh, id);
            if (attribute.ptr === 0) throw new Error(`this GLB is damaged: its mesh has no ${name}`);
            const components = attribute.num_components();
            const [Numbers, type] = TYPES[types[name]];
            const bytes = Numbers.BYTES_PER_ELEMENT * components * mesh.num_points();
            const numbers = read(bytes, (bytes, to) =>
                reader.GetAttributeDataArrayForAllPoints(mesh, attribute, draco[type], bytes, to),
            );
            geometry.setAttribute(name, new BufferAttribute(new Numbers(numbers), components));
        }
        return geometry;
    } finally {
        draco.destroy(mesh);
        draco.destroy(reader);
    }
}

/** What GLTFLoader asks of a DRACOLoader. That of three.js needs workers of scripts in memory, which the page's policy forbids. */
export const draco = {
    preload() {
        return draco;
    },
    async decodeDracoFile(
        data: ArrayBuffer,
        done: (geometry: BufferGeometry) => void,
        attributes: Record<string, number>,
        types: Record<string, TypeName>,
        _colours: unknown,
        failed: (error: unknown) => void,
    ) {
        decoder ??= load();
        try {
            done(decoded(await decoder, data, attributes, types));
        } catch (error) {
            if (!(await decoder.catch(() => null))) decoder = null;
            failed(error);
        }
    },
} as unknown as DRACOLoader;
