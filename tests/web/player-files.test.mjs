// The files of a published clip: how they are loaded, and what is refused.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { test } from "node:test";
import { add, browser, COUNT, edit, FPS, heard, openElement, root, showsFrame, site } from "./clips.mjs";
import { openPage, pcmvs, sample } from "./site.mjs";

/**
 * A host of its own for the clip in a folder, and a page that may load from it. `answer` sends the clip's only GLB, given its bytes;
 * the manifest is sent as it is.
 */
async function hosted(t, folder, answer) {
    const file = readFileSync(join(folder, "full.glb"));
    const server = createServer((request, response) => {
        response.setHeader("access-control-allow-origin", "*");
        if (request.url.endsWith(".json")) response.end(readFileSync(join(folder, "sequence.json")));
        else answer(request, response, file);
    }).listen(0, "127.0.0.1");
    t.after(() => server.closeAllConnections());
    t.after(() => server.close());
    const { page } = await openPage(browser, `${site.address}/site/plain.html`);
    t.after(() => page.context().close());
    await page.waitForFunction(() => customElements.get("pcmvs-player"));
    return { page, src: `http://127.0.0.1:${server.address().port}/sequence.json`, file };
}

test("what is wrong with a clip is said in words", async (t) => {
    const { page } = await openElement(t);
    const faults = {
        version: [(m) => (m.version = 7), /^sequence\.json: version 7 is not known/],
        empty: [(m) => (m.frames = []), /the clip has no frames/],
        count: [(m) => (m.frame_count = 3), /frame_count is 3, and 8 frames are listed/],
        rate: [(m) => (m.fps = "fast"), /fps is not a number/],
        bytes: [(m) => (m.frames[0].bytes += 1), /frame_0000\.glb: has fewer bytes than the manifest says/],
        missing: [(m) => (m.frames[0].url = "none.glb"), /none\.glb: the host answers 404/],
        shape: [(m) => (m.frames = {}), /frames is missing/],
        segment: [(m) => (m.qualities[0].segments[0].frames = []), /quality full: a segment has no frames/, "two"],
        other: [(m) => (m.qualities[1].segments[0].frames[0] = 99), /quality mobile: has other frames/, "two"],
    };
    for (const path of [
        "../one/frame_0000.glb",
        "/site/one/frame_0000.glb",
        "https://example.org/a.glb",
        "//example.org/a.glb",
        "a/%2e%2e/%2e%2e/one/frame_0000.glb",
        "..%2fone/frame_0000.glb",
        "..\\one\\frame_0000.glb",
        "data:model/gltf-binary,a",
    ]) {
        faults[`path${Object.keys(faults).length}`] = [
            (m) => (m.frames[0].url = path),
            /is not in the folder of the manifest/,
        ];
    }
    const asked = [];
    page.on("request", (request) => asked.push(request.url()));
    for (const [name, [change, words, from]] of Object.entries(faults)) {
        edit(`bad-${name}`, change, from);
        await add(page, { src: `bad-${name}/sequence.json` });
        await heard(page, "error");
        assert.match(await page.evaluate(() => globalThis.clip.error.message), words, name);
        assert.match(await page.locator("pcmvs-player [role=alert]").innerText(), words, name);
        assert.equal(await page.evaluate(() => globalThis.heard.includes("ready")), false, name);
    }
    writeFileSync(join(root, "text.json"), "no manifest");
    edit("outside", () => {});
    const outside = readFileSync(join(root, "outside/frame_0000.glb"));
    const image = /\{"bufferView":\d+,"mimeType":"image\/jpeg"\}/.exec(outside.toString("latin1"));
    outside.write('{"uri":"https://example.org/a"}'.padEnd(image[0].length), image.index);
    writeFileSync(join(root, "outside/frame_0000.glb"), outside);
    edit("torn", () => {}, "whole");
    const glb = readFileSync(join(root, "torn/full.glb"));
    writeFileSync(join(root, "torn/full.glb"), glb.fill(0x20, 40, 400));
    for (const [src, words] of [
        ["text.json", /^text\.json: is not JSON: is this the address of a clip/],
        ["nowhere/sequence.json", /^sequence\.json: the host answers 404/],
        ["https://127.0.0.1:1/sequence.json", /^sequence\.json: cannot be loaded/],
        ["outside/sequence.json", /this GLB refers to other files/],
        ["torn/sequence.json", /^full\.glb: is damaged or not a file of pcmvs pack/],
    ]) {
        await add(page, { src });
        await heard(page, "error");
        assert.match(await page.evaluate(() => globalThis.clip.error.message), words, src);
    }
    assert.deepEqual(
        asked.filter((url) => url.includes("/one/") || /example\.org/.test(url)),
        [],
    );
    // Another clip in the same element plays.
    await page.evaluate(() => globalThis.clip.setAttribute("src", "one/sequence.json"));
    await heard(page, "ready");
    assert.equal(await page.locator("pcmvs-player [role=alert]").isVisible(), false);
});

test("the first frames are shown before a file is complete", async (t) => {
    let finish;
    const { page, src } = await hosted(t, join(root, "whole"), (_, response, file) => {
        response.write(file.subarray(0, file.length / 2));
        finish = () => response.end(file.subarray(file.length / 2));
    });
    await add(page, { src, autoplay: "" });
    await heard(page, "ready");
    finish();
    await heard(page, "ended");
    // The strict page allows its own host only.
    const strict = await openElement(t);
    await add(strict.page, { src });
    await heard(strict.page, "error");
});

