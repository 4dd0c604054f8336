// Plays a clip in three.js, Babylon.js and <model-viewer> and compares what they show with our own pictures of the same
// meshes: node players.mjs FOLDER. The folder has clip/ (what the command line wrote), view.json (the camera, as
// page/three.js explains it) and ours/ (a picture of every frame, transparent where there is no mesh). forms.mjs says what
// it has for the forms of a mesh.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, openPage, serve } from "../web/site.mjs";
import { alike, flipped, onGreen, ours, overlap, psnr, shown } from "./compare.mjs";
import { folders, lookAtForms, missed } from "./forms.mjs";

const PACKAGES = { three: "three", babylon: "@babylonjs/core", "model-viewer": "@google/model-viewer" };
/** Required overlap of the silhouettes, and PSNR in decibels. */
const OVERLAP = 0.97;
const PSNR = 35;
/** Required PSNR in decibels of a packed clip's picture with that of the frame's own file. */
const ALIKE = 50;
/** Number of pictures taken of a playing clip. */
const LOOKS = 12;
/** Folders of clips with their packed files. */
const PACKED = [
    { folder: "clip", files: ["packed.glb", "visibility.glb"] },
    { folder: "compressed", files: ["packed.glb"] },
];

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const folder = process.argv[2];
const json = (path) => JSON.parse(readFileSync(path));
const [view, clip] = [json(join(folder, "view.json")), json(join(folder, "clip/sequence.json"))];
const pictures = clip.frames.map(({ url }) => ours(readFileSync(join(folder, "ours", url.replace(".glb", ".png")))));
const shots = here("shots");
mkdirSync(shots, { recursive: true });

async function measure(browser, address, player) {
    const { page, problems } = await openPage(browser, `${address}/?player=${player}`);
    await page.waitForFunction(() => window.player);
    await page.evaluate((view) => window.player.open(document.getElementById("stage"), view), view);
    const see = async (background) => {
        await page.evaluate((colour) => (document.body.style.background = colour), background);
        return page.screenshot({ clip: { x: 0, y: 0, width: view.size, height: view.size } });
    };
    const measured = { overlap: 1, psnr: Infinity, mirrored: 0, looks: 1, packed: Infinity };
    for (const [i, { url }] of clip.frames.entries()) {
        await page.evaluate(([url, up]) => window.player.show(`/clip/${url}`, up), [url, clip.up]);
        const [black, white] = [await see("black"), await see("white")];
        writeFileSync(join(shots, `${player}-${i}.png`), white);
        const seen = shown(black, white);
        measured.overlap = Math.min(measured.overlap, overlap(seen, pictures[i]));
        measured.psnr = Math.min(measured.psnr, psnr(seen, pictures[i]));
        measured.mirrored = Math.max(measured.mirrored, ...flipped(seen).map((other) => overlap(other, pictures[i])));
    }
    measured.forms = await lookAtForms(folder, shots, {
        name: player,
        show: (address) => page.evaluate((url) => window.player.show(url, [0, 1, 0]), address),
        see,
    });
    for (const { folder, files } of PACKED)
        measured.packed = Math.min(measured.packed, await packed(page, () => see("white"), folder, files));
    await see("#0f0");
    // Play frame after frame, as fast as they load, while pictures are taken.
    const playing = page.evaluate(
        async ([urls, up]) => {
            const times = [];
            for (let i = 0; !window.looked; i++) {
                const start = performance.now();
                await window.player.show(`/clip/${urls[i % urls.length]}`, up);
                times.push(performance.now() - start);
                await new Promise(requestAnimationFrame);
            }
            return times.sort((a, b) => a - b);
        },
        [clip.frames.map(({ url }) => url), clip.up],
    );
    const seen = new Set();
    for (let i = 0; i < LOOKS; i++) {
        const look = onGreen(await see("#0f0"));
        const overlaps = pictures.map((picture) => overlap(look, picture));
        const best = Math.max(...overlaps);
        seen.add(overlaps.indexOf(best));
        measured.looks = Math.min(measured.looks, best);
    }
    await page.evaluate(() => (window.looked = true));
    const times = await playing;
    await page.close();
    return { ...measured, frames: seen.size, milliseconds: times[times.length >> 1], problems };
}

/** Compares pictures of three moments of packed clips with those of the frames' own files. Returns the least PSNR. */
async function packed(page, see, name, files) {
    const { frames, up, fps } = json(join(folder, name, "sequence.json"));
    const show = (file) => page.evaluate(([url, up]) => window.player.show(url, up), [`/${name}/${file}`, up]);
    const moments = [0, frames.length >> 1, frames.length - 1];
    const own = [];
    for (const i of moments) {
        await show(frames[i].url);
        own.push(await see());
    }
    let least = Infinity;
    for (const file of files) {
        await show(file);
        for (const [k, i] of moments.entries()) {
            await page.evaluate((seconds) => window.player.seek(seconds), (i + 0.5) / fps);
            least = Math.min(least, alike(await see(), own[k]));
        }
    }
    return least;
}

function shortcomings({ overlap, psnr, mirrored, looks, packed, frames, problems, forms }) {
    const wrong = [...problems, ...forms.flatMap(missed)];
    if (!(overlap >= OVERLAP)) wrong.push(`silhouettes overlap by ${overlap.toFixed(3)}, not ${OVERLAP}`);
    if (!(psnr >= PSNR)) wrong.push(`colours are at ${psnr.toFixed(1)} dB, not ${PSNR}`);
    if (!(mirrored < OVERLAP)) wrong.push("the mesh is its own mirror image, and so this does not show where up is");
    if (!(looks >= OVERLAP))
        wrong.push(`while the clip plays, a look overlaps no frame by more than ${looks.toFixed(3)}`);
    if (!(packed >= ALIKE)) wrong.push(`the packed clip is at ${packed.toFixed(1)} dB from its frames, not ${ALIKE}`);
    if (clip.frames.length > 1 && frames < 2) wrong.push("the clip stands still");
    return wrong;
}

const served = (name) => [`/${name}/`, join(folder, name)];
const server = await serve({
    "/": here("page"),
    "/node_modules/": here("node_modules"),
    ...Object.fromEntries([...PACKED.map(({ folder }) => folder), ...folders(folder)].map(served)),
});
const browser = await launch();
try {
    for (const player of Object.keys(PACKAGES)) {
        const measured = await measure(browser, server.address, player);
        const { overlap, mirrored, psnr, looks, packed, frames, milliseconds } = measured;
        const name = `${player} ${json(here(`node_modules/${PACKAGES[player]}/package.json`)).version}`;
        const still = `overlap ${overlap.toFixed(4)} (flipped at most ${mirrored.toFixed(3)}), ${psnr.toFixed(1)} dB`;
        const playing = `playing: overlap ${looks.toFixed(4)}, ${frames} of ${clip.frames.length} frames seen, ${milliseconds.toFixed(0)} ms per frame`;
        const one = `packed: ${packed === Infinity ? "equal pictures" : `${packed.toFixed(1)} dB`}`;
        console.log(`${name}: ${still}; ${playing}; ${one}`);
        for (const form of measured.forms)
            console.log(`  ${form.name}: overlap ${form.overlap.toFixed(4)}, ${form.psnr.toFixed(1)} dB`);
        for (const wrong of shortcomings(measured)) {
            console.log(`  ${wrong}`);
            process.exitCode = 1;
        }
    }
} finally {
    await browser.close();
    server.close();
}
