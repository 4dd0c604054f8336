// Workers, each with one job at a time.

import type { Stage } from "pcmvs";
import type { Failure, FrameResult, Job, JobResults, QualityLevel, Reply } from "./protocol";

/** Hears of a job that is running. */
export interface Listener {
    progress?(preset: QualityLevel, stage: Stage, done: number, total: number): void;
    result?(result: FrameResult): void;
    /** The number of threads that work on a frame, if there are several. */
    threads?(count: number): void;
    /** The done share of a job that makes no frame, 0 to 1. */
    share?(share: number): void;
}

/** Why a job ended without a result. */
export class JobError extends Error {
    constructor(readonly failure: Failure) {
        super(failure.message);
    }
}

interface Task {
    job: Job;
    listener: Listener;
    /** Hears of threads of the job that fail, for which its worker would wait for ever. */
    failures: BroadcastChannel | null;
    resolve(value: never): void;
    reject(error: JobError): void;
}

const CANCELLED: Failure = { code: "cancelled", message: "cancelled" };

const start = () => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
const warmed: Worker[] = [];

/** Starts workers in advance, so that a pool finds them ready. */
export function warm(count: number) {
    for (let i = 0; i < count; i++) {
        const worker = start();
        // One that cannot be started is left out, so that the pool starts another one and reports why that fails.
        worker.onerror = (event) => {
            event.preventDefault();
            warmed.splice(warmed.indexOf(worker), 1);
        };
        warmed.push(worker);
    }
}

export class Pool {
    private readonly waiting: Task[] = [];
    private readonly idle: Worker[] = [];
    private readonly busy = new Map<Worker, Task>();
    /** Whether it was cancelled; it stays so. */
    cancelled = false;

    /** A pool of at most `size` workers. */
    constructor(private size: number) {}

    /** Allows more workers. */
    grow(size: number) {
        this.size = Math.max(this.size, size);
        this.next();
    }

    run<T extends Job>(job: T, listener: Listener = {}): Promise<JobResults[T["type"]]> {
        return new Promise((resolve, reject) => {
            if (this.cancelled) return reject(new JobError(CANCELLED));
            const task = { job, listener, failures: null, resolve, reject };
            // Meshes are kept until they are averaged and have their form, and so that goes first.
            if (job.type === "steady" || job.type === "form") this.waiting.unshift(task);
            else this.waiting.push(task);
            this.next();
        });
    }

    /** Ends all jobs, running or waiting, and accepts no more. */
    cancel() {
        this.cancelled = true;
        this.rest();
        const tasks = [...this.busy.values(), ...this.waiting];
        // The threads of a worker end with it.
        for (const worker of this.busy.keys()) worker.terminate();
        this.busy.clear();
        this.waiting.length = 0;
        for (const task of tasks) {
            task.failures?.close();
            task.reject(new JobError(CANCELLED));
        }
    }

    /** Gives idle workers to other pools. */
    leave() {
        warmed.push(...this.idle.splice(0));
    }

    /** Ends idle workers, which frees their memory. */
    rest() {
        for (const worker of this.idle.splice(0)) worker.terminate();
    }

    private next() {
        while (this.waiting.length > 0 && this.busy.size < this.size) {
            const task = this.waiting.shift() as Task;
            const worker = this.idle.pop() ?? warmed.pop() ?? start();
            worker.onmessage = (event: MessageEvent<Reply>) => this.onMessage(worker, task, event.data);
            worker.onerror = (event) => {
                event.preventDefault();
                const message = event.message || "the worker cannot be started: load the page again";
                this.onMessage(worker, task, { type: "failed", failure: { code: "internal", message } });
            };
            this.busy.set(worker, task);
            worker.postMessage(task.job);
        }
    }

    private onMessage(worker: Worker, task: Task, message: Reply) {
        // A terminated worker may have sent messages that arrive later.
        if (this.busy.get(worker) !== task) return;
        switch (message.type) {
            case "progress":
                return task.listener.progress?.(message.preset, message.stage, message.done, message.total);
            case "share":
                return task.listener.share?.(message.share);
            case "result":
                return task.listener.result?.(message.result);
            case "threads":
                task.failures = new BroadcastChannel(message.failures);
                task.failures.onmessage = ({ data: failure }: MessageEvent<Failure>) =>
                    this.onMessage(worker, task, { type: "failed", failure });
                return task.listener.threads?.(message.count);
            case "done":
                this.end(worker, task, false);
                task.resolve(message.value as never);
                break;
            case "failed":
                // After a defect or without memory, the state of an instance is undefined.
                this.end(worker, task, ["internal", "out-of-memory"].includes(message.failure.code));
                task.reject(new JobError(message.failure));
        }
        this.next();
    }

    /** Ends a task, and its worker if that cannot be used any more. So are workers with threads, which frees their memory. */
    private end(worker: Worker, task: Task, unusable: boolean) {
        this.busy.delete(worker);
        task.failures?.close();
        if (unusable || task.failures) worker.terminate();
        else this.idle.push(worker);
    }
}
