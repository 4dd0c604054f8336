// Zips. Opening one lists what is inside; an entry is unpacked when it is needed.

import {
    BlobReader,
    BlobWriter,
    configure,
    type FileEntry,
    Uint8ArrayWriter,
    ZipReader,
    ZipWriter,
} from "@zip.js/zip.js/lib/zip-core-native.js";
import { inputError } from "./failure";
import type { Entries, Entry, NamedBlob } from "./protocol";

const MAX_ENTRIES = 50_000;
const MAX_BYTES = 8 * 2 ** 30;
/** Pictures hardly compress: a large entry that grows more than this when it is unpacked is a zip bomb. */
const MAX_GROWTH = 200;
const LARGE = 2 ** 20;
/** Compression methods: stored, deflated. */
const STORED = 0;
const METHODS = [STORED, 8];
/** Bytes of the header before each entry, and its first four. */
const LOCAL_HEADER = 30;
const LOCAL_MAGIC = 0x04034b50;

type Listing = Map<string, FileEntry>;

// This module runs in a worker already.
configure({ useWebWorkers: false });

/** Archives that this worker has listed, by their id. */
const listings = new Map<string, Promise<Listing>>();

/** Lists a zip. */
export async function readZip(zip: Blob): Promise<Entries> {
    const id = crypto.randomUUID();
    const paths = [...(await listing(id, zip)).keys()];
    return new Map(paths.map((path) => [path, { kind: "zip", zip, id, path }]));
}

/** Unpacks an entry. */
export async function unpack({ zip, id, path }: Extract<Entry, { kind: "zip" }>): Promise<Uint8Array<ArrayBuffer>> {
    const entry = (await listing(id, zip)).get(path);
    if (!entry) throw inputError(`${path} is missing in the zip`);
    return undamaged(entry.getData(new Uint8ArrayWriter(), { checkCrc32: true }));
}

/** An entry as a file. One that is stored as it is needs no memory: it is a part of the zip. */
export async function fileOf(entry: Extract<Entry, { kind: "zip" }>): Promise<Blob> {
    const { zip, id, path } = entry;
    const found = (await listing(id, zip)).get(path);
    if (found?.compressionMethod !== STORED) return new Blob([await unpack(entry)]);
    const head = new DataView(await zip.slice(found.offset, found.offset + LOCAL_HEADER).arrayBuffer());
    if (head.byteLength < LOCAL_HEADER || head.getUint32(0, true) !== LOCAL_MAGIC) {
        throw inputError(`the zip is damaged at ${path}: copy or export it again`);
    }
    // The lengths of the name and of further fields, which the data follow.
    const start = found.offset + LOCAL_HEADER + head.getUint16(26, true) + head.getUint16(28, true);
    return zip.slice(start, start + found.compressedSize);
}

/** Packs files without compression: meshes hardly compress, and players read stored entries in place. */
export async function writeZip(files: NamedBlob[]): Promise<Blob> {
    const writer = new ZipWriter(new BlobWriter("application/zip"), { level: 0, dataDescriptor: false });
    for (const { name, blob } of files) await writer.add(name, new BlobReader(blob));
    return writer.close();
}

/** The entries of a zip by path. Each worker lists a zip once. */
function listing(id: string, zip: Blob): Promise<Listing> {
    const known = listings.get(id) ?? undamaged(list(zip));
    listings.set(id, known);
    return known;
}

async function list(zip: Blob): Promise<Listing> {
    // Some programs on Windows write backslashes.
    const normalizeFilename = (path: string) => path.replaceAll("\\", "/");
    const files: Listing = new Map();
    let bytes = 0;
    for await (const entry of new ZipReader(new BlobReader(zip)).getEntriesGenerator({ normalizeFilename })) {
        if (entry.directory) continue;
        const { filename, uncompressedSize: size } = entry;
        if (entry.encrypted) throw inputError("this zip is encrypted: unpack it and drop the folder");
        if (!METHODS.includes(entry.compressionMethod)) {
            throw inputError(
                `${filename}: this kind of compression is not supported: unpack the zip and drop the folder`,
            );
        }
        bytes += size;
        const grows = size > LARGE && size > MAX_GROWTH * entry.compressedSize;
        if (grows || bytes > MAX_BYTES || files.size >= MAX_ENTRIES) {
            throw inputError("this zip unpacks to far more than pictures do (a zip bomb): it was not opened");
        }
        files.set(filename, entry);
    }
    return files;
}

/** Adds a remedy to what zip.js reports. */
async function undamaged<T>(work: Promise<T>): Promise<T> {
    try {
        return await work;
    } catch (error) {
        if (!(error instanceof Error) || "code" in error) throw error;
        throw inputError(`the zip is damaged (${error.message}): copy or export it again`);
    }
}
