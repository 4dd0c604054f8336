// Errors of single frames, with the frame's number in their message.

/** Waits for work on a frame's file. If it fails, the error's message begins with the number of the frame. */
export async function ofFrame<T>(index: number, work: Promise<T>): Promise<T> {
    try {
        return await work;
    } catch (error) {
        // Callers recognise the browser's own errors, such as a cancellation or a full disk, by their type: they pass unchanged.
        if (!(error instanceof Error) || error instanceof DOMException) throw error;
        throw new Error(`frame ${index}: ${error.message}`);
    }
}
