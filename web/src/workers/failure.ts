// Errors as messages to the page.

import type { PcmvsError } from "pcmvs";
import type { Failure } from "./protocol";

/** An error about what the person gave to the page. */
export const inputError = (message: string) => Object.assign(new Error(message), { code: "input" });

/** Whether an instance must not be used after this failure, because its state is undefined. */
export const isFatal = ({ code }: Failure) => code === "out-of-memory" || code === "internal";

export function failureOf(error: unknown): Failure {
    // The library reports its own errors with a code. A trap means that memory could not be allocated.
    if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) {
        const message = "there is not enough memory for this scene: use fewer views or smaller pictures";
        return { code: "out-of-memory", message };
    }
    const {
        code = "internal",
        camera,
        stage,
        position,
        message = String(error),
    } = error as Partial<PcmvsError & { position: number }>;
    return { code, message, camera, stage, position };
}
