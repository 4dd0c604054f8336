// The forms of a mesh in a player, without a rotation of the player's own. The folder has forms.json (names and required
// PSNR), forms/NAME (clips of one frame, upright), and ours/forms/NAME.png (our own picture of the same mesh before it was
// compressed and turned upright).
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { flipped, ours, overlap, psnr, shown } from "./compare.mjs";

/** Required overlap of the silhouettes. */
const OVERLAP = 0.97;

const json = (...path) => JSON.parse(readFileSync(join(...path)));

/** The folders that a page must reach. */
export const folders = (folder) => json(folder, "forms.json").map(({ name }) => `forms/${name}`);

/** Shows each form in a player and compares it with our picture. `see` takes a picture on a background. */
export async function lookAtForms(folder, shots, { name: player, show, see }) {
    const measured = [];
    for (const { name, required } of json(folder, "forms.json")) {
        const { frames, up } = json(folder, "forms", name, "sequence.json");
        await show(`/forms/${name}/${frames[0].url}`);
        const [black, white] = [await see("black"), await see("white")];
        writeFileSync(join(shots, `${player}-${name}.png`), white);
        const [seen, ownPicture] = [shown(black, white), ours(readFileSync(join(folder, "ours/forms", `${name}.png`)))];
        measured.push({
            name,
            required,
            up,
            overlap: overlap(seen, ownPicture),
            mirrored: Math.max(...flipped(seen).map((other) => overlap(other, ownPicture))),
            psnr: psnr(seen, ownPicture),
        });
    }
    return measured;
}

/** What a form lacks. */
export function missed({ name, required, up, overlap, mirrored, psnr }) {
    const wrong = [];
    if (up.join() !== "0,1,0") wrong.push(`${name}: its manifest says that up is ${up}`);
    if (!(overlap >= OVERLAP)) wrong.push(`${name}: silhouettes overlap by ${overlap.toFixed(3)}, not ${OVERLAP}`);
    if (!(mirrored < OVERLAP)) wrong.push(`${name}: is its own mirror image, and so this does not show where up is`);
    if (!(psnr >= required)) wrong.push(`${name}: colours are at ${psnr.toFixed(1)} dB, not ${required}`);
    return wrong;
}
