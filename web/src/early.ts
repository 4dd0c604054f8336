// What takes longest to come, asked for before the page itself is read: workers compile while three.js loads.
import { sampleFiles } from "./files";
import { Pool, warm } from "./pool";

warm(2);
/** For what is not a frame: opening, pictures of cameras, exports. */
export const aside = new Pool(1);
export const sample = sampleFiles();
// Told where it is awaited.
sample.catch(() => {});
