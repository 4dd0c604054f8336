// A published clip among files that a person has opened.

import { ClipError, parseTake, type Take } from "./take";

/** Stands for the folder of the manifest while its addresses are checked. */
const FOLDER = "https://folder.invalid/";

/** The clip of a manifest of version 2. Its files get addresses of their own, until `revoke` is called. */
export async function localTake(manifest: unknown, path: string, read: (path: string) => Promise<Blob>) {
    const take = parseTake(manifest, FOLDER + path);
    const made = new Map<string, string>();
    const revoke = () => {
        for (const url of made.values()) URL.revokeObjectURL(url);
    };
    const local = async (url: string) => {
        const known = made.get(url);
        if (known) return known;
        const inside = decodeURIComponent(new URL(url).pathname.slice(1));
        const file = await read(inside).catch(() => {
            throw new ClipError(`${inside} is missing: open the folder of the clip as a whole`);
        });
        const address = URL.createObjectURL(file);
        made.set(url, address);
        return address;
    };
    try {
        // There is no network to save: the best quality is the only one.
        const [best] = take.qualities;
        for (const segment of best.segments) segment.url = await local(segment.url);
        const audio = take.audio && (await local(take.audio));
        const whole: Take = { ...take, qualities: [best], audio, poster: null };
        return { take: whole, revoke };
    } catch (error) {
        revoke();
        throw error;
    }
}
