// One frame on several workers that share memory, on a site that is isolated from other origins.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { capture, folder, small, wholeCapture } from "./captures.mjs";
import { dist, download, launch, openFolder, openPage, pcmvs, run, same, serve } from "./site.mjs";

const pkg = fileURLToPath(new URL("../../wasm/pkg/", import.meta.url));
/** A machine without the source of Rust's standard library builds the package without threads. */
const skip = existsSync(join(pkg, "pcmvs-threads.wasm")) ? false : "the package was built without threads";

/** A worker that reconstructs frame 0 of the small sample with both modules, and posts what they make. */
const WORKER = `
    import * as plain from "/pkg/index.js";
    import * as shared from "/pkg/threads.js";
    const bytes = async (path) => new Uint8Array(await (await fetch("/sample/" + path)).arrayBuffer());
    const scene = await (await fetch("/sample/scene.json")).json();
    const frameOf = async ({ Frame, Rig }) => {
        const frame = new Frame(new Rig(scene.cameras));
        for (const [i, path] of scene.frames[0].images.entries()) {
            frame.setImage(i, await bytes(path));
            frame.setMask(i, await bytes(scene.frames[0].masks[i]));
        }
        return frame;
    };
    const digest = async (bytes) => [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))].join();
    const makes = async (library) => {
        const frame = await frameOf(library);
        const made = frame.reconstruct("default");
        const own = made.own();
        const alone = await digest(made.glb(scene.up));
        made.steady([own]);
        return { alone, mean: await digest(made.glb(scene.up)), hashes: made.hashes() };
    };
    const codeOf = (work) => {
        try {
            return work(), "none";
        } catch (error) {
            return error.code ?? String(error);
        }
    };
    try {
        const found = { supported: shared.supported };
        if (shared.supported) {
            await plain.ready;
            await shared.start(3, "failures");
            found.threads = shared.threads();
            found.plain = await makes(plain);
            found.shared = await makes(shared);
            const frame = await frameOf(shared);
            found.cancelled = codeOf(() => frame.reconstruct("hull", (stage) => stage !== "hull"));
            found.again = codeOf(() => shared.startThreads(2));
            // Jobs that only the other threads have run would leave the calling one without steps to report.
            let steps = 0;
            frame.reconstruct("preview", () => void steps++);
            found.steps = steps;
            // A worker for which there is no thread to run fails.
            const channel = new BroadcastChannel("more");
            const failed = new Promise((resolve) => (channel.onmessage = ({ data }) => resolve(data)));
            const module = await WebAssembly.compileStreaming(fetch("/pkg/pcmvs-threads.wasm"));
            const memory = new WebAssembly.Memory({ initial: 64, maximum: 65536, shared: true });
            new Worker("/pkg/thread.js", { type: "module" }).postMessage({ module, memory, failures: "more" });
            found.failed = await failed;
        }
        postMessage(found);
    } catch (error) {
        postMessage({ error: String(error) });
    }
`;

let browser, site, plainSite;
before(async () => {
    const root = folder();
    writeFileSync(join(root, "index.html"), "<!doctype html><title>t</title>");
    writeFileSync(join(root, "worker.js"), WORKER);
    const folders = { "/": root, "/pkg/": pkg, "/sample/": small, "/some/where/": dist };
    [site, plainSite] = [await serve(folders, true), await serve(folders)];
    browser = await launch();
});
after(async () => {
    await browser.close();
    site.close();
    plainSite.close();
});

/** What the worker of a site posts. */
async function posted(t, address) {
    const { page } = await openPage(browser, `${address}/index.html`);
    t.after(() => page.context().close());
    return page.evaluate(
        () =>
            new Promise((resolve, reject) => {
                const worker = new Worker("/worker.js", { type: "module" });
                worker.onmessage = ({ data }) => resolve(data);
                worker.onerror = (event) => reject(new Error(event.message));
            }),
    );
}

