// A worker that runs one of the threads of threads.js.
import init, { runThread } from "./pcmvs-threads.js";

self.onmessage = async ({ data: { module, memory, failures } }) => {
    try {
        await init({ module_or_path: module, memory });
    } catch (error) {
        return self.postMessage(String(error));
    }
    self.postMessage(null);
    try {
        // Returns only if the thread fails.
        runThread();
    } catch (error) {
        // A trap means that memory could not be allocated.
        const code = error instanceof WebAssembly.RuntimeError ? "out-of-memory" : "internal";
        const channel = new BroadcastChannel(failures);
        const tell = () => channel.postMessage({ code, message: String(error.message ?? error) });
        tell();
        // Again, because whoever listens may not have begun to. It ends with this worker.
        setInterval(tell, 1000);
    }
};
