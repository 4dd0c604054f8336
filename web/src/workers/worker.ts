// A worker: reads files, decodes, reconstructs. It does one job at a time; the page cancels a job by terminating it.
//
// Every worker loads the module for reconstruction when it starts, so that it is compiled when a job comes. The modules for
// calibration, for forms and for opening captures are loaded by the first job that needs them.

import { ready } from "pcmvs";
import { failureOf } from "./failure";
import { memoryOf } from "./frame";
import { photograph } from "./photograph";
import { writePly } from "./ply";
import type { Entries, Job, Reply } from "./protocol";
import { fileOf, forgetFetched, loadZip } from "./reading";
import { reconstruct } from "./reconstruct";
import { steady } from "./steady";

const scope = self as unknown as DedicatedWorkerGlobalScope;
const send = (message: Reply, transfer: Transferable[] = []) => scope.postMessage(message, transfer);

scope.onmessage = async (event: MessageEvent<Job>) => {
    const job = event.data;
    try {
        await ready;
        const [value, transfer] = await run(job);
        send({ type: "done", value }, transfer);
    } catch (error) {
        send({ type: "failed", failure: failureOf(error) });
    } finally {
        if (!(job.type === "frame" && job.levels.at(-1) === "sketch")) forgetFetched();
    }
};

/** Does a job; returns its result and what of it is transferred instead of copied. */
async function run(job: Job): Promise<[unknown, Transferable[]]> {
    switch (job.type) {
        case "open":
            return [await (await import("./open")).open(job.entries), []];
        case "memory":
            return [memoryOf(job.cameras, job.preset, job.between), []];
        case "frame":
            await reconstruct(job, send);
            return [null, []];
        case "steady": {
            const result = await steady(job, send);
            return [result, result.glb ? [result.glb.buffer] : []];
        }
        case "form": {
            const result = await (await import("./form")).form(job, send);
            return [result, [result.glb.buffer]];
        }
        case "photograph": {
            const result = await photograph(job);
            return [result, result.silhouette ? [result.picture, result.silhouette] : [result.picture]];
        }
        case "calibrate":
            return [await (await import("./calibrate")).calibrate(job, send), []];
        case "file":
            return [await fileOf(job.entry), []];
        case "unzip":
            return [await (await loadZip()).readZip(job.zip), []];
        case "ply":
            return [new Blob([writePly(job)], { type: "application/octet-stream" }), []];
        case "zip":
            return [await (await loadZip()).writeZip([...job.files, ...(await files(job.entries))]), []];
        case "digest":
            return [await Promise.all(job.blobs.map(sha256)), []];
    }
}

/** Reads entries. */
const files = (entries: Entries = new Map()) =>
    Promise.all([...entries].map(async ([name, entry]) => ({ name, blob: await fileOf(entry) })));

async function sha256(blob: Blob): Promise<string> {
    const hash = await crypto.subtle.digest("SHA-256", await blob.arrayBuffer());
    return Array.from(new Uint8Array(hash), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
