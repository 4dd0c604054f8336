// Memory of a run, which is reckoned before it starts.

const GIB = 2 ** 30;
/** Bytes that a module of WebAssembly can address. */
const ADDRESSABLE = 4 * GIB;
/** Gigabytes of a machine whose browser does not report them. */
const USUAL = 4;

/** The machine's memory in bytes as the browser reports it, 8 GB at most. Null if the browser does not report it. */
const reported = () => ((navigator as { deviceMemory?: number }).deviceMemory ?? 0) * GIB || null;

/** Number of workers for so many frames, of which each needs so many bytes. Together they get half of the machine's memory. */
export function workersFor(frames: number, bytes: number): number {
    const half = (reported() ?? USUAL * GIB) / 2;
    return Math.max(1, Math.min(navigator.hardwareConcurrency, frames, Math.floor(half / bytes)));
}

/** Why a frame that needs so many bytes cannot be made here, with the remedy; null if it can. */
export function tooLarge(bytes: number, cameras: number): string | null {
    const machine = reported();
    const room = Math.min(machine ?? ADDRESSABLE, ADDRESSABLE);
    if (bytes <= room) return null;
    const size = (bytes: number) => `${(bytes / GIB).toFixed(1)} GB`;
    const reason =
        room === ADDRESSABLE ? `a page can use ${size(room)}` : `this computer has about ${size(room)} of memory`;
    return (
        `A frame of ${cameras} cameras needs about ${size(bytes)}, and ${reason}. ` +
        "Choose fewer views or the quality Preview, make the pictures smaller, or use the command line."
    );
}
