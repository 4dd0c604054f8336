/** Version of the library that made what is exported; vite.config.ts reads it from the package. */
export const version = __VERSION__;
declare const __VERSION__: string;
