// What goes wrong with a frame, told with the frame's number.

/** Adds the number of the frame to what is wrong with its file. */
export async function ofFrame<T>(index: number, work: Promise<T>): Promise<T> {
    try {
        return await work;
    } catch (error) {
        // What the browser itself reports, such as a cancellation, is told by others.
        if (!(error instanceof Error) || error instanceof DOMException) throw error;
        throw new Error(`frame ${index}: ${error.message}`);
    }
}
