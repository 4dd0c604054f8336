// The player's element: what it shows and when, and what it needs for that.
import assert from "node:assert/strict";
import { test } from "node:test";
import { add, COUNT, FPS, heard, openElement, showsFrame } from "./clips.mjs";
import { same, slowGraphics } from "./site.mjs";

test("both versions of a manifest play, and every frame is shown in its own time", async (t) => {
    const { page, problems } = await openElement(t);
    const pictures = {};
    for (const name of ["one", "parts", "whole", "loud"]) {
        await add(page, { src: `${name}/sequence.json`, autoplay: "", loop: "", quality: "full" });
        await page.waitForFunction(() => globalThis.clip.shownFrames > 20, undefined, { timeout: 60_000 });
        await page.evaluate(() => globalThis.clip.pause());
        const { shown, duration, events } = await page.evaluate(() => ({
            shown: globalThis.shown.filter(({ playing }) => playing),
            duration: globalThis.clip.duration,
            events: [...new Set(globalThis.heard)],
        }));
        assert.equal(duration, COUNT / FPS);
        for (const { frame, time } of shown) assert.equal(frame, Math.floor(time * FPS + 1e-3), `${name} at ${time} s`);
        assert.ok(new Set(shown.map(({ frame }) => frame)).size > COUNT / 2, `${name}: ${JSON.stringify(shown)}`);
        assert.deepEqual(events.sort(), ["loadedmetadata", "pause", "play", "ready", "timeupdate"]);
        await page.evaluate((time) => (globalThis.clip.currentTime = time), 5.5 / FPS);
        await showsFrame(page, 5);
        await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
        pictures[name] = await page.locator("pcmvs-player").screenshot();
    }
    // A frame in a packed file is the one in its own file. All have the same bounds, and so are seen from the same place.
    for (const name of ["parts", "whole", "loud"]) same(pictures.one, pictures[name]);
    const other = await page.evaluate(() => (globalThis.clip.currentTime = 0));
    assert.equal(other, 0);
    await showsFrame(page, 0);
    await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    assert.ok(!pictures.one.equals(await page.locator("pcmvs-player").screenshot()), "all frames look alike");
    assert.deepEqual(problems, []);
});

test("a clip that does not loop ends with its last frame, and plays again", async (t) => {
    const { page, problems } = await openElement(t);
    await add(page, { src: "two/sequence.json", autoplay: "", rate: "2" });
    await heard(page, "ended");
    await showsFrame(page, COUNT - 1);
    assert.equal(await page.evaluate(() => globalThis.clip.paused), true);
    await page.evaluate(() => {
        globalThis.heard.length = 0;
        globalThis.clip.play();
    });
    await heard(page, "ended");
    assert.deepEqual(problems, []);
});

test("a clip goes by its sound", async (t) => {
    const { page, problems } = await openElement(t);
    await add(page, { src: "loud/sequence.json", loop: "" });
    await heard(page, "ready");
    await page.mouse.click(5, 5);
    await page.evaluate(() => globalThis.clip.play());
    await page.waitForFunction(() => globalThis.clip.player.audio.currentTime > 0.2);
    // The sound is slowed down behind the player's back: the frames follow it.
    const [clip, sound, wall] = await page.evaluate(async () => {
        const { player } = globalThis.clip;
        player.audio.currentTime = 0;
        player.audio.playbackRate = 0.5;
        await new Promise((resolve) => player.audio.addEventListener("seeked", resolve, { once: true }));
        const start = performance.now();
        while (performance.now() - start < 800) await new Promise(requestAnimationFrame);
        return [player.currentTime, player.audio.currentTime, (performance.now() - start) / 1000];
    });
    assert.ok(Math.abs(clip - sound) < 0.1 && clip < 0.75 * wall, `${clip} ${sound} ${wall}`);
    assert.deepEqual(problems, []);
});

test("a page that is too slow drops frames and does not stall", async (t) => {
    const { page, problems } = await openElement(t);
    await add(page, { src: "long/sequence.json", autoplay: "", loop: "" });
    await heard(page, "play");
    const [passed, shown, dropped, wall] = await page.evaluate(async () => {
        const { clip } = globalThis;
        // Three of four frames' time goes to something else.
        const busy = setInterval(() => {
            for (const end = performance.now() + 400; performance.now() < end; );
        }, 500);
        const [time, shown, dropped, start] = [
            clip.currentTime,
            clip.shownFrames,
            clip.droppedFrames,
            performance.now(),
        ];
        while (performance.now() - start < 2200) await new Promise((resolve) => setTimeout(resolve, 20));
        clearInterval(busy);
        const wall = (performance.now() - start) / 1000;
        return [clip.currentTime - time, clip.shownFrames - shown, clip.droppedFrames - dropped, wall];
    });
    assert.ok(Math.abs(passed - wall) < 0.3, `${passed} s of the clip in ${wall} s`);
    assert.ok(dropped >= 5, `${dropped} dropped`);
    assert.ok(Math.abs(shown + dropped - passed * FPS) <= 3, `${shown} shown and ${dropped} dropped in ${passed} s`);
    assert.deepEqual(problems, []);
});

test("at most two drawings wait for the graphics processor, and other frames are dropped", async (t) => {
    const { page, problems } = await openElement(t, { script: slowGraphics });
    await add(page, { src: "long/sequence.json", autoplay: "", loop: "" });
    await heard(page, "play");
    const figures = () =>
        page.evaluate(() => [globalThis.drawings, globalThis.clip.shownFrames, globalThis.clip.droppedFrames]);
    await page.waitForFunction(() => globalThis.clip.shownFrames > 2);
    await page.evaluate(() => globalThis.hold(true));
    const [, shown, dropped] = await figures();
    // A second of the clip.
    await page.waitForTimeout(1000);
    const [drawings, shownThen] = await figures();
    assert.ok(drawings <= 2 && shownThen - shown <= 2, `${drawings} drawings, ${shownThen - shown} frames shown`);
    await page.evaluate(() => globalThis.hold(false));
    await page.waitForFunction((count) => globalThis.clip.shownFrames > count, shownThen + 2);
    const [, , droppedThen] = await figures();
    assert.ok(droppedThen - dropped >= FPS - 4, `${droppedThen - dropped} dropped`);
    assert.deepEqual(problems, []);
});

test("memory is flat over ten loops", async (t) => {
    const { page, problems } = await openElement(t);
    await add(page, { src: "long/sequence.json", autoplay: "", loop: "", rate: "4" });
    const loops = async (count) =>
        page.evaluate(async (count) => {
            const { clip } = globalThis;
            let last = clip.currentTime;
            for (let seen = 0; seen < count; await new Promise(requestAnimationFrame)) {
                if (clip.currentTime < last) seen++;
                last = clip.currentTime;
            }
            const { geometries, textures } = clip.renderer.info.memory;
            return { geometries, textures };
        }, count);
    await heard(page, "play");
    const few = await loops(2);
    const many = await loops(10);
    // Not all of the 24 frames are kept.
    for (const { geometries, textures } of [few, many])
        assert.ok(geometries <= 12 && textures <= 12, JSON.stringify([few, many]));
    await page.evaluate(() => {
        globalThis.info = globalThis.clip.renderer.info.memory;
        globalThis.clip.remove();
    });
    assert.ok(await page.evaluate(() => globalThis.info.geometries <= 1), "a removed element keeps its frames");
    assert.deepEqual(problems, []);
});
