// Fails if the Khronos validator finds an error or a warning in any of the GLB files named.
import { readFile } from "node:fs/promises";
import process from "node:process";
import validator from "gltf-validator";

const files = process.argv.slice(2);
if (files.length === 0) {
    console.error("usage: node validate.mjs FILE.glb...");
    process.exit(2);
}
let bad = 0;
for (const file of files) {
    const report = await validator.validateBytes(new Uint8Array(await readFile(file)), { uri: file });
    const { numErrors, numWarnings, messages } = report.issues;
    bad += numErrors + numWarnings;
    for (const { severity, code, message, pointer } of messages) {
        console.log(`${file}: ${["error", "warning", "info", "hint"][severity]} ${code} ${pointer ?? ""}: ${message}`);
    }
    const { totalVertexCount, totalTriangleCount } = report.info;
    console.log(
        `${file}: ${numErrors} errors, ${numWarnings} warnings, ${totalVertexCount} vertices, ${totalTriangleCount} faces`,
    );
}
process.exit(bad === 0 ? 0 : 1);
