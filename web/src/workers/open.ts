// Opens captures.

import { openScene, ready, type Scene } from "pcmvs/scene";
import { inputError } from "./failure";
import type { Entries, Entry } from "./protocol";
import { read } from "./reading";

/**
 * The scene of a capture.
 *
 * The library reads files synchronously, but files in a zip can only be read asynchronously. The library is called again
 * with the files that it asked for, until it asks for no others. It reads few: those of the calibration.
 */
export async function open(entries: Entries): Promise<Scene> {
    await ready;
    const files = new Map<string, Uint8Array>();
    for (;;) {
        const asked = new Set<string>();
        const readKnown = (path: string) => {
            const bytes = files.get(path);
            if (bytes) return bytes;
            asked.add(path);
            throw inputError(`${path} has not been read`);
        };
        try {
            const scene = openScene({ paths: () => [...entries.keys()], read: readKnown });
            if (asked.size === 0) return scene;
        } catch (error) {
            if (asked.size === 0) throw error;
        }
        for (const path of asked) files.set(path, await read(entries.get(path) as Entry));
    }
}
