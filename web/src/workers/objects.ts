// Objects of the library, which hold memory of a module's instance.

import { failureOf, isFatal } from "./failure";

/** Works with an object of the library, then frees it. After a fatal failure nothing is freed: the whole worker is ended. */
export async function using<O extends { free(): void }, T>(object: O, work: (object: O) => Promise<T>): Promise<T> {
    try {
        const made = await work(object);
        object.free();
        return made;
    } catch (error) {
        if (!isFatal(failureOf(error))) object.free();
        throw error;
    }
}