test("a connection that breaks is tried once more, and not more often", async (t) => {
    const { page } = await openElement(t);
    const asked = new Map();
    let broken = 1;
    await page.route("**/two/full_002.glb", (route) => {
        const times = (asked.get("full") ?? 0) + 1;
        asked.set("full", times);
        return times <= broken ? route.abort() : route.continue();
    });
    await add(page, { src: "two/sequence.json", autoplay: "", quality: "full" });
    await heard(page, "ended");
    assert.equal(asked.get("full"), 2);
    asked.clear();
    broken = 99;
    await add(page, { src: "two/sequence.json", autoplay: "", quality: "full" });
    await heard(page, "error");
    assert.match(await page.evaluate(() => globalThis.clip.error.message), /^full_002\.glb: cannot be loaded/);
    assert.equal(asked.get("full"), 2);
});

test("a connection on which nothing arrives any more is tried once more", async (t) => {
    const asked = [];
    const { page, src } = await hosted(t, join(root, "whole"), ({ url }, response, file) => {
        asked.push(url);
        // The first answer stops in the middle.
        if (asked.length === 1) response.write(file.subarray(0, file.length / 2));
        else response.end(file);
    });
    await add(page, { src, autoplay: "" });
    // The clip's time passes, and the last frame is shown as soon as it is there.
    await showsFrame(page, COUNT - 1);
    assert.deepEqual(asked, ["/full.glb", "/full.glb"]);
});

test("a frame far ahead is loaded at once if the host sends parts of files, and in its turn otherwise", async (t) => {
    const folders = ["frames", "site"].map((name) => join(root, "far", name));
    // Its frames are large enough that the last one is not waited for.
    pcmvs("reconstruct", sample, "-o", folders[0], "--preset", "hull", "--frames", "0..3");
    pcmvs("pack", folders[0], "--manifest", "-o", folders[1]);
    const asked = [];
    let [sendsParts, finish] = [true, () => {}];
    const { page, src, file } = await hosted(t, folders[1], ({ headers: { range } }, response, file) => {
        asked.push(range ?? "whole");
        if (range && sendsParts) {
            const [from, to] = /^bytes=(\d+)-(\d+)$/.exec(range).slice(1).map(Number);
            response.statusCode = 206;
            response.end(file.subarray(from, to + 1));
            return;
        }
        // The rest of a whole file comes late.
        response.write(file.subarray(0, file.length / 4));
        finish = () => response.end(file.subarray(file.length / 4));
    });
    const seek = async () => {
        asked.length = 0;
        await add(page, { src });
        await heard(page, "ready");
        await page.evaluate((time) => (globalThis.clip.currentTime = time), 3 / FPS);
    };
    await seek();
    await showsFrame(page, 3);
    for (let i = 0; i < 100 && asked.length < 3; i++) await page.waitForTimeout(50);
    const [whole, last, between] = asked;
    assert.equal(whole, "whole");
    const start = Number(/^bytes=(\d+)-/.exec(last)[1]);
    assert.equal(last, `bytes=${start}-${file.length - 1}`);
    assert.ok(start > file.length / 2, last);
    assert.equal(Number(/-(\d+)$/.exec(between)[1]), start - 1, "what was left out is loaded after it");
    sendsParts = false;
    await seek();
    await page.waitForTimeout(500);
    assert.equal(await page.evaluate(() => globalThis.clip.player.frame), 0);
    finish();
    await showsFrame(page, 3);
    assert.equal(asked[0], "whole");
});

test("the quality goes by the bandwidth", async (t) => {
    const { page, problems } = await openElement(t);
    const asked = new Set();
    page.on("request", (request) => asked.add(request.url().split("/").at(-1)));
    const network = await page.context().newCDPSession(page);
    await network.send("Network.enable");
    const play = async (bytes) => {
        asked.clear();
        const conditions = { offline: false, latency: 0, downloadThroughput: bytes, uploadThroughput: bytes };
        await network.send("Network.emulateNetworkConditions", conditions);
        await network.send("Network.setCacheDisabled", { cacheDisabled: true });
        await add(page, { src: "two/sequence.json", autoplay: "", loop: "" });
        await page
            .waitForFunction(() => globalThis.clip.shownFrames > 2 * 8, undefined, { timeout: 60_000 })
            .catch(async () => {
                const state = await page.evaluate(() => {
                    const { shownFrames, droppedFrames, loadedQuality, currentTime } = globalThis.clip.player;
                    return { shownFrames, droppedFrames, loadedQuality, currentTime, heard: globalThis.heard };
                });
                assert.fail(`it does not play: ${JSON.stringify({ bytes, ...state, asked: [...asked], problems })}`);
            });
        return [...asked].filter((name) => name.endsWith(".glb"));
    };
    const rates = JSON.parse(readFileSync(join(root, "two/sequence.json"), "utf8")).qualities.map(({ bytes }) => bytes);
    assert.ok(rates[0] > 2 * rates[1], `${rates}`);
    // What is sent in a second is a little more than the small quality, and then a lot more than the large one.
    const slow = await play(1.6 * rates[1]);
    assert.ok(
        slow.every((name) => name.startsWith("mobile")),
        `${slow}`,
    );
    const fast = await play(-1);
    assert.ok(fast[0].startsWith("mobile"), `${fast}`);
    assert.ok(
        fast.some((name) => name.startsWith("full")),
        `${fast}`,
    );
    await page.evaluate(() => globalThis.clip.setAttribute("quality", "mobile"));
    assert.equal(await page.evaluate(() => globalThis.clip.player.loadedQuality), "mobile");
    await page.evaluate(() => globalThis.clip.setAttribute("quality", "best"));
    await heard(page, "error");
    assert.match(
        await page.evaluate(() => globalThis.clip.error.message),
        /no quality best in this clip: it has full, mobile/,
    );
    assert.deepEqual(problems, []);
});
