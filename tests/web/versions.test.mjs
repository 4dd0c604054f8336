// The service worker: use without a network, and how a new version of the page reaches people.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import {
    appendFileSync,
    cpSync,
    existsSync,
    mkdirSync,
    readFileSync,
    rmSync,
    symlinkSync,
    writeFileSync,
} from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { folder, scene, small } from "./captures.mjs";
import { ended, launch, openPage, serve, text } from "./site.mjs";

const root = fileURLToPath(new URL("../..", import.meta.url));
const NAMES = ["Sample: 20 synthetic cameras", "Sample of the next version"];
/** Frames per second of the samples, which have one frame. */
const FPS = [10, 20];

let builds;

/** Builds the page, as it is and as a next version whose page, worker and sample differ. */
before(() => {
    const copy = folder();
    mkdirSync(join(copy, "web"));
    mkdirSync(join(copy, "wasm"));
    symlinkSync(join(root, "wasm/pkg"), join(copy, "wasm/pkg"));
    // The documentation, which is part of the site.
    for (const path of ["README.md", "BENCHMARKS.md", "CHANGELOG.md", "docs", "wasm/npm"])
        symlinkSync(join(root, path), join(copy, path));
    for (const path of ["index.html", "src", "public", "package.json", "tsconfig.json", "vite.config.ts", "docs.ts"]) {
        cpSync(join(root, "web", path), join(copy, "web", path), { recursive: true });
    }
    symlinkSync(join(root, "web/node_modules"), join(copy, "web/node_modules"));
    const edit = (path, from, to) => {
        const text = readFileSync(join(copy, "web", path), "utf8");
        assert.ok(text.includes(from), `${path} does not contain ${from}`);
        writeFileSync(join(copy, "web", path), text.replace(from, to));
    };
    const build = (out) => {
        const vite = join(copy, "web/node_modules/.bin/vite");
        execFileSync(vite, ["build", "--logLevel", "error", "--outDir", out], {
            cwd: join(copy, "web"),
            stdio: "pipe",
        });
        return out;
    };
    for (const kind of ["images", "masks"])
        cpSync(join(small, kind), join(copy, "web/public/sample", kind), { recursive: true });
    const setSample = (fps) => {
        // Small pictures of every second camera are enough for a mesh, and take a part of the time.
        const half = (list) => list.filter((_, i) => i % 2 === 0);
        const [{ images, masks, ...frame }] = scene.frames;
        const frames = [{ ...frame, images: half(images), masks: half(masks) }];
        const sample = { ...scene, fps, cameras: half(scene.cameras), frames };
        writeFileSync(join(copy, "web/public/sample/scene.json"), JSON.stringify(sample));
    };
    setSample(FPS[0]);
    const first = build(join(copy, "first"));
    edit("src/page/sources.ts", NAMES[0], NAMES[1]);
    edit("src/workers/worker.ts", 'type: "done"', 'type: "done", version: 2');
    setSample(FPS[1]);
    builds = [first, build(join(copy, "next"))];
});

/** A site in a folder whose content can be replaced, and a browser. */
async function publish(t) {
    const site = folder();
    const put = (build) => {
        rmSync(site, { recursive: true });
        cpSync(build, site, { recursive: true });
    };
    put(builds[0]);
    const server = await serve({ "/some/where/": site });
    const browser = await launch();
    t.after(async () => {
        await browser.close();
        await server.close();
    });
    /** The same address with the headers that isolate the page from other origins. */
    const isolate = async () => {
        await server.close();
        // An answer that nothing has changed would have the old headers.
        appendFileSync(join(site, "index.html"), "<!-- isolated -->");
        const isolated = await serve({ "/some/where/": site }, true, Number(new URL(server.address).port));
        t.after(isolated.close);
        return isolated;
    };
    return { put, server, isolate, browser, address: `${server.address}/some/where/` };
}

/** Waits until an asynchronous check holds, which Playwright's `waitForFunction` cannot do. */
async function until(page, check) {
    for (const end = performance.now() + 60_000; !(await check()); await page.waitForTimeout(100)) {
        assert.ok(performance.now() < end, `never true: ${check}`);
    }
}

