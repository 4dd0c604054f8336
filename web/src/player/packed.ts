// Takes single frames out of a file of `pcmvs pack`: each becomes a GLB of its own, with the same bytes for its mesh.

import { ClipError } from "./take";

type Json = Record<string, unknown>;
/** Lists of a glTF file whose items refer to each other by number. */
const LISTS = ["meshes", "materials", "textures", "images", "samplers", "accessors", "bufferViews"] as const;
type List = (typeof LISTS)[number];

export type Document = Json & {
    nodes?: Node[];
    scenes?: { nodes?: number[]; extras?: unknown }[];
    buffers?: Json[];
} & {
    [list in List]?: Json[];
};

interface Node extends Json {
    children?: number[];
    mesh?: number;
}

/** A part of the file's binary chunk. */
export interface Piece {
    offset: number;
    length: number;
}

/** The JSON of a frame's own GLB, and the parts of the clip's binary chunk that its own consists of. */
export interface PackedFrame {
    json: Document;
    pieces: Piece[];
}

/** Pieces begin at multiples of so many bytes. */
const ALIGNMENT = 8;
export const align = (bytes: number) => Math.ceil(bytes / ALIGNMENT) * ALIGNMENT;

const NOT_OURS = new ClipError("this is not a file of pcmvs pack");
/** Only the packed file animates which frame is visible. */
const OF_CLIPS = ["KHR_node_visibility", "KHR_animation_pointer"];

/** Number of frames in a packed file. */
export const frameCount = (clip: Document): number => root(clip).children?.length ?? 0;

/** Describes a frame of a packed file. */
export function takeOut(clip: Document, frame: number): PackedFrame {
    const taken = new Taken(clip);
    const { extensions: _, ...own } = ownNode(clip, frame);
    const node = { ...own, mesh: taken.mesh(own.mesh) };
    const extensions = (list: unknown) => (Array.isArray(list) ? list.filter((name) => !OF_CLIPS.includes(name)) : []);
    const [used, required] = [extensions(clip.extensionsUsed), extensions(clip.extensionsRequired)];
    const json: Document = {
        asset: clip.asset,
        ...(used.length > 0 && { extensionsUsed: used }),
        ...(required.length > 0 && { extensionsRequired: required }),
        scene: 0,
        scenes: [{ nodes: [0], ...(clip.scenes?.[0]?.extras !== undefined && { extras: clip.scenes[0].extras }) }],
        nodes: [node],
        ...taken.lists(),
        buffers: (clip.buffers ?? []).map((buffer, i) => (i === 0 ? { ...buffer, byteLength: taken.bytes } : buffer)),
    };
    return { json, pieces: taken.pieces };
}

function root(clip: Document): Node {
    return item(clip.nodes, clip.scenes?.[0]?.nodes?.[0]);
}

/** The node of a frame's own file: the only one below the frame's node that has a mesh. */
function ownNode(clip: Document, frame: number): Node {
    let node = item(clip.nodes, root(clip).children?.[frame]);
    // Two nodes above it scale the frame about its middle.
    for (let depth = 0; depth < 3 && node.mesh === undefined; depth++) node = item(clip.nodes, node.children?.[0]);
    return node;
}

function item<T>(list: T[] | undefined, index: unknown): T {
    const found = typeof index === "number" ? list?.[index] : undefined;
    if (found === undefined) throw NOT_OURS;
    return found;
}

/** What a frame needs of a clip, with new numbers. */
class Taken {
    readonly pieces: Piece[] = [];
    bytes = 0;
    private readonly items = new Map<List, Json[]>(LISTS.map((list) => [list, []]));
    private readonly numbers = new Map<List, Map<unknown, number>>(LISTS.map((list) => [list, new Map()]));

    constructor(private readonly clip: Document) {}

    lists(): Partial<Record<List, Json[]>> {
        return Object.fromEntries([...this.items].filter(([, items]) => items.length > 0));
    }

    mesh(index: unknown): number {
        return this.take("meshes", index, (mesh) => ({
            ...mesh,
            primitives: (mesh.primitives as Json[]).map(this.primitive),
        }));
    }

    private readonly primitive = (primitive: Json): Json => ({
        ...primitive,
        attributes: Object.fromEntries(
            Object.entries(primitive.attributes as Json).map(([name, index]) => [name, this.accessor(index)]),
        ),
        indices: this.accessor(primitive.indices),
        material: this.take("materials", primitive.material, this.material),
    });

    private readonly material = (material: Json): Json => {
        const rough = material.pbrMetallicRoughness as Json;
        const texture = rough?.baseColorTexture as Json | undefined;
        if (!texture) return material;
        const index = this.take("textures", texture.index, (one) => ({
            ...one,
            sampler: this.take("samplers", one.sampler, (sampler) => sampler),
            source: this.take("images", one.source, (image) => ({ ...image, bufferView: this.view(image.bufferView) })),
        }));
        return { ...material, pbrMetallicRoughness: { ...rough, baseColorTexture: { ...texture, index } } };
    };

    private accessor(index: unknown): number {
        return this.take("accessors", index, (accessor) => ({
            ...accessor,
            bufferView: this.view(accessor.bufferView),
        }));
    }

    private view(index: unknown): number {
        return this.take("bufferViews", index, (view) => {
            const extensions = view.extensions as Record<string, Json> | undefined;
            const compressed = extensions?.EXT_meshopt_compression;
            if (!compressed) return { ...view, byteOffset: this.piece(view) };
            const moved = { ...compressed, byteOffset: this.piece(compressed) };
            return { ...view, extensions: { ...extensions, EXT_meshopt_compression: moved } };
        });
    }

    /** Adds bytes of the binary chunk; returns their new place. */
    private piece({ byteOffset = 0, byteLength }: Json): number {
        const place = this.bytes;
        const [offset, length] = [Number(byteOffset), Number(byteLength)];
        if (!(Number.isInteger(offset) && Number.isInteger(length) && offset >= 0 && length >= 0)) throw NOT_OURS;
        this.pieces.push({ offset, length });
        this.bytes += align(length);
        return place;
    }

    private take(list: List, index: unknown, change: (item: Json) => Json): number {
        const numbers = this.numbers.get(list) as Map<unknown, number>;
        const known = numbers.get(index);
        if (known !== undefined) return known;
        const changed = change(item(this.clip[list], index));
        const items = this.items.get(list) as Json[];
        numbers.set(index, items.length);
        items.push(changed);
        return items.length - 1;
    }
}
