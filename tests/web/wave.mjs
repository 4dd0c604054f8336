// Sounds for clips.

/** A WAVE file with two equal channels of 16 bits. `value` gives the sample, -1 to 1, at a time in seconds. */
export function wave(seconds, rate, value) {
    const count = Math.round(seconds * rate);
    const bytes = Buffer.alloc(44 + 4 * count);
    bytes.write("RIFF");
    bytes.writeUInt32LE(bytes.length - 8, 4);
    bytes.write("WAVEfmt ", 8);
    for (const [at, number] of [
        [16, 16],
        [24, rate],
        [28, 4 * rate],
        [40, 4 * count],
    ])
        bytes.writeUInt32LE(number, at);
    for (const [at, number] of [
        [20, 1],
        [22, 2],
        [32, 4],
        [34, 16],
    ])
        bytes.writeUInt16LE(number, at);
    bytes.write("data", 36);
    for (let i = 0; i < count; i++) {
        const sample = Math.round(32_767 * value(i / rate));
        bytes.writeInt16LE(sample, 44 + 4 * i);
        bytes.writeInt16LE(sample, 46 + 4 * i);
    }
    return bytes;
}
