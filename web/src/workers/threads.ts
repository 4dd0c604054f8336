// The library that a worker reconstructs with: on several threads where they can be started.

import * as plain from "pcmvs";
import type { Reply } from "./protocol";

/** What a reconstruction needs of either module. */
export type Library = Pick<typeof plain, "Frame" | "Rig">;

/**
 * The library on so many threads, or on the calling worker alone where only one is asked for or threads cannot be started.
 * A worker can start threads once.
 */
export async function libraryFor(count: number, send: (message: Reply) => void): Promise<Library> {
    if (count === 1) return plain;
    try {
        const shared = await import("pcmvs/threads");
        const failures = crypto.randomUUID();
        await shared.start(count, failures);
        send({ type: "threads", count: shared.threads(), failures });
        return shared;
    } catch (error) {
        console.warn(`the frame is made on one thread, because threads cannot be started: ${error}`);
        return plain;
    }
}
