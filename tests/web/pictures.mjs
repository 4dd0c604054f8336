// Videos and pictures, read again by somebody else's reader.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { folder } from "./captures.mjs";
import { openPage, serve } from "./site.mjs";

const library = fileURLToPath(new URL("node_modules/mediabunny/dist/bundles", import.meta.url));

/** A page that reads videos and pictures, and what closes it. */
export async function openReader(browser) {
    const root = folder();
    writeFileSync(join(root, "index.html"), "<!doctype html><title>Reader</title>");
    writeFileSync(join(root, "favicon.ico"), "");
    const site = await serve({ "/": root, "/lib/": library });
    const { page } = await openPage(browser, site.address);
    await page.evaluate(defineTools);
    const close = async () => {
        await page.context().close();
        await site.close();
    };
    const call = (name, ...args) =>
        page.evaluate(
            ([name, args]) => globalThis[name](...args),
            [name, args.map((arg) => (Buffer.isBuffer(arg) ? arg.toString("base64") : arg))],
        );
    return {
        close,
        /**
         * What is in a video: its container, codec, size, pictures and their times, and how a `<video>` element sees it.
         * `likeness` has the ratio in dB of each still and the picture at its number: [[number, still]].
         */
        async video(bytes, stills = []) {
            const pairs = stills.map(([at, still]) => [at, still.toString("base64")]);
            return call("readVideo", bytes, pairs);
        },
        /**
         * The sound in a video: its codec, when its track begins and ends, and when it is loud for the first time after at least
         * 50 ms of silence. Null without sound.
         */
        sound: (bytes) => call("readSound", bytes),
        /** Size of a picture, and the alpha of its corner and its middle, and the colour of its corner. */
        picture: (bytes) => call("readPicture", bytes),
        /** The peak signal-to-noise ratio of two pictures in dB. */
        likeness: (a, b) => call("compare", a, b),
    };
}

function defineTools() {
    const blobOf = async (data, type) =>
        new Blob([await (await fetch(`data:${type};base64,${data}`)).arrayBuffer()], { type });
    const contextOf = (width, height) =>
        new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    async function pixels(png) {
        const bitmap = await createImageBitmap(await blobOf(png, "image/png"));
        const context = contextOf(bitmap.width, bitmap.height);
        context.drawImage(bitmap, 0, 0);
        return context.getImageData(0, 0, bitmap.width, bitmap.height);
    }
    function ratio(a, b) {
        if (a.width !== b.width || a.height !== b.height) return Number.NaN;
        let sum = 0;
        for (let i = 0; i < a.data.length; i++) if (i % 4 < 3) sum += (a.data[i] - b.data[i]) ** 2;
        return 10 * Math.log10(255 ** 2 / Math.max(1e-9, sum / (a.width * a.height * 3)));
    }
    globalThis.compare = async (a, b) => ratio(await pixels(a), await pixels(b));
    globalThis.readPicture = async (png) => {
        const { width, height, data } = await pixels(png);
        const middle = 4 * (Math.floor(height / 2) * width + Math.floor(width / 2));
        return { size: [width, height], corner: [...data.slice(0, 4)], middle: data[middle + 3] };
    };
    globalThis.readSound = async (data) => {
        const { Input, BlobSource, ALL_FORMATS } = await import("/lib/mediabunny.mjs");
        const blob = await blobOf(data, "video/any");
        const input = new Input({ source: new BlobSource(blob), formats: ALL_FORMATS });
        const track = await input.getPrimaryAudioTrack();
        if (!track) return null;
        const [begin, end] = [await track.getFirstTimestamp(), await track.computeDuration()];
        // Decoded as the browser plays it.
        const rate = 48_000;
        const decoded = await new OfflineAudioContext(1, 1, rate).decodeAudioData(await blob.arrayBuffer());
        const onsets = [];
        let silent = Number.POSITIVE_INFINITY;
        for (const [i, value] of decoded.getChannelData(0).entries()) {
            const loud = Math.abs(value) > 0.1;
            if (loud && silent > 0.05 * rate) onsets.push(i / rate);
            silent = loud ? 0 : silent + 1;
        }
        const { codec, numberOfChannels, sampleRate } = track;
        return { codec, channels: numberOfChannels, rate: sampleRate, begin, end, onsets, seconds: decoded.duration };
    };
    globalThis.readVideo = async (data, stills) => {
        const { Input, BlobSource, ALL_FORMATS, VideoSampleSink } = await import("/lib/mediabunny.mjs");
        const blob = await blobOf(data, "video/any");
        const input = new Input({ source: new BlobSource(blob), formats: ALL_FORMATS });
        const track = await input.getPrimaryVideoTrack();
        const given = [];
        for (const [at, still] of stills) given.push([at, await pixels(still)]);
        const read = { times: [], likeness: [] };
        for await (const sample of new VideoSampleSink(track).samples()) {
            const at = read.times.length;
            read.times.push(sample.timestamp);
            const context = contextOf(track.displayWidth, track.displayHeight);
            sample.draw(context, 0, 0);
            const picture = context.getImageData(0, 0, track.displayWidth, track.displayHeight);
            for (const [i, [number, still]] of given.entries()) {
                if (number === at) read.likeness[i] = ratio(picture, still);
            }
            sample.close();
        }
        const element = document.createElement("video");
        element.src = URL.createObjectURL(blob);
        await new Promise((resolve, reject) => {
            element.onloadeddata = resolve;
            element.onerror = () => reject(new Error(element.error.message));
        });
        return {
            ...read,
            container: (await input.getFormat()).name,
            codec: track.codec,
            size: [track.displayWidth, track.displayHeight],
            duration: await input.computeDuration(),
            element: { size: [element.videoWidth, element.videoHeight], duration: element.duration },
        };
    };
}
