// Reads entries, wherever they are.

import { inputError } from "./failure";
import type { Entry, ViewFiles } from "./protocol";

/** Files fetched for a sketch. The other levels of the same frame need them, too. */
const fetched = new Map<string, Uint8Array<ArrayBuffer>>();

export const forgetFetched = () => fetched.clear();

/** zip.js is large, and a worker needs it only for zips. */
export const loadZip = () => import("./zip");

export async function read(entry: Entry): Promise<Uint8Array<ArrayBuffer>> {
    switch (entry.kind) {
        case "blob":
            return new Uint8Array(await entry.blob.arrayBuffer());
        case "zip":
            return (await loadZip()).unpack(entry);
        case "url":
            return fetched.get(entry.url) ?? download(entry.url);
    }
}

/** An entry as a file, whose bytes are read when they are needed. */
export async function fileOf(entry: Entry): Promise<Blob> {
    if (entry.kind === "blob") return entry.blob;
    if (entry.kind === "zip") return (await loadZip()).fileOf(entry);
    return new Blob([await read(entry)]);
}

async function download(url: string): Promise<Uint8Array<ArrayBuffer>> {
    const response = await fetch(url);
    if (!response.ok) throw inputError(`${url}: the server answers ${response.status}: load the page again`);
    const bytes = new Uint8Array(await response.arrayBuffer());
    fetched.set(url, bytes);
    return bytes;
}

/** Reads a camera's picture, if it has one, and its mask, if that is used. */
export async function readView(view: ViewFiles): Promise<{ image: Uint8Array | null; mask: Uint8Array | null }> {
    if (!view.image) return { image: null, mask: null };
    const mask = view.mask && !view.key ? read(view.mask) : null;
    return { image: await read(view.image), mask: await mask };
}
