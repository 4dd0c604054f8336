// All hosts use this WASI, because the one of Node 20 crashes when the SIMD build reads the large capture.
import { ConsoleStdout, File, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";

/** Runs a compiled program on a folder with the capture alone; its exit status, what it printed and the record it wrote. */
export async function run(compiled, args, bytes) {
    const [capture, record] = args.slice(-2);
    const folder = new PreopenDirectory(".", new Map([[capture, new File(bytes)]]));
    const lines = [];
    const print = () => ConsoleStdout.lineBuffered((line) => lines.push(line));
    const wasi = new WASI(["golden", ...args], [], [new OpenFile(new File([])), print(), print(), folder], {
        debug: false,
    });
    const status = wasi.start(await WebAssembly.instantiate(compiled, { wasi_snapshot_preview1: wasi.wasiImport }));
    const written = folder.dir.contents.get(record);
    return { status, printed: lines.join("\n"), text: written ? new TextDecoder().decode(written.data) : "" };
}
