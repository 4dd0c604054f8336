export * from "./pcmvs.js";

/** Whether the page is isolated from other origins, without which no memory is shared. */
export const supported: boolean;

/** The number of threads on which this instance reconstructs. */
export function threads(): number;

/** What a thread that has failed posts to the channel. */
export interface ThreadFailure {
    code: "internal" | "out-of-memory";
    message: string;
}

/**
 * Starts an instance with so many threads. The calling worker is the first of them, and the others are workers that it
 * starts and that end with it. Resolves when everything may be called. Call it once per worker.
 *
 * If a thread fails, the calling worker waits for it for ever. What has failed is then posted every second to the
 * `BroadcastChannel` with the name `failures`, so that whoever listens there can end the calling worker.
 */
export function start(count: number, failures: string): Promise<void>;
