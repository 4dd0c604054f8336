// Gray PNGs of 8 bits, without interlacing: the masks of the sample.
import { crc32, deflateSync, inflateSync } from "node:zlib";

const SIGNATURE = Buffer.from("\x89PNG\r\n\x1a\n", "latin1");

/** The levels of a picture by rows, and its size. */
export function readGray(file) {
    const data = [];
    let [width, height] = [0, 0];
    for (let at = SIGNATURE.length; at < file.length; ) {
        const size = file.readUInt32BE(at);
        const kind = file.toString("latin1", at + 4, at + 8);
        const body = file.subarray(at + 8, at + 8 + size);
        if (kind === "IHDR") [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
        if (kind === "IDAT") data.push(body);
        at += 12 + size;
    }
    const bytes = inflateSync(Buffer.concat(data));
    const levels = Buffer.alloc(width * height);
    for (let y = 0; y < height; y++) {
        const filter = bytes[y * (width + 1)];
        for (let x = 0; x < width; x++) {
            const left = x > 0 ? levels[y * width + x - 1] : 0;
            const above = y > 0 ? levels[(y - 1) * width + x] : 0;
            const corner = x > 0 && y > 0 ? levels[(y - 1) * width + x - 1] : 0;
            const expected = [0, left, above, (left + above) >> 1, nearest(left, above, corner)][filter];
            levels[y * width + x] = bytes[y * (width + 1) + 1 + x] + expected;
        }
    }
    return { levels, width, height };
}

/** The one of three neighbours that is nearest to their plane (PNG 3, 9.4). */
function nearest(left, above, corner) {
    const far = [left, above, corner].map((level) => Math.abs(left + above - corner - level));
    if (far[0] <= far[1] && far[0] <= far[2]) return left;
    return far[1] <= far[2] ? above : corner;
}

export function writeGray({ levels, width, height }) {
    const rows = Buffer.alloc(height * (width + 1));
    for (let y = 0; y < height; y++) levels.copy(rows, y * (width + 1) + 1, y * width, (y + 1) * width);
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width, 0);
    header.writeUInt32BE(height, 4);
    header[8] = 8;
    const chunk = (kind, data) => {
        const body = Buffer.concat([Buffer.from(kind, "latin1"), data]);
        const ends = [Buffer.alloc(4), Buffer.alloc(4)];
        ends[0].writeUInt32BE(data.length);
        ends[1].writeUInt32BE(crc32(body));
        return Buffer.concat([ends[0], body, ends[1]]);
    };
    const chunks = [chunk("IHDR", header), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))];
    return Buffer.concat([SIGNATURE, ...chunks]);
}
