// Fails if the Khronos validator finds an error or a warning in any of the GLB files named. Compressed files are validated as
// they are and decompressed, because the validator cannot look into them.
import { readFile } from "node:fs/promises";
import process from "node:process";
import validator from "gltf-validator";
import { decompressed } from "./decompressed.mjs";

const files = process.argv.slice(2);
if (files.length === 0) {
    console.error("usage: node validate.mjs FILE.glb...");
    process.exit(2);
}
let bad = 0;
for (const file of files) {
    const bytes = new Uint8Array(await readFile(file));
    await validate(file, bytes);
    const plain = await decompressed(bytes);
    if (plain) await validate(`${file}, decompressed`, plain);
}
process.exit(bad === 0 ? 0 : 1);

async function validate(name, bytes) {
    const report = await validator.validateBytes(bytes, { uri: name });
    const { numErrors, numWarnings, messages } = report.issues;
    bad += numErrors + numWarnings;
    for (const { severity, code, message, pointer } of messages) {
        console.log(`${name}: ${["error", "warning", "info", "hint"][severity]} ${code} ${pointer ?? ""}: ${message}`);
    }
    const { totalVertexCount, totalTriangleCount } = report.info;
    console.log(
        `${name}: ${numErrors} errors, ${numWarnings} warnings, ${totalVertexCount} vertices, ${totalTriangleCount} faces`,
    );
}
