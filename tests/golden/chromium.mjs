// node chromium.mjs MODULE PRESET DETAIL CAPTURE RECORD: runs a WebAssembly program on a page in Chromium. It reads CAPTURE
// from the current folder and writes RECORD there.
import { writeFile } from "node:fs/promises";
import { basename, dirname } from "node:path";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { launch, openPage, serve } from "../web/site.mjs";

const [path, ...args] = process.argv.slice(2);
const record = args.at(-1);
const page = fileURLToPath(new URL("page", import.meta.url));
const shim = fileURLToPath(new URL("node_modules/@bjorn3/browser_wasi_shim/dist", import.meta.url));
const server = await serve({ "/": page, "/shim/": shim, "/module/": dirname(path), "/folder/": process.cwd() });
const browser = await launch();
try {
    const opened = await openPage(browser, server.address);
    await opened.page.waitForFunction(() => window.run);
    const { status, printed, text } = await opened.page.evaluate(
        ([module, args]) => window.run(module, args),
        [basename(path), args],
    );
    if (printed) console.error(printed);
    if (opened.problems.length > 0) throw new Error(opened.problems.join("\n"));
    process.exitCode = status;
    if (status === 0) await writeFile(record, text);
} finally {
    await browser.close();
    server.close();
}
