// Where an export is written: into a file on disk, or into memory where the browser gives no access to files.

/** Bytes of an export that is made in memory. */
export const MEMORY_LIMIT = 2 * 2 ** 30;
const LIMIT_TEXT = "2 GiB";

/** Says what went wrong with a file, and what can be done about it. */
export function writeError(error: unknown, name: string): unknown {
    if (!(error instanceof DOMException)) return error;
    const because: Record<string, string> = {
        QuotaExceededError: "the disk is full: free some space, or choose another place",
        NotAllowedError: "the browser may not write here: choose another place, and allow it when it asks",
        NoModificationAllowedError: "another program has the file open: close it, or choose another name",
        NotFoundError: "it was moved or deleted while it was written: export again",
        InvalidStateError: "it was changed while it was written: export again",
    };
    const reason = because[error.name];
    return reason ? new Error(`${name}: ${reason}. Nothing was kept.`) : error;
}

/**
 * Writes a file on disk. The browser puts the file in its place when the stream is closed, so that nobody sees half of it. Errors
 * have messages for the person.
 */
export class FileWriter {
    private constructor(
        private readonly handle: FileSystemFileHandle,
        readonly stream: FileSystemWritableFileStream,
    ) {}

    static async open(handle: FileSystemFileHandle): Promise<FileWriter> {
        try {
            return new FileWriter(handle, await handle.createWritable());
        } catch (error) {
            await removeEmpty(handle);
            throw writeError(error, handle.name);
        }
    }

    /** Discards what has been written. The save dialog has made an empty file, which is removed. */
    async abort() {
        // The stream may have failed already.
        await this.stream.abort().catch(() => {});
        await removeEmpty(this.handle);
    }
}

async function removeEmpty(handle: FileSystemFileHandle & { remove?: () => Promise<void> }) {
    await removeSoon(async () => {
        if ((await handle.getFile()).size === 0) await handle.remove?.();
    });
}

/** Removes a file. The browser may hold it for a moment after writing into it has failed. */
export async function removeSoon(remove: () => Promise<void>) {
    for (let trial = 0; trial < 20; trial++) {
        try {
            return await remove();
        } catch (error) {
            // The file is not there, or the page may not remove it: trying again does not help.
            const held = error instanceof DOMException && error.name === "NoModificationAllowedError";
            if (!held) return;
            await new Promise((resolve) => setTimeout(resolve, 100));
        }
    }
}

/** Takes bytes at any position. */
export interface Sink {
    write(bytes: Uint8Array<ArrayBuffer>, position: number): void;
    /** Waits until all is written. Throws if something could not be. */
    settle(): Promise<void>;
    /** Completes it. What was made in memory is returned. */
    close(): Promise<Blob | null>;
    abort(): Promise<void>;
}

/** Writes into a file on disk. */
export async function fileSink(handle: FileSystemFileHandle): Promise<Sink> {
    const writer = await FileWriter.open(handle);
    let written: Promise<void> = Promise.resolve();
    const settle = () =>
        written.catch((error) => {
            throw writeError(error, handle.name);
        });
    return {
        write(data, position) {
            written = written.then(() => writer.stream.write({ type: "write", data, position }));
            // `settle` and `close` throw the error. Here it only must not count as unhandled.
            written.catch(() => {});
        },
        settle,
        async close() {
            written = written.then(() => writer.stream.close());
            await settle();
            return null;
        },
        abort: () => writer.abort(),
    };
}

/** Bytes of each piece of an export in memory. */
const PIECE = 2 ** 20;

/** Writes into memory. */
export function memorySink(mime: string, limit = MEMORY_LIMIT): Sink {
    const pieces: Uint8Array<ArrayBuffer>[] = [];
    let size = 0;
    return {
        write(bytes, position) {
            size = Math.max(size, position + bytes.length);
            if (size > limit) return;
            for (let at = 0; at < bytes.length; ) {
                const to = position + at;
                const [piece, within] = [Math.floor(to / PIECE), to % PIECE];
                while (pieces.length <= piece) pieces.push(new Uint8Array(PIECE));
                const part = bytes.subarray(at, at + PIECE - within);
                pieces[piece].set(part, within);
                at += part.length;
            }
        },
        async settle() {
            if (size > limit) throw tooLarge();
        },
        async close() {
            if (size > limit) throw tooLarge();
            return new Blob([new Blob(pieces).slice(0, size)], { type: mime });
        },
        async abort() {
            pieces.length = 0;
        },
    };
}

export const tooLarge = () =>
    new Error(
        `this browser writes exports into memory, which holds ${LIMIT_TEXT} of them: export less, or use a browser that ` +
            "writes into files, such as Chrome or Edge. Nothing was kept.",
    );
