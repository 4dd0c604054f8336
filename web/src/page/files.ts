// The files of a capture, as entries by path.
import type { Scene } from "pcmvs";
import { sampleHash } from "../version";
import type { Pool } from "../workers/pool";
import type { Entries } from "../workers/protocol";

const hidden = (path: string) => path.split("/").some((part) => part.startsWith(".") || part === "__MACOSX");

/** The sample, which is on the page's own host. Its scene.json is as the library would return it. */
export async function sampleFiles(): Promise<{ entries: Entries; scene: Scene }> {
    const base = new URL("sample/", document.baseURI);
    const url = (path: string) => new URL(`${path}?${sampleHash}`, base).href;
    const response = await fetch(url("scene.json"));
    if (!response.ok) throw new Error("the sample is missing on this host: drop a capture of your own");
    const scene: Scene = await response.json();
    const entries: Entries = new Map();
    // Workers fetch the pictures, because this thread is busy while the page loads.
    for (const path of scene.frames.flatMap(({ images, masks }) => [...images, ...(masks ?? [])])) {
        if (path !== null) entries.set(path, { kind: "url", url: url(path) });
    }
    return { entries, scene };
}

/** Picked files. Those of a picked folder have paths. */
export function pickedFiles(list: FileList, pool: Pool): Promise<Entries> {
    return unpack(
        [...list].map((file) => [file.webkitRelativePath || file.name, file]),
        pool,
    );
}

/** Dropped files and folders. Must be called while the event is handled. */
export function droppedFiles(transfer: DataTransfer, pool: Pool): Promise<Entries> {
    const roots = [...transfer.items].map((item) => {
        const entry = item.webkitGetAsEntry();
        const file = item.getAsFile();
        // Only files from a disk have an entry.
        return entry ? walk(entry) : Promise.resolve<[string, File][]>(file ? [[file.name, file]] : []);
    });
    return Promise.all(roots).then((found) => unpack(found.flat(), pool));
}

async function walk(entry: FileSystemEntry): Promise<[string, File][]> {
    const path = entry.fullPath.replace(/^\//, "");
    if (hidden(path)) return [];
    if (entry.isFile) {
        const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
        return [[path, file]];
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    const below: FileSystemEntry[] = [];
    for (;;) {
        // Browsers list a folder in portions.
        const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
        if (some.length === 0) break;
        below.push(...some);
    }
    return (await Promise.all(below.map(walk))).flat();
}

async function unpack(files: [string, File][], pool: Pool): Promise<Entries> {
    const entries: Entries = new Map();
    for (const [path, file] of files) {
        if (hidden(path)) continue;
        if (path.toLowerCase().endsWith(".zip")) {
            for (const [inside, entry] of await pool.run({ type: "unzip", zip: file }))
                if (!hidden(inside)) entries.set(inside, entry);
        } else {
            entries.set(path, { kind: "blob", blob: file });
        }
    }
    return entries;
}
