// Published clips of the sample, and pages that play them.
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { folder } from "./captures.mjs";
import { dist, launch, openPage, pcmvs, serve } from "./site.mjs";
import { small } from "./small.mjs";
import { wave } from "./wave.mjs";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
export const FPS = 8;
export const COUNT = 8;
/** What a page with strict rules needs to allow. */
const POLICY =
    "default-src 'self'; img-src 'self' blob:; connect-src 'self' blob:; script-src 'self' 'wasm-unsafe-eval' 'nonce-n'; style-src 'self'";
const html = (head, body = "") =>
    `<!doctype html><html lang="en"><title>Clip</title><meta http-equiv="Content-Security-Policy" content="${POLICY}">${head}<body>${body}`;

/** The folder of the clips, the site and a browser, for all tests of a file that imports this one. */
export let root;
export let site;
export let browser;

before(async () => {
    root = folder();
    const web = ["--preset", "hull", "--faces", "3000", "--texture=256", "--compress", "--upright"];
    pcmvs("reconstruct", small, "-o", join(root, "one"), ...web);
    pcmvs("reconstruct", small, "-o", join(root, "mobile"), ...web.with(3, "600").with(4, "--texture=64"));
    const [one, mobile, two, sound] = ["one", "mobile", "two", "sound.wav"].map((name) => join(root, name));
    writeFileSync(
        sound,
        wave(1, 8000, (time) => Math.sin(2 * Math.PI * 440 * time) / 3),
    );
    const more = ["--quality", `mobile=${mobile}`, "--poster", join(small, "images/cam00_0000.jpg")];
    pcmvs("pack", one, "--manifest", "-o", two, ...more, "--segment", "0.25");
    pcmvs("pack", one, "--manifest", "-o", join(root, "parts"), "--segment", "0.25");
    pcmvs("pack", one, "--manifest", "-o", join(root, "whole"));
    pcmvs("pack", one, "--manifest", "-o", join(root, "loud"), "--audio", sound);
    edit("long", (manifest) => {
        // The frames three times, so that not all of them are kept.
        manifest.frames = [0, 1, 2].flatMap(() => manifest.frames).map((frame, index) => ({ ...frame, index }));
        manifest.frame_count = manifest.frames.length;
    });
    writeFileSync(join(root, "element.html"), html('<script type="module" src="/pkg/element.js"></script>'));
    writeFileSync(join(root, "plain.html"), '<!doctype html><script type="module" src="/pkg/element.js"></script>');
    const imports = { three: "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/" };
    const map = `<script type="importmap" nonce="n">${JSON.stringify({ imports })}</script>`;
    writeFileSync(join(root, "three.html"), html(map));
    const plain = folder();
    writeFileSync(join(plain, "favicon.ico"), "");
    site = await serve({
        "/": plain,
        "/site/": root,
        "/pkg/": here("../../wasm/pkg"),
        "/three/": here("../../web/node_modules/three"),
        "/page/": dist,
    });
    browser = await launch();
});
after(async () => {
    await browser.close();
    await site.close();
});

/** A copy of the first clip with another manifest. */
export function edit(name, change, from = "one") {
    cpSync(join(root, from), join(root, name), { recursive: true });
    const path = join(root, name, "sequence.json");
    const manifest = JSON.parse(readFileSync(path, "utf8"));
    change(manifest);
    writeFileSync(path, JSON.stringify(manifest));
}

/** A page with the element, without a clip. */
export async function openElement(t, options) {
    const opened = await openPage(browser, `${site.address}/site/element.html`, options);
    t.after(() => opened.page.context().close());
    await opened.page.waitForFunction(() => customElements.get("pcmvs-player"));
    return opened;
}

/** Adds an element with these attributes, which notes what it shows. */
export const add = (page, attributes) =>
    page.evaluate((attributes) => {
        document.querySelector("pcmvs-player")?.remove();
        const made = document.createElement("pcmvs-player");
        globalThis.shown = [];
        globalThis.heard = [];
        made.addEventListener("frame", ({ detail }) => globalThis.shown.push({ ...detail, playing: !made.paused }));
        for (const name of ["loadedmetadata", "ready", "timeupdate", "play", "pause", "ended", "error"])
            made.addEventListener(name, () => globalThis.heard.push(name));
        for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
        made.style.width = "480px";
        document.body.append(made);
        globalThis.clip = made;
    }, attributes);
export const heard = (page, name) =>
    page.waitForFunction((name) => globalThis.heard.includes(name), name, { timeout: 60_000 });
export const showsFrame = (page, frame) =>
    page.waitForFunction((frame) => globalThis.clip.player.frame === frame, frame, { timeout: 60_000 });
