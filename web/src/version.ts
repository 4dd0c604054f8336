// Set by vite.config.ts when the page is built.
declare const __VERSION__: string;
declare const __SAMPLE_HASH__: string;

/** Version of the library, recorded in exported files. */
export const version = __VERSION__;
/** Hash of the sample's files. As their addresses' query it makes each version of the page fetch its own sample. */
export const sampleHash = __SAMPLE_HASH__;
