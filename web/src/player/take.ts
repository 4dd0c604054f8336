// A published clip, as its manifest (sequence.json) describes it. Both versions become the same.

import { Quaternion, Vector3 } from "three";

/** A file with some of the frames, in order. */
export interface Segment {
    /** Number of its first frame in the clip. */
    first: number;
    count: number;
    url: string;
    bytes: number;
    /** Whether it is a file of `pcmvs pack`, and not that of a single frame. */
    packed: boolean;
}

export interface Quality {
    name: string;
    /** Bits per second of playing. */
    rate: number;
    /** They follow each other without a gap. */
    segments: Segment[];
}

type Triple = [number, number, number];

export interface Take {
    fps: number;
    /** Numbers of the frames in their capture. */
    indices: number[];
    units: string | null;
    /** In the frame of the files. */
    up: Triple | null;
    /** Quaternion x, y, z, w from the scene's frame to that of the files. */
    rotation: [number, number, number, number] | null;
    /** Of all frames, in the frame of the files. */
    bounds: [Triple, Triple] | null;
    /** From the highest rate to the lowest. */
    qualities: Quality[];
    audio: string | null;
    poster: string | null;
}

/** Larger manifests are not read, bytes. */
const MAX_MANIFEST = 64 << 20;
const MAX_FRAMES = 1_000_000;

/** What is wrong with a clip, in words for the person who looks at it. */
export class ClipError extends Error {}

/** The scene's upward direction in its own frame. */
export function upInScene({ up, rotation }: Take): Triple | undefined {
    if (!up) return undefined;
    if (!rotation) return up;
    return new Vector3(...up).applyQuaternion(new Quaternion(...rotation).invert()).toArray();
}

/** An answer of the host that will not change. */
export class Refused extends ClipError {}

/** Reads the manifest at an address. */
export async function readTake(url: string, signal?: AbortSignal): Promise<Take> {
    const name = fileName(url);
    const response = await get(url, signal);
    if (Number(response.headers.get("content-length")) > MAX_MANIFEST) throw new ClipError(`${name}: is too large`);
    const text = await response.text();
    let json: unknown;
    try {
        json = JSON.parse(text);
    } catch {
        throw new ClipError(`${name}: is not JSON: is this the address of a clip's sequence.json?`);
    }
    try {
        return parseTake(json, response.url || url);
    } catch (error) {
        if (error instanceof ClipError) throw new ClipError(`${name}: ${error.message}`);
        throw error;
    }
}

/** Fetches a file. Errors say which, and what is to be done. */
export async function get(url: string, signal?: AbortSignal, headers: HeadersInit = {}): Promise<Response> {
    let response: Response;
    try {
        response = await fetch(url, { signal, headers });
    } catch (error) {
        if (signal?.aborted) throw error;
        throw new ClipError(
            `${fileName(url)}: cannot be loaded: is the address right, and does its host allow this page to read it (CORS)?`,
        );
    }
    if (!response.ok) throw new Refused(`${fileName(url)}: the host answers ${response.status}`);
    return response;
}

export const fileName = (url: string) => new URL(url).pathname.split("/").at(-1) || url;

/** The clip that a manifest at an address describes. */
export function parseTake(json: unknown, url: string): Take {
    const manifest = object(json, "the manifest");
    const { version } = manifest;
    if (version !== 1 && version !== 2) {
        throw new ClipError(`version ${JSON.stringify(version)} is not known: this player reads versions 1 and 2`);
    }
    const fps = number(manifest.fps, "fps");
    if (!(fps > 0 && fps <= 1000)) throw new ClipError(`fps is ${fps}`);
    const files = version === 1 ? ofFrames(manifest, url, fps) : ofQualities(manifest, url);
    const { indices, qualities } = files;
    if (indices.length === 0) throw new ClipError("the clip has no frames");
    if (manifest.frame_count !== indices.length) {
        throw new ClipError(`frame_count is ${manifest.frame_count}, and ${indices.length} frames are listed`);
    }
    const extra = (key: string) => (manifest[key] ? address(object(manifest[key], key).url, url) : null);
    return {
        fps,
        indices,
        units: typeof manifest.units === "string" ? manifest.units : null,
        up: manifest.up ? (numbers(manifest.up, 3, "up") as Triple) : null,
        rotation: manifest.rotation ? (numbers(manifest.rotation, 4, "rotation") as Take["rotation"]) : null,
        bounds: manifest.bounds
            ? (list(manifest.bounds, "bounds").map((corner) => numbers(corner, 3, "bounds")) as Take["bounds"])
            : null,
        qualities: qualities.sort((a, b) => b.rate - a.rate),
        audio: extra("audio"),
        poster: extra("poster"),
    };
}