test("three threads give the bytes and the hashes of one", { skip }, async (t) => {
    const found = await posted(t, site.address);
    assert.equal(found.error, undefined);
    assert.equal(found.threads, 3);
    assert.deepEqual(found.shared, found.plain);
    assert.match(found.plain.hashes.steady, /^[0-9a-f]{16}$/);
    assert.deepEqual([found.cancelled, found.again], ["cancelled", "input"]);
    assert.ok(found.steps > 20, `${found.steps} steps`);
    assert.deepEqual(found.failed, { code: "internal", message: "all threads have a worker" });
});

test("without isolation the package says that threads are not supported", { skip }, async (t) => {
    assert.deepEqual(await posted(t, plainSite.address), { supported: false });
});

/** The page with frame 0 of the small sample as a capture of its own, or with another capture. */
async function openAlone(t, address, options, source = capture([0])) {
    const opened = await openPage(browser, `${address}/some/where/?clip=`, options);
    t.after(() => opened.page.context().close());
    await opened.page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    await openFolder(opened.page, source);
    return opened;
}

const threads = (page) => page.evaluate(() => performance.getEntriesByName("threads").map(({ detail }) => detail));
/** How many workers run that a worker of the page has started. */
async function nested(page) {
    const client = await browser.newBrowserCDPSession();
    const { targetInfos } = await client.send("Target.getTargets", { filter: [{ type: "worker" }] });
    await client.detach();
    const origin = new URL(page.url()).origin;
    return targetInfos.filter(({ url }) => url.startsWith(origin) && url.includes("/thread-")).length;
}
/** Waits until they have ended, which takes a moment. */
async function noneNested(page) {
    for (let i = 0; i < 50 && (await nested(page)) > 0; i++) await page.waitForTimeout(100);
    assert.equal(await nested(page), 0);
}

test("the page makes a single frame on all processors, with the command line's bytes", { skip }, async (t) => {
    const out = folder();
    pcmvs("reconstruct", small, "-o", out, "--frames", "0", "--preset", "preview", "--alone");
    for (const [address, expected] of [
        [site.address, 1],
        [plainSite.address, 0],
    ]) {
        const { page, problems } = await openAlone(t, address);
        await page.selectOption("#preset", "preview");
        await run(page);
        const counts = await threads(page);
        assert.equal(counts.length, expected, address);
        for (const count of counts) assert.equal(count, await page.evaluate(() => navigator.hardwareConcurrency));
        same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
        assert.deepEqual(problems, []);
    }
});

test("where the module with threads cannot be loaded, one thread does the work", { skip }, async (t) => {
    const prepare = (page) => page.context().route("**/pcmvs-threads*.wasm", (asked) => asked.abort());
    const { page } = await openAlone(t, site.address, { prepare });
    await page.selectOption("#preset", "hull");
    await run(page);
    assert.equal(await page.evaluate(() => document.body.dataset.state), "done");
    assert.deepEqual(await threads(page), []);
});

test("the threads of a run that is cancelled end", { skip }, async (t) => {
    const { page } = await openAlone(t, site.address, {}, wholeCapture([0]));
    await page.click("#run");
    await page.waitForFunction(() => performance.getEntriesByName("threads").length > 0);
    assert.equal(await nested(page), (await threads(page))[0] - 1);
    await page.click("#cancel");
    await noneNested(page);
});

test("a thread that fails ends the run, and the next one works", { skip }, async (t) => {
    const script = () => {
        globalThis.BroadcastChannel = class extends BroadcastChannel {
            constructor(name) {
                super(name);
                globalThis.failures = name;
            }
        };
    };
    const { page } = await openAlone(t, site.address, { script }, wholeCapture([0]));
    await page.evaluate(() => (document.body.dataset.state = "asked"));
    await page.click("#run");
    await page.waitForFunction(() => globalThis.failures !== undefined);
    // What a thread posts that has run out of memory. The worker that waits for it would wait for ever.
    await page.evaluate(() => {
        const channel = new BroadcastChannel(globalThis.failures);
        channel.postMessage({ code: "out-of-memory", message: "no memory for a thread" });
    });
    await page.waitForFunction(() => document.body.dataset.state === "failed");
    assert.match(await page.innerText("#errors"), /no memory for a thread/);
    await noneNested(page);
    await page.selectOption("#preset", "hull");
    await run(page);
    assert.equal(await page.evaluate(() => document.body.dataset.state), "done");
});
