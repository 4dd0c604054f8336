// GLB files: a mesh as geometry, and the figures in a file's header.

import { BufferAttribute, type BufferGeometry, type Mesh, type MeshBasicMaterial, Quaternion, Vector3 } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import type { DRACOLoader } from "three/addons/loaders/DRACOLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

/** Opens meshes that are compressed with Draco, too. Players of clips, which have none, do without. */
export const openDraco = (draco: DRACOLoader) => loader.setDRACOLoader(draco);

/** "glTF", little-endian. */
const MAGIC = 0x46546c67;
/** Bytes of the file's header and that of its first chunk, which is JSON. */
const HEADERS = 20;

/**
 * The first mesh of a GLB, in the scene's frame: a rotation that makes it upright in glTF's frame is taken back. Positions of
 * an object far from the scene's origin are relative to `userData.offset`, because single precision would spoil its shape.
 * `userData.texture` is its texture, if it has one.
 */
export async function readGeometry(glb: Blob): Promise<BufferGeometry> {
    const { buffers = [], images = [] } = await readJson(glb);
    // A file that names others could make the page read any address.
    if ([...buffers, ...images].some(({ uri }) => uri !== undefined && !/^data:/i.test(uri))) {
        throw new Error("this GLB refers to other files: only files that contain everything are opened");
    }
    const { scene } = await loader.parseAsync(await glb.arrayBuffer(), "");
    let found: Mesh<BufferGeometry> | null = null;
    scene.traverse((object) => {
        if ((object as Mesh).isMesh) found ??= object as Mesh<BufferGeometry>;
    });
    if (!found) throw new Error("this GLB contains no mesh");
    const { geometry, material, position, quaternion, scale } = found as Mesh<BufferGeometry>;
    geometry.userData.offset = position.clone().applyQuaternion(quaternion.clone().invert()).toArray();
    geometry.userData.texture = (material as MeshBasicMaterial).map;
    if (scale.x !== 1) scalePositions(geometry, scale.x);
    return geometry;
}

/** Replaces the integers of a compact file by numbers in the scene's unit. */
function scalePositions(geometry: BufferGeometry, scale: number) {
    const stored = geometry.getAttribute("position");
    const positions = new Float32Array(stored.count * 3);
    for (let i = 0; i < stored.count; i++) {
        positions[3 * i] = stored.getX(i) * scale;
        positions[3 * i + 1] = stored.getY(i) * scale;
        positions[3 * i + 2] = stored.getZ(i) * scale;
    }
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.boundingBox = geometry.boundingSphere = null;
}

/** What must be added to the positions of a geometry. */
export const offsetOf = (geometry: BufferGeometry): Triple => geometry.userData.offset ?? [0, 0, 0];

type Triple = [number, number, number];

/** Directions and positions are in the scene's frame. */
export interface GlbInfo {
    up?: Triple;
    min: number[];
    max: number[];
}

/** The JSON of a GLB. Throws if the file is not a GLB. */
async function readJson(glb: Blob) {
    const head = new DataView(await glb.slice(0, HEADERS).arrayBuffer());
    if (head.byteLength < HEADERS || head.getUint32(0, true) !== MAGIC) throw new Error("this is not a GLB file");
    return JSON.parse(await glb.slice(HEADERS, HEADERS + head.getUint32(12, true)).text());
}

/** Reads a GLB's description without its arrays. Throws if the file is not a GLB. */
export async function inspectGlb(glb: Blob): Promise<GlbInfo> {
    const json = await readJson(glb);
    const primitive = json.meshes?.[0]?.primitives?.[0];
    const position = json.accessors?.[primitive?.attributes?.POSITION];
    if (!position) throw new Error("this GLB contains no mesh");
    const { translation = [0, 0, 0], rotation = [0, 0, 0, 1], scale = [1, 1, 1] } = json.nodes?.[0] ?? {};
    const back = new Quaternion(...rotation).invert();
    const turned = new Vector3(...translation).applyQuaternion(back);
    const up: Triple | undefined = json.scenes?.[0]?.extras?.up;
    const moved = (corner: number[]) => corner.map((v, axis) => v * scale[axis] + turned.getComponent(axis));
    return {
        up: up && new Vector3(...up).applyQuaternion(back).toArray(),
        min: moved(position.min),
        max: moved(position.max),
    };
}
