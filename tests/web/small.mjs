// The sample with pictures of half its width and height, which most tests use: all work takes a third to half of the time.
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, sample } from "./site.mjs";

const json = readFileSync(join(sample, "scene.json"), "utf8");
const scene = JSON.parse(json);
const paths = scene.frames.flatMap(({ images, masks }) => [...images, ...masks]);

/** Its folder. It is made once, and made again when the sample or this file has changed. */
export const small = await make();

async function make() {
    const hash = createHash("sha256")
        .update(json)
        .update(readFileSync(fileURLToPath(import.meta.url)));
    for (const path of paths) hash.update(readFileSync(join(sample, path)));
    const cache = fileURLToPath(new URL("node_modules/.cache", import.meta.url));
    const made = join(cache, `small-${hash.digest("hex").slice(0, 12)}`);
    if (existsSync(made)) return made;
    mkdirSync(cache, { recursive: true });
    // Two files of tests may begin at the same time: whichever is first gives the folder its name.
    const to = mkdtempSync(join(cache, "new-"));
    await fill(to);
    try {
        renameSync(to, made);
    } catch (error) {
        if (!existsSync(made)) throw error;
        rmSync(to, { recursive: true });
    }
    return made;
}

async function fill(to) {
    for (const kind of ["images", "masks"]) mkdirSync(join(to, kind));
    const browser = await launch();
    const page = await browser.newPage();
    for (let at = 0; at < paths.length; at += 40) {
        const some = paths.slice(at, at + 40);
        const files = some.map((path) => readFileSync(join(sample, path)).toString("base64"));
        const halves = await page.evaluate(halve, files);
        for (const [i, path] of some.entries()) writeFileSync(join(to, path), Buffer.from(halves[i], "base64"));
    }
    await browser.close();
    const cameras = scene.cameras.map(({ K: [[fx, , cx], [, fy, cy]], width, height, ...rest }) => ({
        ...rest,
        width: width / 2,
        height: height / 2,
        // The middle of a picture's first pixel is at 0.
        K: [
            [fx / 2, 0, (cx + 0.5) / 2 - 0.5],
            [0, fy / 2, (cy + 0.5) / 2 - 0.5],
            [0, 0, 1],
        ],
    }));
    writeFileSync(join(to, "scene.json"), JSON.stringify({ ...scene, cameras }));
}

/** Scales pictures, which a page does: JPEG stays JPEG, and PNG stays PNG. */
async function halve(files) {
    const halves = [];
    for (const file of files) {
        const type = file.startsWith("/9j/") ? "image/jpeg" : "image/png";
        const bytes = Uint8Array.from(atob(file), (letter) => letter.charCodeAt(0));
        const whole = await createImageBitmap(new Blob([bytes], { type }));
        const canvas = new OffscreenCanvas(whole.width / 2, whole.height / 2);
        const context = canvas.getContext("2d", { willReadFrequently: true });
        context.imageSmoothingQuality = "high";
        context.drawImage(whole, 0, 0, canvas.width, canvas.height);
        whole.close();
        const half = new Uint8Array(await (await canvas.convertToBlob({ type, quality: 0.92 })).arrayBuffer());
        halves.push(btoa(String.fromCharCode.apply(null, half)));
    }
    return halves;
}