type Files = Pick<Take, "indices" | "qualities">;
type Members = Record<string, unknown>;

/** Version 1: a file per frame. */
function ofFrames(manifest: Members, url: string, fps: number): Files {
    const frames = list(manifest.frames, "frames").map((frame) => object(frame, "a frame"));
    const segments = frames.map((frame, first) => ({
        first,
        count: 1,
        url: address(frame.url, url),
        bytes: size(frame.bytes),
        packed: false,
    }));
    const bytes = segments.reduce((sum, segment) => sum + segment.bytes, 0);
    const rate = (8 * bytes * fps) / segments.length;
    return {
        indices: frames.map((frame) => number(frame.index, "a frame's index")),
        qualities: [{ name: "full", rate, segments }],
    };
}

/** Version 2: several qualities, each in files of some frames. */
function ofQualities(manifest: Members, url: string): Files {
    let indices: number[] | null = null;
    const qualities = list(manifest.qualities, "qualities").map((one) => {
        const quality = object(one, "a quality");
        const name = String(quality.name);
        const segments: Segment[] = [];
        const own: number[] = [];
        for (const item of list(quality.segments, "segments")) {
            const segment = object(item, "a segment");
            const numbered = list(segment.frames, "a segment's frames").map((index) =>
                number(index, "a frame's number"),
            );
            if (numbered.length === 0) throw new ClipError(`quality ${name}: a segment has no frames`);
            segments.push({
                first: own.length,
                count: numbered.length,
                url: address(segment.url, url),
                bytes: size(segment.bytes),
                packed: true,
            });
            for (const index of numbered) own.push(index);
        }
        indices ??= own;
        if (own.length !== indices.length || own.some((index, i) => index !== indices?.[i])) {
            throw new ClipError(`quality ${name}: has other frames than the first quality`);
        }
        const bytes = segments.reduce((sum, segment) => sum + segment.bytes, 0);
        return { name, rate: (8 * bytes * number(manifest.fps, "fps")) / Math.max(1, own.length), segments };
    });
    if (!indices) throw new ClipError("the clip has no qualities");
    return { indices, qualities };
}

/**
 * The address of a file that a manifest lists. Files are in the manifest's folder or below: a manifest must not make a page
 * read other addresses, of other hosts or of the same one.
 */
function address(relative: unknown, manifest: string): string {
    if (typeof relative !== "string" || relative === "") throw new ClipError("a file has no url");
    const folder = new URL(".", manifest);
    const found = URL.canParse(relative, folder) ? new URL(relative, folder) : null;
    const inside = found?.origin === folder.origin && found.pathname.startsWith(folder.pathname);
    // Some hosts decode slashes and dots once more.
    if (!found || !inside || /%2e|%2f|%5c|\\/i.test(relative)) {
        throw new ClipError(`${relative} is not in the folder of the manifest: it is not loaded`);
    }
    return found.href;
}

function object(value: unknown, what: string): Members {
    if (typeof value !== "object" || value === null || Array.isArray(value)) throw new ClipError(`${what} is missing`);
    return value as Members;
}

function list(value: unknown, what: string): unknown[] {
    if (!Array.isArray(value)) throw new ClipError(`${what} is missing`);
    if (value.length > MAX_FRAMES) throw new ClipError(`${what} has ${value.length} entries`);
    return value;
}

function number(value: unknown, what: string): number {
    if (typeof value !== "number" || !Number.isFinite(value)) throw new ClipError(`${what} is not a number`);
    return value;
}

function numbers(value: unknown, count: number, what: string): number[] {
    const all = list(value, what).map((one) => number(one, what));
    if (all.length !== count) throw new ClipError(`${what} does not have ${count} numbers`);
    return all;
}

function size(value: unknown): number {
    const bytes = number(value, "bytes");
    if (!Number.isInteger(bytes) || bytes < 20 || bytes > 2 ** 31) throw new ClipError(`a file has ${bytes} bytes`);
    return bytes;
}
