// Workers, at most one a processor, each with one job at a time.

import type { Stage } from "pcmvs";
import type { Failure, FrameResult, Job, JobResults, Reply, Rung } from "./protocol";

export interface Listener {
    started?(): void;
    progress?(preset: Rung, stage: Stage, done: number, total: number): void;
    result?(result: FrameResult): void;
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
    resolve(value: never): void;
    reject(error: JobError): void;
}

const CANCELLED: Failure = { code: "cancelled", message: "cancelled" };

const start = () => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
const warmed: Worker[] = [];

/** Starts workers ahead: pools that need one find it ready. */
export function warm(count: number) {
    for (let i = 0; i < count; i++) warmed.push(start());
}

export class Pool {
    private readonly waiting: Task[] = [];
    private readonly idle: Worker[] = [];
    private readonly busy = new Map<Worker, Task>();
    /** It has been ended for good. */
    cancelled = false;
    /** Most memory that an instance has had, bytes. */
    memory = 0;

    constructor(readonly size: number) {}

    run<T extends Job>(job: T, listener: Listener = {}): Promise<JobResults[T["type"]]> {
        return new Promise((resolve, reject) => {
            if (this.cancelled) return reject(new JobError(CANCELLED));
            this.waiting.push({ job, listener, resolve, reject });
            this.next();
        });
    }

    /** Ends everything, running or waiting, for good. */
    cancel() {
        this.cancelled = true;
        this.rest();
        const tasks = [...this.busy.values(), ...this.waiting];
        for (const worker of this.busy.keys()) worker.terminate();
        this.busy.clear();
        this.waiting.length = 0;
        for (const task of tasks) task.reject(new JobError(CANCELLED));
    }

    /** Leaves idle workers to other pools. */
    leave() {
        warmed.push(...this.idle.splice(0));
    }

    /** Gives idle workers' memory back. */
    rest() {
        for (const worker of this.idle.splice(0)) worker.terminate();
    }

    private next() {
        while (this.waiting.length > 0 && this.busy.size < this.size) {
            const task = this.waiting.shift() as Task;
            const worker = this.idle.pop() ?? warmed.pop() ?? start();
            worker.onmessage = (event: MessageEvent<Reply>) => this.hear(worker, task, event.data);
            worker.onerror = (event) => {
                event.preventDefault();
                this.hear(worker, task, {
                    type: "failed",
                    failure: {
                        code: "internal",
                        message: event.message || "the worker could not be started: load the page again",
                    },
                });
            };
            this.busy.set(worker, task);
            task.listener.started?.();
            worker.postMessage(task.job);
        }
    }

    private hear(worker: Worker, task: Task, message: Reply) {
        // Messages of an ended worker may still be under way.
        if (this.busy.get(worker) !== task) return;
        switch (message.type) {
            case "progress":
                return task.listener.progress?.(message.preset, message.stage, message.done, message.total);
            case "result":
                return task.listener.result?.(message.result);
            case "done":
                this.memory = Math.max(this.memory, message.memory);
                this.busy.delete(worker);
                this.idle.push(worker);
                task.resolve(message.value as never);
                break;
            case "failed":
                this.busy.delete(worker);
                // After a defect or a lack of memory an instance is in no defined state.
                if (["internal", "out-of-memory"].includes(message.failure.code)) worker.terminate();
                else this.idle.push(worker);
                task.reject(new JobError(message.failure));
        }
        this.next();
    }
}
