// The built site on its own port, Chromium to look at it, and the command line to compare with.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { preview } from "vite";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
export const dist = here("../../web/dist");
export const sample = join(dist, "sample");
export const shots = here("shots");
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

const ISOLATION = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Embedder-Policy": "credentialless",
};

/**
 * Serves folders by Vite's preview server. Keys are paths that end with a slash. With `isolated` the responses have the
 * headers with which memory may be shared between workers, otherwise none but the usual ones. Without `port` it is any free one.
 *
 * Preview serves one folder, and so this is a folder of links.
 */
export async function serve(folders, isolated = false, port = 0) {
    const root = mkdtempSync(join(tmpdir(), "pcmvs-site-"));
    for (const [path, folder] of Object.entries(folders)) {
        const link = join(root, path.slice(0, -1));
        mkdirSync(dirname(link), { recursive: true });
        if (path !== "/") symlinkSync(resolve(folder), link);
        else for (const name of readdirSync(folder)) symlinkSync(resolve(folder, name), join(root, name));
    }
    const server = await preview({
        configFile: false,
        root,
        // Paths other than those of files are errors.
        appType: "mpa",
        logLevel: "error",
        build: { outDir: root },
        preview: { host: "127.0.0.1", port, headers: isolated ? ISOLATION : {} },
    });
    return {
        address: `http://127.0.0.1:${server.httpServer.address().port}`,
        close: async () => {
            await server.close();
            rmSync(root, { recursive: true, force: true });
        },
    };
}

export function launch(more = []) {
    mkdirSync(shots, { recursive: true });
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...FLAGS, ...more] });
}

/** Nobody answers the questions of file pickers. Without them the page saves downloads. */
const NO_PICKERS = () => Object.assign(window, { showSaveFilePicker: undefined, showDirectoryPicker: undefined });

/**
 * A script for pages that replaces what the graphics processor says: while `hold(true)` holds, no drawing is finished.
 * `drawings` counts those since the last `hold`.
 */
export function slowGraphics() {
    const { prototype } = WebGL2RenderingContext;
    const { getSyncParameter, clear } = prototype;
    let held = false;
    globalThis.hold = (on) => {
        held = on;
        globalThis.drawings = 0;
    };
    prototype.getSyncParameter = function (fence, name) {
        return held ? this.UNSIGNALED : getSyncParameter.call(this, fence, name);
    };
    // Every drawing begins with an empty picture.
    prototype.clear = function (...buffers) {
        globalThis.drawings++;
        clear.apply(this, buffers);
    };
}

/** A page, and a list of the errors that occur in it. `pickers` replaces the browser's, and gets `disk`. */
export async function openPage(browser, address, { options = {}, script, pickers = NO_PICKERS, disk, prepare } = {}) {
    const context = await browser.newContext({
        // Pictures are drawn by software, and small ones take less time.
        viewport: { width: 960, height: 600 },
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
    await page.addInitScript(pickers, disk);
    if (script) await page.addInitScript(script);
    await prepare?.(page);
    await page.goto(address);
    // Pictures for people, who ask for them by setting SHOTS.
    const shot = async (name) => process.env.SHOTS && page.screenshot({ path: join(shots, `${name}.png`) });
    return { page, problems, shot };
}

export const ended = (page, timeout = 240_000) =>
    page.waitForFunction(() => ["done", "failed"].includes(document.body.dataset.state), undefined, { timeout });
export const text = (page, id) => page.locator(`#${id}`).innerText();

/** The file that an export button saves. */
export async function download(page, id) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click(`#${id}`)]);
    return readFileSync(await file.path());
}

/** Opens a folder through the file picker, and waits for a status that begins with one of those `wanted`. */
export async function openFolder(page, folder, wanted = /^(Ready|Clip opened)/) {
    await page.setInputFiles("#folder-input", folder);
    await page.waitForFunction(
        (source) => new RegExp(source).test(document.getElementById("status").textContent),
        wanted.source,
    );
}

/** Starts a run and waits until it ends. */
export async function run(page) {
    await page.evaluate(() => (document.body.dataset.state = "asked"));
    await page.click("#run");
    await ended(page);
}

/**
 * Starts a run, and cancels it once a mesh of `preset` is shown or the status has the words of `status`. The page itself
 * does so in that moment: Playwright looks only when a picture is drawn, and misses what is short.
 */
export const cancelAt = (page, { preset, status: words }) =>
    page.evaluate(
        ([preset, words]) =>
            new Promise((resolve) => {
                const status = document.getElementById("status");
                const observer = new MutationObserver(() => {
                    if (preset && document.body.dataset.preset !== preset) return;
                    if (words && !status.textContent.includes(words)) return;
                    observer.disconnect();
                    document.getElementById("cancel").click();
                    resolve();
                });
                observer.observe(document.body, { attributeFilter: ["data-preset"] });
                observer.observe(status, { childList: true, characterData: true, subtree: true });
                document.getElementById("run").click();
            }),
        [preset, words],
    );

/** Starts a check of the calibration and waits until it ends. */
export async function check(page) {
    await page.click("#check");
    await page.waitForFunction(() => ["checked", "failed"].includes(document.body.dataset.state), undefined, {
        timeout: 240_000,
    });
}

/** The cameras that are marked in the strip, by name. */
export const marked = (page) =>
    page.$$eval("#strip button[data-warning] span", (spans) => spans.map((s) => s.textContent.split(" ")[0]));

/** The codes of the warnings that are listed. */
export const warned = (page) => page.$$eval("#warnings [data-code]", (all) => all.map((one) => one.dataset.code));

/** A browser and the site, for all tests of a file. */
export function drive() {
    let browser, site;
    before(async () => {
        // Not at the root, because the site works from any folder.
        site = await serve({ "/some/where/": dist });
        browser = await launch();
    });
    after(async () => {
        await browser.close();
        site.close();
    });
    /** The page in `own` or the common browser. It is closed when the test ends. */
    const open = async (t, { own = browser, query = "", ...options } = {}) => {
        const opened = await openPage(own, `${site.address}/some/where/${query}`, options);
        t.after(() => opened.page.context().close());
        return opened;
    };
    /** The page with a capture instead of the sample, set to the fastest preset. */
    const openWith = async (t, folder, options) => {
        // The sample would be reconstructed first.
        const opened = await open(t, { query: "?clip=", ...options });
        await opened.page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
        await openFolder(opened.page, folder);
        await opened.page.selectOption("#preset", "hull");
        return opened;
    };
    return { open, openWith };
}

/** Checks that bytes are equal, and does not print millions of them if they are not. */
export const same = (a, b) => assert.ok(a.equals(b), `${a.length} bytes are not the other ${b.length}`);

/** The picture that the view shows now, to find out whether it changes. */
export const view = async (page) => (await download(page, "export-png")).toString("base64");

export const pcmvs = (...args) => execFileSync(process.env.PCMVS, args, { stdio: ["ignore", "pipe", "pipe"] });
