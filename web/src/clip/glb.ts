// GLB files: a mesh as geometry, and the figures in a file's header.

import type { BufferGeometry, Mesh } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const loader = new GLTFLoader();
/** "glTF", little-endian. */
const MAGIC = 0x46546c67;
/** Bytes of the file's header and that of its first chunk, which is JSON. */
const HEADERS = 20;

/**
 * The first mesh of a GLB. Positions of an object far from the scene's origin are relative to `userData.offset`, because
 * single precision would spoil its shape.
 */
export async function readGeometry(glb: Blob): Promise<BufferGeometry> {
    const { scene } = await loader.parseAsync(await glb.arrayBuffer(), "");
    let found: BufferGeometry | null = null;
    scene.traverse((object) => {
        if (!(object as Mesh).isMesh || found) return;
        found = (object as Mesh).geometry;
        found.userData.offset = object.position.toArray();
    });
    if (!found) throw new Error("this GLB contains no mesh");
    return found;
}

/** What must be added to the positions of a geometry. */
export const offsetOf = (geometry: BufferGeometry): Triple => geometry.userData.offset ?? [0, 0, 0];

type Triple = [number, number, number];

export interface GlbInfo {
    up?: Triple;
    triangles: number;
    /** In the scene's frame. */
    min: number[];
    max: number[];
}

/** Reads a GLB's description without its arrays. Throws if the file is not a GLB. */
export async function inspectGlb(glb: Blob): Promise<GlbInfo> {
    const head = new DataView(await glb.slice(0, HEADERS).arrayBuffer());
    if (head.byteLength < HEADERS || head.getUint32(0, true) !== MAGIC) throw new Error("this is not a GLB file");
    const json = JSON.parse(await glb.slice(HEADERS, HEADERS + head.getUint32(12, true)).text());
    const primitive = json.meshes?.[0]?.primitives?.[0];
    const position = json.accessors?.[primitive?.attributes?.POSITION];
    if (!position) throw new Error("this GLB contains no mesh");
    const corners = json.accessors[primitive.indices]?.count ?? position.count;
    const offset: number[] = json.nodes?.[0]?.translation ?? [0, 0, 0];
    const moved = (corner: number[]) => corner.map((v, axis) => v + offset[axis]);
    return {
        up: json.scenes?.[0]?.extras?.up,
        triangles: corners / 3,
        min: moved(position.min),
        max: moved(position.max),
    };
}
