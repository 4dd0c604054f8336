// The introduction: what the page is, what to bring, and an example of it.

import { save } from "../clip/exports";
import { Pool } from "../workers/pool";
import type { Entries } from "../workers/protocol";
import { $, button, on } from "./dom";
import { sampleFiles } from "./files";
import { attempt } from "./messages";

/** The address of the repository; null unless the package's description names one, see vite.config.ts. */
declare const __SOURCE__: string | null;

/** The folder in the zip. */
const FOLDER = "pcmvs-example";

/** The sample as a zip, in the form in which people bring their captures. It is made of the files that the page has. */
async function example(): Promise<Blob> {
    const { entries, scene } = await sampleFiles();
    const inFolder: Entries = new Map([...entries].map(([path, entry]) => [`${FOLDER}/${path}`, entry]));
    const text = new Blob([JSON.stringify(scene, null, 2), "\n"]);
    // The page's other worker may be busy with pictures.
    const pool = new Pool(1);
    try {
        const files = [{ name: `${FOLDER}/scene.json`, blob: text }];
        return await pool.run({ type: "zip", files, entries: inFolder });
    } finally {
        pool.leave();
    }
}

/** Folds the introduction away, because a person has brought something. */
export function foldIntroduction() {
    $<HTMLDetailsElement>("intro").open = false;
}

export function listenToIntroduction() {
    on("example", "click", () => {
        button("example").disabled = true;
        void attempt(async () => save(await example(), `${FOLDER}.zip`)).finally(() => {
            button("example").disabled = false;
        });
    });
    if (__SOURCE__ === null) return;
    $("source").setAttribute("href", __SOURCE__);
    $("source").hidden = false;
}