/** Chromium's list of the versions of service workers, and a way to stop those that run. */
async function workers(page) {
    const devtools = await page.context().newCDPSession(page);
    const versions = new Map();
    devtools.on("ServiceWorker.workerVersionUpdated", (event) => {
        for (const version of event.versions) versions.set(version.versionId, version);
    });
    await devtools.send("ServiceWorker.enable");
    const found = (status) => [...versions.values()].filter((version) => version.status === status);
    const stop = async ({ versionId, runningStatus }) =>
        runningStatus === "running" && devtools.send("ServiceWorker.stopWorker", { versionId });
    return { found, stop, close: () => devtools.detach() };
}

/**
 * Waits until the version that a page shows is the active one, and no other is on its way.
 *
 * An old version is replaced once its worker has stopped. Chromium stops idle workers, but not those that DevTools or
 * Playwright watch: these it leaves running for five minutes. The old worker is therefore stopped here.
 */
async function kept(page) {
    const { found, stop, close } = await workers(page);
    await until(page, async () => {
        if (found("installed").length > 0) await Promise.all(found("activated").map(stop));
        return page.evaluate(async () => {
            const { active, waiting, installing } = await navigator.serviceWorker.ready;
            const script = performance.getEntriesByType("resource").find(({ name }) => /assets\/page-/.test(name)).name;
            const cached = (await caches.match(script)) !== undefined;
            return active.state === "activated" && !waiting && !installing && cached;
        });
    });
    await close();
}

const name = (page) => text(page, "name");

/** Frames per second of the sample that the page's own workers read. */
const sampleFps = (page) =>
    page.evaluate(async () => {
        const entries = performance.getEntriesByType("resource").filter(({ name }) => name.includes("scene.json"));
        return (await (await fetch(entries.at(-1).name)).json()).fps;
    });

test("a reload shows a new version, which then works without a network", async (t) => {
    const { put, server, browser, address } = await publish(t);
    const { page, problems } = await openPage(browser, address);
    await ended(page);
    await kept(page);
    assert.equal(await name(page), NAMES[0]);

    put(builds[1]);
    await page.reload();
    await ended(page);
    assert.equal(await name(page), NAMES[1]);
    await kept(page);
    assert.equal(await sampleFps(page), FPS[1]);

    await server.close();
    await page.context().setOffline(true);
    await page.reload();
    await ended(page);
    assert.equal(await name(page), NAMES[1]);
    assert.equal(await sampleFps(page), FPS[1]);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    assert.deepEqual(
        problems.filter((p) => !p.includes("ERR_INTERNET_DISCONNECTED")),
        [],
    );
    // The documentation, too.
    await page.goto(await page.getAttribute("#intro a", "href").then((path) => new URL(path, address).href));
    assert.equal(await page.title(), "pcmvs");
    assert.equal(await page.locator("h1").innerText(), "pcmvs");
});

test("a host that begins to isolate the page can use the version that a visitor has", async (t) => {
    const { isolate, browser, address } = await publish(t);
    const { page, problems } = await openPage(browser, address);
    await ended(page);
    await kept(page);
    const isolated = () => page.evaluate(() => crossOriginIsolated);
    assert.equal(await isolated(), false);

    // The page comes from the network and has the new headers, and its workers come from the cache.
    await isolate();
    await page.reload();
    await ended(page);
    assert.equal(await isolated(), true);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    const threads = await page.evaluate(() => performance.getEntriesByName("threads").length);
    assert.equal(threads, existsSync(join(root, "wasm/pkg/pcmvs-threads.wasm")) ? 1 : 0);
    assert.deepEqual(problems, []);
});

test("a page that is open keeps its version until it is closed", async (t) => {
    const { put, browser, address } = await publish(t);
    const { page: old, problems } = await openPage(browser, address);
    await ended(old);
    await kept(old);

    put(builds[1]);
    const page = await old.context().newPage();
    await page.goto(address);
    await ended(page);
    assert.equal(await name(page), NAMES[1]);
    const waiting = async () => (await navigator.serviceWorker.ready).waiting?.state === "installed";
    await until(page, () => page.evaluate(waiting));

    // This needs new workers and the sample, which the server does not have any more.
    await old.evaluate(() => (document.body.dataset.state = "asked"));
    await old.click("#sample");
    await ended(old);
    assert.match(await text(old, "status"), /^1 of 1 frames/);
    assert.equal(await name(old), NAMES[0]);
    assert.equal(await sampleFps(old), FPS[0]);
    assert.deepEqual(problems, []);

    await old.close();
    await page.reload();
    await ended(page);
    await kept(page);
    assert.equal(await name(page), NAMES[1]);
});
