// Pictures with a mask, and measures of how much two of them differ.
import { PNG } from "pngjs";

/** Our own picture. Its mask is where it is not transparent. */
export function ours(png) {
    const { width, data } = PNG.sync.read(png);
    return {
        width,
        rgb: (i, k) => data[4 * i + k],
        mask: Array.from({ length: data.length / 4 }, (_, i) => data[4 * i + 3] > 0),
    };
}

/**
 * A player's picture, made of what it shows on black and on white: their difference is how much the background shows
 * through. A pixel is in the mask if at least half of it is mesh.
 */
export function shown(onBlack, onWhite) {
    const [{ width, data: black }, { data: white }] = [onBlack, onWhite].map((png) => PNG.sync.read(png));
    const left = (i) =>
        white[4 * i] - black[4 * i] + white[4 * i + 1] - black[4 * i + 1] + white[4 * i + 2] - black[4 * i + 2];
    return {
        width,
        rgb: (i, k) => black[4 * i + k],
        mask: Array.from({ length: black.length / 4 }, (_, i) => left(i) <= (3 * 255) / 2),
    };
}

/** A player's picture on pure green, a colour that our meshes do not have. Its edges are less exact than `shown`'s. */
export function onGreen(png) {
    const { width, data } = PNG.sync.read(png);
    const far = (i) => Math.max(data[4 * i], 255 - data[4 * i + 1], data[4 * i + 2]) > 127;
    return { width, mask: Array.from({ length: data.length / 4 }, (_, i) => far(i)) };
}

/** Intersection over union of two masks. */
export function overlap(a, b) {
    const count = (test) => a.mask.reduce((sum, m, i) => sum + test(m, b.mask[i]), 0);
    return count((m, n) => m && n) / count((m, n) => m || n);
}

/** PSNR of the colours in both masks, without the outermost pixels, where players blend them with the background. */
export function psnr(a, b) {
    const [w, n] = [a.width, a.mask.length];
    const around = [-w - 1, -w, -w + 1, -1, 0, 1, w - 1, w, w + 1];
    const inner = (mask, i) => around.every((step) => mask[i + step]);
    let [sum, count] = [0, 0];
    for (let i = 0; i < n; i++) {
        if (!inner(a.mask, i) || !inner(b.mask, i)) continue;
        for (let k = 0; k < 3; k++, count++) sum += (a.rgb(i, k) - b.rgb(i, k)) ** 2;
    }
    return 10 * Math.log10(255 ** 2 / (sum / count));
}

/** PSNR of two screenshots; infinite if they are equal. */
export function alike(a, b) {
    const [first, second] = [a, b].map((png) => PNG.sync.read(png).data);
    const sum = first.reduce((sum, value, i) => sum + (value - second[i]) ** 2, 0);
    return 10 * Math.log10(255 ** 2 / (sum / first.length));
}

/** The mask upside down, and mirrored. */
export function flipped({ width, mask }) {
    return [
        { mask: mask.map((_, i) => mask[mask.length - width - i + 2 * (i % width)]) },
        { mask: mask.map((_, i) => mask[i - 2 * (i % width) + width - 1]) },
    ];
}
