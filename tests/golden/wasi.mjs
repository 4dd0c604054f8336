// node wasi.mjs MODULE PRESET DETAIL CAPTURE RECORD: runs a WebAssembly program in Node. It reads CAPTURE from the current
// folder and writes RECORD there.
import { readFile, writeFile } from "node:fs/promises";
import process from "node:process";
import { run } from "./page/run.js";

const [path, ...args] = process.argv.slice(2);
const [capture, record] = args.slice(-2);
const { status, printed, text } = await run(
    await WebAssembly.compile(await readFile(path)),
    args,
    await readFile(capture),
);
if (printed) console.error(printed);
process.exitCode = status;
if (status === 0) await writeFile(record, text);
