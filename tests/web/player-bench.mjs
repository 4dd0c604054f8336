// Prints the player's table of BENCHMARKS.md: 300 frames of 20,000 triangles, those of the sample repeated.
import { cpSync, existsSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { folder } from "./captures.mjs";
import { residentMemory } from "./measure.mjs";
import { launch, openPage, pcmvs, sample, serve } from "./site.mjs";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const FORM = ["--faces", "20000", "--texture=1024", "--compress", "--upright"];
const FRAMES = 300;
const FPS = 30;
const TIMES = 2;

/** The clips, by what is measured: a file per frame, and segments of two seconds. */
function clips(root) {
    const made = here("../../target/player-clip");
    if (!existsSync(join(made, "sequence.json"))) pcmvs("reconstruct", sample, "-o", made, ...FORM);
    const manifest = JSON.parse(readFileSync(join(made, "sequence.json"), "utf8"));
    const [one, two] = ["one", "two"].map((name) => join(root, name));
    cpSync(made, one, { recursive: true });
    const name = (index) => `frame_${String(index).padStart(4, "0")}.glb`;
    manifest.frames = Array.from({ length: FRAMES }, (_, index) => {
        const frame = manifest.frames[index % manifest.frames.length];
        if (index >= manifest.frames.length) cpSync(join(made, frame.url), join(one, name(index)));
        return { ...frame, index, time: index / FPS, url: name(index) };
    });
    Object.assign(manifest, { fps: FPS, frame_count: FRAMES });
    writeFileSync(join(one, "sequence.json"), JSON.stringify(manifest));
    pcmvs("pack", one, "--manifest", "-o", two, "--segment", "2");
    const bytes = manifest.frames.reduce((sum, frame) => sum + frame.bytes, 0) / FRAMES;
    return { bytes, paths: { "a file per frame": "one", "segments of 2 s": "two" } };
}

/** Plays a clip in a new browser: the first picture, one loop, and memory over ten loops. */
async function play(address, path, long) {
    const browser = await launch();
    const { page, problems } = await openPage(browser, `${address}/site/player.html`);
    await page.waitForFunction(() => customElements.get("pcmvs-player"));
    const used = await residentMemory(browser, page);
    const empty = long ? await used() : 0;
    const first = await page.evaluate(async (src) => {
        const clip = document.createElement("pcmvs-player");
        for (const [name, value] of Object.entries({ src, autoplay: "", loop: "" })) clip.setAttribute(name, value);
        clip.style.width = "640px";
        globalThis.clip = clip;
        const start = performance.now();
        const ready = new Promise((resolve) => clip.addEventListener("ready", resolve));
        document.body.append(clip);
        await ready;
        await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
        return (performance.now() - start) / 1000;
    }, `${path}/sequence.json`);
    const loops = (count) =>
        page.evaluate(async (count) => {
            const { clip } = globalThis;
            let [last, seen] = [clip.currentTime, 0];
            while (seen < count) {
                await new Promise(requestAnimationFrame);
                if (clip.currentTime < last) seen++;
                last = clip.currentTime;
            }
            return { shown: clip.shownFrames, dropped: clip.droppedFrames };
        }, count);
    const { shown, dropped } = await loops(1);
    const memory = [];
    if (long) {
        await page.evaluate(() => (globalThis.clip.player.rate = 4));
        for (const count of [1, 9]) {
            await loops(count);
            memory.push(((await used()) - empty) / 2 ** 20);
        }
    }
    await browser.close();
    if (problems.length > 0) throw new Error(problems.join("\n"));
    return { first, shown, dropped, memory };
}

const root = folder();
writeFileSync(join(root, "player.html"), '<!doctype html><script type="module" src="/pkg/element.js"></script>');
writeFileSync(join(root, "favicon.ico"), "");
const row = (...cells) => console.log(`| ${cells.join(" | ")} |`);
row(`${FRAMES} frames`, "fps", "first picture, s", "shown", "dropped", "memory, MiB: after 2 loops", "after 11");
console.log("|---|---:|---:|---:|---:|---:|---:|");
const { bytes, paths } = clips(root);
const site = await serve({ "/site/": root, "/pkg/": here("../../wasm/pkg"), "/": root });
for (const [name, path] of Object.entries(paths)) {
    const runs = [];
    for (let i = 0; i < TIMES; i++) runs.push(await play(site.address, path, i === 0));
    const { memory } = runs[0];
    const best = runs.sort((a, b) => a.dropped - b.dropped)[0];
    const first = Math.min(...runs.map((run) => run.first)).toFixed(2);
    const [few, many] = memory.map((value) => value.toFixed(0));
    row(`${name}, ${Math.round(bytes / 1e3)} KB per frame`, FPS, first, best.shown, best.dropped, few, many);
}
await site.close();
rmSync(root, { recursive: true });
