// Prints the browser's table of BENCHMARKS.md. Times are the best of three.
import { frameSeconds, large, longestTask, memory, sampleSeconds } from "./measure.mjs";
import { dist, ended, launch, openPage, serve } from "./site.mjs";

const TIMES = 3;
process.env.SHOTS = "README's picture of the page";
const site = await serve({ "/": dist });
const address = `${site.address}/`;
// Memory may be shared here, and the frame is made on all processors.
const isolated = await serve({ "/": dist }, true);

async function best(measure, key) {
    const seen = [];
    for (let i = 0; i < TIMES; i++) {
        // A new browser has nothing compiled or cached.
        const browser = await launch();
        seen.push(await measure(browser));
        await browser.close();
    }
    return seen.sort((a, b) => a[key] - b[key])[0];
}

const sample = await best((browser) => sampleSeconds(browser, address), "best");
const frame = await best((browser) => frameSeconds(browser, address, large()), "seconds");
const shared = await best((browser) => frameSeconds(browser, `${isolated.address}/`, large()), "seconds");
const own = await launch();
const task = await longestTask(own, () => sampleSeconds(own, address));
const { three, twenty } = await memory(own, address);
// README's picture of the page.
const { page, shot } = await openPage(own, address);
await ended(page);
await page.setViewportSize({ width: 1120, height: 700 });
await page.waitForTimeout(3000);
await shot("page");
await own.close();
site.close();
isolated.close();

const row = (...cells) => `| ${cells.join(" | ")} |`;
const s = (seconds) => seconds.toFixed(2);
console.log(
    [
        row("headless Chromium, pictures drawn by software", "s", "mark, s"),
        "|---|---:|---:|",
        row("sample, 20 views of 512 x 384, from opening the page: first, coarse hull seen", s(sample.hull), 1),
        row("preview seen", s(sample.preview), "–"),
        row("first frame finished", s(sample.best), 5),
        row("all 8 frames", s(sample.clip), "–"),
        row("20 views of 1024 x 768, one frame: command line, one thread", s(frame.native), "–"),
        row("page, the same reconstruction", s(frame.seconds), s(3 * frame.native)),
        row("the same on an isolated page, on all processors", s(shared.seconds), "–"),
        row("page, with hull and preview before it, until it ends", s(frame.all), s(3 * frame.native)),
        "",
        row("sample", "measured", "mark"),
        "|---|---:|---:|",
        row("longest task of the page's own thread, processor time", `${task.processor.toFixed(0)} ms`, "50 ms"),
        row("the same with waiting for pictures drawn by software", `${task.clock.toFixed(0)} ms`, "–"),
        row(
            "memory of all of the browser's processes after 3 reconstructions",
            `${(three / 2 ** 20).toFixed(0)} MiB`,
            "–",
        ),
        row("after 20", `${(twenty / 2 ** 20).toFixed(0)} MiB`, `${((1.1 * three) / 2 ** 20).toFixed(0)} MiB`),
    ].join("\n"),
);
