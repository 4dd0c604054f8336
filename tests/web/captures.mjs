// Frames of the sample with small pictures as captures of other programs, and captures with faults.
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { decode, encode } from "fast-png";
import { sample } from "./site.mjs";
import { small } from "./small.mjs";

export { small };
export const scene = JSON.parse(readFileSync(join(small, "scene.json"), "utf8"));

export const folder = () => mkdtempSync(join(tmpdir(), "pcmvs-web-"));

/** So many cameras, which are neighbours, are enough to check a calibration, in half the time of all. */
export const ARC = 12;

/** A scene folder with some of the frames and the first `count` cameras. `change` can introduce faults. */
export function capture(frames = [0], change = () => {}, count = scene.cameras.length, from = small) {
    const to = folder();
    const copy = JSON.parse(readFileSync(join(from, "scene.json"), "utf8"));
    copy.cameras.length = count;
    copy.frames = frames.map((i) => copy.frames[i]);
    for (const frame of copy.frames) frame.images.length = frame.masks.length = count;
    for (const path of copy.frames.flatMap((frame) => [...frame.images, ...frame.masks]))
        cpSync(join(from, path), join(to, path));
    change(copy, to);
    writeFileSync(join(to, "scene.json"), JSON.stringify(copy));
    return to;
}

/** The same with the sample's own pictures. */
export const wholeCapture = (frames, change, count) => capture(frames, change, count, sample);

/** A fault of a capture: all masks of a frame lack the upper third of the person. */
export const lackingIn = (position) => (copy, to) => {
    for (const path of copy.frames[position].masks) {
        const mask = decode(readFileSync(join(to, path)));
        const { width, height, channels } = mask;
        const levels = Uint8Array.from({ length: width * height }, (_, i) => mask.data[i * channels]);
        const isInside = (y) => levels.subarray(y * width, (y + 1) * width).some((level) => level > 127);
        const inside = Array.from({ length: height }, (_, y) => y).filter(isInside);
        for (const y of inside.slice(0, inside.length / 3)) levels.fill(0, y * width, (y + 1) * width);
        writeFileSync(join(to, path), encode({ width, height, data: levels, channels: 1, depth: 8 }));
    }
};

/** Turns a camera of a scene about its vertical axis or its horizontal one, by so many pixels in its picture's middle. */
export function bump(camera, pixels, axis = "vertical") {
    const angle = pixels / camera.K[0][0];
    const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
    const turned = ([x, y, z]) =>
        axis === "vertical"
            ? [cosine * x + sine * z, y, cosine * z - sine * x]
            : [x, cosine * y + sine * z, cosine * z - sine * y];
    const columns = [0, 1, 2].map((j) => turned(camera.R.map((row) => row[j])));
    camera.R = [0, 1, 2].map((i) => columns.map((column) => column[i]));
    camera.t = turned(camera.t);
}

function pictures(to) {
    for (const kind of ["images", "masks"]) mkdirSync(join(to, kind));
    scene.cameras.forEach((camera, i) => {
        cpSync(join(small, scene.frames[0].images[i]), join(to, "images", `${camera.name}.jpg`));
        cpSync(join(small, scene.frames[0].masks[i]), join(to, "masks", `${camera.name}.png`));
    });
}

export function middlebury() {
    const to = folder();
    pictures(to);
    const lines = scene.cameras.map((c) => [`${c.name}.jpg`, ...c.K.flat(), ...c.R.flat(), ...c.t].join(" "));
    writeFileSync(join(to, "figure_par.txt"), [lines.length, ...lines, ""].join("\n"));
    return to;
}

export function colmap() {
    const to = folder();
    pictures(to);
    mkdirSync(join(to, "sparse"));
    const cameras = scene.cameras.map(
        (c, i) =>
            `${i + 1} PINHOLE ${c.width} ${c.height} ${c.K[0][0]} ${c.K[1][1]} ${c.K[0][2] + 0.5} ${c.K[1][2] + 0.5}`,
    );
    const images = scene.cameras.flatMap((c, i) => [
        `${i + 1} ${quaternion(c.R).join(" ")} ${c.t.join(" ")} ${i + 1} ${c.name}.jpg`,
        "",
    ]);
    writeFileSync(join(to, "sparse/cameras.txt"), ["# cameras", ...cameras, ""].join("\n"));
    writeFileSync(join(to, "sparse/images.txt"), ["# images", ...images, ""].join("\n"));
    return to;
}

export function transforms() {
    const to = folder();
    pictures(to);
    const frames = scene.cameras.map((c) => {
        const back = [0, 1, 2].map((i) => [0, 1, 2].map((j) => c.R[j][i]));
        const centre = back.map((row) => -row.reduce((sum, v, j) => sum + v * c.t[j], 0));
        const rows = back.map((row, i) => [row[0], -row[1], -row[2], centre[i]]);
        return {
            file_path: `./images/${c.name}.jpg`,
            fl_x: c.K[0][0],
            fl_y: c.K[1][1],
            cx: c.K[0][2] + 0.5,
            cy: c.K[1][2] + 0.5,
            w: c.width,
            h: c.height,
            transform_matrix: [...rows, [0, 0, 0, 1]],
        };
    });
    writeFileSync(join(to, "transforms.json"), JSON.stringify({ camera_model: "PINHOLE", frames }));
    return to;
}

export function opencv() {
    const to = folder();
    pictures(to);
    const matrix = (rows) =>
        `!!opencv-matrix\n   rows: ${rows.length}\n   cols: ${rows[0].length}\n   dt: d\n   data: [ ${rows.flat().join(", ")} ]`;
    for (const c of scene.cameras) {
        const lines = [
            `camera_matrix: ${matrix(c.K)}`,
            `R: ${matrix(c.R)}`,
            `T: ${matrix(c.t.map((v) => [v]))}`,
            `image_width: ${c.width}`,
            `image_height: ${c.height}`,
        ];
        writeFileSync(join(to, `${c.name}.yml`), ["%YAML:1.0", "---", ...lines, ""].join("\n"));
    }
    return to;
}

/** A folder as a zip with compressed entries. `limit` is the size above which Python's zipfile uses the 64-bit form. */
export function zipped(source, limit = 2 ** 31) {
    const to = join(folder(), "capture.zip");
    const program = `import shutil, sys, zipfile
zipfile.ZIP64_LIMIT = ${limit}
shutil.make_archive(sys.argv[1][:-4], "zip", sys.argv[2])`;
    execFileSync("python3", ["-c", program, to, source]);
    return to;
}

/** A rotation matrix as a quaternion w, x, y, z. */
function quaternion(r) {
    const trace = r[0][0] + r[1][1] + r[2][2];
    if (trace > 0) {
        const s = 2 * Math.sqrt(1 + trace);
        return [s / 4, (r[2][1] - r[1][2]) / s, (r[0][2] - r[2][0]) / s, (r[1][0] - r[0][1]) / s];
    }
    const i = [0, 1, 2].reduce((a, b) => (r[b][b] > r[a][a] ? b : a));
    const [j, k] = [(i + 1) % 3, (i + 2) % 3];
    const s = 2 * Math.sqrt(1 + r[i][i] - r[j][j] - r[k][k]);
    const q = [(r[k][j] - r[j][k]) / s, 0, 0, 0];
    q[1 + i] = s / 4;
    q[1 + j] = (r[j][i] + r[i][j]) / s;
    q[1 + k] = (r[k][i] + r[i][k]) / s;
    return q;
}
