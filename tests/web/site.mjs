// The built site on a port of its own, Chromium to look at it, the command line to compare with.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
export const dist = here("../../web/dist");
export const sample = join(dist, "sample");
export const shots = here("shots");
const KINDS = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".css": "text/css",
    ".wasm": "application/wasm",
    ".json": "application/json",
    ".jpg": "image/jpeg",
    ".png": "image/png",
    ".glb": "model/gltf-binary",
};
const FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-quic",
    "--no-first-run",
    "--disable-component-update",
    "--disable-sync",
];

/** Serves folders by their path's first part, without special headers. */
export async function serve(folders) {
    const server = createServer(async (request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
        const mount = Object.keys(folders)
            .filter((m) => path.startsWith(m))
            .sort((a, b) => b.length - a.length)[0];
        try {
            const file = join(folders[mount], path.slice(mount.length) || "index.html");
            response.setHeader("Content-Type", KINDS[extname(file)] ?? "application/octet-stream");
            response.end(await readFile(file));
        } catch {
            response.statusCode = 404;
            response.end();
        }
    });
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

export function launch(more = []) {
    mkdirSync(shots, { recursive: true });
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...FLAGS, ...more] });
}

/** A page that notes whatever goes wrong in it. */
export async function openPage(browser, address, { options = {}, script } = {}) {
    const context = await browser.newContext({
        viewport: { width: 1280, height: 800 },
        acceptDownloads: true,
        ...options,
    });
    const page = await context.newPage();
    const problems = [];
    page.on(
        "console",
        (message) => message.type() === "error" && problems.push(`${message.text()} ${message.location().url}`),
    );
    page.on("pageerror", (error) => problems.push(String(error)));
    if (script) await page.addInitScript(script);
    await page.goto(address);
    return { page, problems, shot: (name) => page.screenshot({ path: join(shots, `${name}.png`) }) };
}

export const ended = (page, timeout = 240_000) =>
    page.waitForFunction(() => ["done", "failed"].includes(document.body.dataset.state), undefined, { timeout });
export const text = (page, id) => page.locator(`#${id}`).innerText();

/** What a click on an export gives. */
export async function download(page, id) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click(`#${id}`)]);
    return readFileSync(await file.path());
}

/** Picks a folder and waits until it is open. */
export async function openFolder(page, folder) {
    await page.setInputFiles("#folder-input", folder);
    await page.waitForFunction(() =>
        /^(Ready|Nothing opened|Clip opened)/.test(document.getElementById("status").textContent),
    );
}

/** Reconstructs as it is set up, to the end. */
export async function run(page) {
    await page.evaluate(() => (document.body.dataset.state = "asked"));
    await page.click("#run");
    await ended(page);
}

/** A browser and the site for a file of tests. */
export function drive() {
    let browser, site;
    before(async () => {
        // Not at the root: the site works from any folder.
        site = await serve({ "/some/where/": dist });
        browser = await launch();
    });
    after(async () => {
        await browser.close();
        site.close();
    });
    /** The page in a test; it is closed when the test ends. `own`: another browser. */
    const open = async (t, { own = browser, ...options } = {}) => {
        const opened = await openPage(own, `${site.address}/some/where/`, options);
        t.after(() => opened.page.context().close());
        return opened;
    };
    /** The page with a capture instead of the sample, and the coarse preset for what does not need the best. */
    const openWith = async (t, folder, options) => {
        const opened = await open(t, options);
        await opened.page.waitForSelector("#cancel:enabled");
        await opened.page.click("#cancel");
        await openFolder(opened.page, folder);
        await opened.page.selectOption("#preset", "hull");
        return opened;
    };
    return { open, openWith };
}

/** Equal bytes, without printing millions of them where they are not. */
export const same = (a, b) => assert.ok(a.equals(b), `${a.length} bytes are not the other ${b.length}`);

/** A pixel's worth of the picture that the view shows now, to see whether it changes. */
export const view = async (page) => (await download(page, "export-png")).toString("base64");

export const pcmvs = (...args) => execFileSync(process.env.PCMVS, args, { stdio: ["ignore", "pipe", "pipe"] });
