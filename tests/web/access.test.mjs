// The page for everybody: contrast, labels, keys, touch, small screens.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { test } from "node:test";
import { ARC, bump, capture } from "./captures.mjs";
import { check, drive, run, text, view } from "./site.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
const { openWith } = drive();

/** The problems that axe finds, in words. */
async function violations(page) {
    if (!(await page.evaluate(() => "axe" in window))) await page.addScriptTag({ path: AXE });
    const found = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
    return found.violations.flatMap(({ id, help, nodes }) =>
        nodes.map(
            (node) =>
                `${id}: ${help}: ${node.target} ${node.any
                    .concat(node.all)
                    .map((check) => check.message)
                    .join("; ")}`,
        ),
    );
}

for (const [device, options] of Object.entries({ desktop: {}, phone: PHONE })) {
    test(`${device}, dark and light: labels, roles and contrast`, async (t) => {
        const moved = capture([0], (s) => bump(s.cameras[3], 10), ARC);
        // The page's policy would not let axe in.
        const { page, problems, shot } = await openWith(t, moved, { options: { ...options, bypassCSP: true } });
        const found = [];
        const look = async (state) => {
            for (const colorScheme of ["dark", "light"]) {
                await page.emulateMedia({ colorScheme });
                await page.evaluate(() => new Promise(requestAnimationFrame));
                await shot(`${device}-${colorScheme}-${state}`);
                for (const problem of await violations(page)) found.push(`${colorScheme}, ${state}: ${problem}`);
            }
        };
        await look("ready");
        await run(page);
        await check(page);
        await page.click("#calibration-figures summary");
        await look("checked");
        await page.evaluate(() => {
            for (const details of document.querySelectorAll("details")) details.open = true;
        });
        for (const kind of ["still", "video"]) {
            await page.selectOption(`#${kind}-size`, "own");
            await page.selectOption(`#${kind}-background`, "own");
        }
        await page.selectOption("#video-motion", "path");
        await page.click("#video-add");
        await look("exports");
        await page.selectOption("#silhouettes", "chroma");
        await page.click("#strip button:first-child");
        await page.waitForSelector("#photo:not([hidden])");
        await look("through");
        await page.click("#through-leave");
        await page.setInputFiles("#file-input", {
            name: "a.zip",
            mimeType: "application/zip",
            buffer: Buffer.from("none"),
        });
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
        await look("error");
        assert.deepEqual(found, []);
        assert.ok(
            await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth),
            "the page scrolls sideways",
        );
        assert.deepEqual(problems, []);
    });
}

test("the keyboard reaches every control, and each shows its focus", async (t) => {
    const { page } = await openWith(t, capture([0, 1]));
    await run(page);
    // Start at the first control, because tabbing continues from the last click.
    await page.focus("#back");
    await page.keyboard.press("Shift+Tab");
    const seen = [];
    for (let i = 0; i < 80; i++) {
        const focused = await page.evaluate(() => {
            const element = document.activeElement;
            if (!element || element === document.body) return null;
            // A control that another element draws shows its focus there.
            const places = [element, element.nextElementSibling, element.closest("#timeline")].filter(
                (e) => e !== null,
            );
            return {
                name: element.id || element.value || element.textContent,
                shown: places.some((e) => getComputedStyle(e).outlineStyle !== "none"),
            };
        });
        if (focused === null) break;
        seen.push(focused);
        await page.keyboard.press("Tab");
    }
    assert.deepEqual(
        seen.filter(({ shown }) => !shown),
        [],
    );
    const names = seen.map(({ name }) => name);
    for (const id of [
        "canvas",
        "play",
        "scrub",
        "speed",
        "loop",
        "pick-folder",
        "views",
        "run",
        "wireframe",
        "export-glb",
        "mesh",
        "colour",
    ])
        assert.ok(names.includes(id), `${id} is not among ${names}`);
    assert.ok(
        names.some((name) => name.startsWith("cam")),
        "no camera is reached",
    );
});

test("keys turn, zoom, step, play, change speed and loop", async (t) => {
    const { page, problems } = await openWith(t, capture([0, 1, 2]));
    await run(page);
    await page.focus("#canvas");
    if ((await page.getAttribute("#play", "aria-pressed")) === "true") await page.keyboard.press(" ");
    for (const key of ["d", "w", "+", "0", "m"]) {
        const before = await view(page);
        await page.focus("#canvas");
        await page.keyboard.press(key);
        await page.waitForTimeout(300);
        assert.notEqual(await view(page), before, `${key} does nothing`);
    }
    await page.focus("#canvas");
    const at = await text(page, "counter");
    await page.keyboard.press("ArrowRight");
    assert.notEqual(await text(page, "counter"), at);
    await page.keyboard.press("ArrowLeft");
    assert.equal(await text(page, "counter"), at);
    await page.keyboard.press("l");
    assert.equal(await page.getAttribute("#loop", "aria-pressed"), "false");
    await page.selectOption("#speed", "2");
    await page.focus("#canvas");
    await page.keyboard.press(" ");
    // Without looping the clip ends at its last frame.
    await page.waitForFunction(() => document.getElementById("play").getAttribute("aria-pressed") === "false");
    assert.equal(await text(page, "counter"), "3 / 3");
    assert.deepEqual(problems, []);
});

test("touch turns and zooms on a phone", async (t) => {
    const { page, problems, shot } = await openWith(t, capture([0]), { options: PHONE });
    await run(page);
    await shot("phone-done");
    const client = await page.context().newCDPSession(page);
    const touch = async (type, points) => {
        await client.send("Input.dispatchTouchEvent", {
            type,
            touchPoints: points.map(([x, y], id) => ({ x, y, id })),
        });
        await page.waitForTimeout(30);
    };
    const gesture = async (...steps) => {
        const before = await view(page);
        await page.evaluate(() => scrollTo(0, 0));
        await touch("touchStart", steps[0]);
        for (const step of steps.slice(1)) await touch("touchMove", step);
        await touch("touchEnd", []);
        await page.waitForTimeout(500);
        assert.notEqual(await view(page), before);
    };
    await gesture([[120, 250]], [[170, 250]], [[240, 260]]);
    await gesture(
        [
            [150, 250],
            [240, 250],
        ],
        [
            [120, 250],
            [270, 250],
        ],
        [
            [80, 250],
            [310, 250],
        ],
    );
    assert.deepEqual(problems, []);
});
