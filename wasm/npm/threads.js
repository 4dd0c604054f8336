// Reconstruction on several threads: workers that share the memory of one instance. It gives the bytes of index.js.
import init, { startThreads } from "./pcmvs-threads.js";

export * from "./pcmvs-threads.js";

/** The memory may be shared only on pages that are isolated from other origins. */
export const supported = globalThis.crossOriginIsolated === true && typeof SharedArrayBuffer === "function";

/** Starts an instance whose first thread is the calling worker. Resolves when everything may be called. */
export async function start(count, failures) {
    const response = await fetch(new URL("./pcmvs-threads.wasm", import.meta.url));
    if (!response.ok) throw new Error(`${response.url}: the server answers ${response.status}`);
    const module = await WebAssembly.compile(await response.arrayBuffer());
    const { memory } = await init({ module_or_path: module });
    startThreads(count);
    const workers = [];
    try {
        await Promise.all(Array.from({ length: count - 1 }, () => startWorker(workers, { module, memory, failures })));
    } catch (error) {
        for (const worker of workers) worker.terminate();
        throw error;
    }
}

/** Resolves when a further worker runs a thread. */
function startWorker(workers, message) {
    const worker = new Worker(new URL("./thread.js", import.meta.url), { type: "module" });
    workers.push(worker);
    return new Promise((resolve, reject) => {
        worker.onmessage = ({ data: failure }) => (failure ? reject(new Error(failure)) : resolve());
        worker.onerror = (event) => {
            event.preventDefault();
            reject(new Error(event.message || "a worker cannot be started"));
        };
        worker.postMessage(message);
    });
}
