// A clip on the page, and the files that the page saves.
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before } from "node:test";
import { folder, small } from "./captures.mjs";
import { openReader } from "./pictures.mjs";
import { download, drive, launch, pcmvs } from "./site.mjs";

export const { open } = drive();
let browser;
/** The folder of the clip, whose three frames are made by the command line, and what reads pictures and videos. */
export let clip, reader;

before(async () => {
    clip = folder();
    pcmvs("reconstruct", small, "-o", clip, "--preset", "hull", "--frames", "0,1,2");
    browser = await launch();
    reader = await openReader(browser);
});
after(async () => {
    await reader.close();
    await browser.close();
});

/** A browser's file pickers, which give files in the page's own file system. `disk` is "full", or "slow" with 250 KB per second. */
export function pickers(disk) {
    globalThis.showSaveFilePicker = async ({ suggestedName }) => {
        const root = await navigator.storage.getDirectory();
        return root.getFileHandle(suggestedName, { create: true });
    };
    globalThis.showDirectoryPicker = async () => {
        const root = await navigator.storage.getDirectory();
        return root.getDirectoryHandle("chosen", { create: true });
    };
    if (!disk) return;
    const open = FileSystemFileHandle.prototype.createWritable;
    FileSystemFileHandle.prototype.createWritable = async function () {
        const file = await open.call(this);
        const write = async (chunk) => {
            if (disk === "full") {
                await file.abort();
                throw new DOMException("no space", "QuotaExceededError");
            }
            const { size, byteLength } = chunk.data ?? chunk;
            await new Promise((resolve) => setTimeout(resolve, (size ?? byteLength) / 250));
            await file.write(chunk);
        };
        const stream = new WritableStream({ write, close: () => file.close(), abort: () => file.abort() });
        return Object.assign(stream, {
            write: async (chunk) => {
                const writer = stream.getWriter();
                await writer.write(chunk).finally(() => writer.releaseLock());
            },
        });
    };
}

/** The page with the clip, standing still at its first frame. */
export async function openClip(t, { from = clip, ...options } = {}) {
    const opened = await open(t, { query: "?clip=", ...options });
    const { page } = opened;
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    const files = readdirSync(from).filter((name) => /glb|sequence|audio/.test(name));
    await page.setInputFiles(
        "#file-input",
        files.map((name) => join(from, name)),
    );
    await page.waitForFunction(() => document.getElementById("status").textContent === "Clip opened");
    await page.click("#play");
    await showFrame(page, 0);
    return opened;
}

export async function showFrame(page, position) {
    await page.fill("#scrub", String(position));
    await page.waitForFunction(
        (at) => document.getElementById("counter").textContent.startsWith(`${at + 1} /`),
        position,
    );
    // The mesh follows when it is decoded.
    await page.waitForTimeout(500);
}

/** Sets the size and the background of the stills and the video. */
export async function setPictures(page, width, height, background) {
    await page.evaluate(() => {
        for (const details of document.querySelectorAll("section details")) details.open = true;
    });
    // The settings of videos are loaded now.
    await page.waitForFunction(() => document.getElementById("video-format").textContent !== "");
    for (const kind of ["still", "video"]) {
        await page.selectOption(`#${kind}-size`, "own");
        await page.fill(`#${kind}-width`, String(width));
        await page.fill(`#${kind}-height`, String(height));
        if (kind === "still" || background !== "transparent")
            await page.selectOption(`#${kind}-background`, background);
    }
}

export const still = (page) => download(page, "export-png");

/** Names of the files in the page's own file system, and of those in the chosen folder. */
export const kept = (page) =>
    page.evaluate(async () => {
        const names = [];
        const list = async (folder, path) => {
            for await (const [name, handle] of folder.entries()) {
                if (handle.kind === "directory") await list(handle, `${path}${name}/`);
                else names.push(path + name);
            }
        };
        await list(await navigator.storage.getDirectory(), "");
        return names.sort();
    });

export async function keptFile(page, path) {
    const data = await page.evaluate(async (path) => {
        let at = await navigator.storage.getDirectory();
        const parts = path.split("/");
        for (const part of parts.slice(0, -1)) at = await at.getDirectoryHandle(part);
        const file = await (await at.getFileHandle(parts.at(-1))).getFile();
        return new Promise((resolve) => {
            const reading = new FileReader();
            reading.onload = () => resolve(reading.result.split(",")[1]);
            reading.readAsDataURL(file);
        });
    }, path);
    return Buffer.from(data, "base64");
}

export const told = (page, pattern) =>
    page.waitForFunction(
        (source) => new RegExp(source).test(document.getElementById("export-status").textContent),
        pattern,
        {
            timeout: 120_000,
        },
    );
