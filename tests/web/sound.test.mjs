// The sound of videos that the page saves.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { folder } from "./captures.mjs";
import { clip, openClip, reader, setPictures } from "./saving.mjs";
import { download, pcmvs, text } from "./site.mjs";
import { wave } from "./wave.mjs";

/** Frames per second of the clip and of the video. */
const [FPS, RATE] = [8, 16];
const FRAMES = 3;
/** The video shows the clip four times. */
const SECONDS = (4 * FRAMES) / FPS;
const SAMPLES = 48_000;
/** The clip with sound, which is published. */
let loud;

before(() => {
    const made = folder();
    const sound = join(made, "sound.wav");
    // It is loud while the second frame is shown.
    const beep = (time) => (time >= 1 / FPS && time < 1.5 / FPS ? Math.sin(2 * Math.PI * 880 * time) / 2 : 0);
    writeFileSync(sound, wave(1 / 3, SAMPLES, beep));
    loud = join(made, "loud");
    pcmvs("pack", clip, "--manifest", "-o", loud, "--audio", sound, "--fps", String(FPS));
});

async function openLoud(t, script) {
    const opened = await openClip(t, { from: loud, script });
    await setPictures(opened.page, 160, 120, "white");
    await opened.page.fill("#video-rate", String(RATE));
    await opened.page.fill("#video-length", String(SECONDS));
    await opened.page.selectOption("#video-motion", "still");
    return opened;
}

const offers = (page, pattern) =>
    page.waitForFunction(
        (source) => new RegExp(source).test(document.getElementById("video-format").textContent),
        pattern,
    );

/** Fails unless the sound begins and ends with the video, and is loud whenever the second frame begins. */
async function inStep(t, video) {
    const [sound, { times, duration }] = [await reader.sound(video), await reader.video(video)];
    assert.ok(sound, "there is no sound");
    t.diagnostic(`${sound.codec}, ${sound.begin} to ${sound.end} s, loud at ${sound.onsets}`);
    assert.deepEqual([sound.channels, sound.rate, times.length], [2, SAMPLES, SECONDS * RATE]);
    assert.ok(Math.abs(sound.begin) < 0.001, `the sound begins at ${sound.begin}`);
    assert.ok(Math.abs(sound.end - duration) < 1 / RATE, `${sound.end} s of sound, ${duration} s of video`);
    const expected = [0, 1, 2, 3].map((turn) => (turn * FRAMES + 1) / FPS);
    assert.equal(sound.onsets.length, expected.length, `loud at ${sound.onsets}`);
    for (const [i, onset] of sound.onsets.entries())
        assert.ok(Math.abs(onset - expected[i]) < 0.015, `loud at ${onset} instead of ${expected[i]}`);
    return sound.codec;
}

for (const container of ["MP4", "WebM"]) {
    const name = `the sound of a clip is in its video, in step with the frames: ${container}`;
    test(name, async (t) => {
        const onlyWebM = () => {
            const ask = VideoEncoder.isConfigSupported;
            VideoEncoder.isConfigSupported = async (config) =>
                config.codec.startsWith("avc") ? { supported: false } : ask.call(VideoEncoder, config);
        };
        const { page, problems } = await openLoud(t, container === "WebM" ? onlyWebM : undefined);
        await offers(page, `24 pictures.* With the clip’s sound, (AAC|Opus)\\.$`);
        if (!(await text(page, "video-format")).startsWith(container)) {
            return t.skip(`this browser makes no ${container}`);
        }
        const codec = await inStep(t, await download(page, "export-video"));
        assert.match(codec, container === "MP4" ? /^(aac|opus)$/ : /^opus$/);
        assert.match(await text(page, "export-status"), /is saved: 24 pictures, .*, sound in (AAC|Opus)$/);
        assert.deepEqual(problems, []);
    });
}

test("a video without sound is what was asked for, or the page has said so", async (t) => {
    const { page, problems } = await openLoud(t);
    await offers(page, "With the clip’s sound");
    await page.selectOption("#video-frames", "one");
    await offers(page, "or less\\.$");
    assert.equal(await page.isVisible("#video-sound"), false);
    await page.selectOption("#video-frames", "clip");
    await offers(page, "With the clip’s sound");
    await page.uncheck("#video-sound");
    await offers(page, "or less\\.$");
    assert.equal(await reader.sound(await download(page, "export-video")), null);
    assert.deepEqual(problems, []);

    const noEncoder = () => {
        AudioEncoder.isConfigSupported = async () => ({ supported: false });
    };
    const silent = await openLoud(t, noEncoder);
    await offers(silent.page, "Without the clip’s sound, because this browser cannot encode it");
    assert.equal(await reader.sound(await download(silent.page, "export-video")), null);
    assert.deepEqual(silent.problems, []);
});

test("a sound that cannot be decoded is an error that names the remedy", async (t) => {
    const broken = folder();
    const sound = join(broken, "noise.wav");
    writeFileSync(sound, Buffer.alloc(1000, 7));
    pcmvs("pack", clip, "--manifest", "-o", join(broken, "clip"), "--audio", sound);
    const { page } = await openClip(t, { from: join(broken, "clip") });
    await setPictures(page, 160, 120, "white");
    await offers(page, "With the clip’s sound");
    await page.click("#export-video");
    await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
    assert.match(await text(page, "errors"), /cannot decode it: .* clear “Sound of the clip”/);
    assert.equal(await text(page, "export-status"), "The export failed. Nothing was kept.");
});
