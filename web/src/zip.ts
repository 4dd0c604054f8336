// Zips, in a worker: the directory says what is inside and where; entries are unpacked when they are wanted.
import { inflateSync } from "fflate";
import type { Entries, Entry } from "./protocol";

const MOST_ENTRIES = 50_000;
const MOST_BYTES = 8 * 2 ** 30;
/** Pictures hardly compress: what grows more than this when unpacked is a bomb. */
const MOST_GROWTH = 200;
const SMALL = 2 ** 20;

const text = new TextDecoder();
const refused = (why: string) => Object.assign(new Error(why), { code: "input" });
const damaged = (why: string) => refused(`the zip is damaged (${why}): copy or export it again`);

export async function readZip(zip: Blob): Promise<Entries> {
    const tail = new DataView(await zip.slice(-65_557).arrayBuffer());
    let end = tail.byteLength - 22;
    while (end >= 0 && tail.getUint32(end, true) !== 0x06054b50) end--;
    if (end < 0) throw damaged("its directory is missing");
    const [count, size, start] = [
        tail.getUint16(end + 10, true),
        tail.getUint32(end + 12, true),
        tail.getUint32(end + 16, true),
    ];
    if (start === 0xffffffff || count === 0xffff)
        throw refused("this zip is of the 64-bit form: drop the unpacked folder instead");
    if (start + size > zip.size) throw damaged("it is truncated");
    const directory = new DataView(await zip.slice(start, start + size).arrayBuffer());
    const entries: Entries = new Map();
    let [at, total] = [0, 0];
    for (let i = 0; i < count; i++) {
        if (at + 46 > size || directory.getUint32(at, true) !== 0x02014b50) throw damaged("its directory is broken");
        const [flags, method] = [directory.getUint16(at + 8, true), directory.getUint16(at + 10, true)];
        const [packed, unpacked] = [directory.getUint32(at + 20, true), directory.getUint32(at + 24, true)];
        const [name, extra, comment] = [28, 30, 32].map((field) => directory.getUint16(at + field, true));
        if (at + 46 + name > size) throw damaged("its directory is broken");
        const path = text.decode(new Uint8Array(directory.buffer, at + 46, name)).replaceAll("\\", "/");
        const offset = directory.getUint32(at + 42, true);
        at += 46 + name + extra + comment;
        if (path.endsWith("/")) continue;
        if (flags & 1) throw refused("this zip is encrypted: unpack it and drop the folder");
        if (method !== 0 && method !== 8)
            throw refused(`${path}: this zip's compression is not known: unpack it and drop the folder`);
        total += unpacked;
        if (
            (unpacked > SMALL && unpacked > MOST_GROWTH * packed) ||
            total > MOST_BYTES ||
            entries.size >= MOST_ENTRIES
        ) {
            throw refused("this zip unpacks to far more than pictures do (a zip bomb): it was not opened");
        }
        entries.set(path, { kind: "zip", zip, offset, packed, size: unpacked, method });
    }
    return entries;
}

/** Reads a local file at once, as only workers may. */
export function bytesOf(blob: Blob): Uint8Array<ArrayBuffer> {
    return new Uint8Array(new FileReaderSync().readAsArrayBuffer(blob));
}

export function unpack({
    zip,
    offset,
    packed,
    size,
    method,
}: Extract<Entry, { kind: "zip" }>): Uint8Array<ArrayBuffer> {
    // The entry's own header repeats its name and may have other extra fields than the directory.
    const header = new DataView(bytesOf(zip.slice(offset, offset + 30)).buffer);
    if (header.byteLength < 30) throw damaged("an entry is not where it should be");
    const start = offset + 30 + header.getUint16(26, true) + header.getUint16(28, true);
    const stored = bytesOf(zip.slice(start, start + packed));
    let data = stored;
    try {
        if (method !== 0) data = inflateSync(stored, { out: new Uint8Array(size) });
    } catch {
        throw damaged("an entry cannot be unpacked");
    }
    if (data.length !== size) throw damaged("an entry is not as long as it claims");
    return data;
}
