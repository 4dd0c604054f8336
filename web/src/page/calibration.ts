// The calibration: what its check found, and which cameras are used.

import { $ } from "./dom";
import { warningItem } from "./findings";
import { type Checked, type Source, state } from "./state";
import { strip } from "./view";

const IN_USE = "The refined cameras are used: reconstructions are made with them.";

/** Shows the last check of the capture, if its result still is about the cameras that are used or offered. */
export function showCalibration() {
    const source = state.capture?.source ?? null;
    const checked = source && source.checked?.cameras === source.scene.cameras ? source.checked : null;
    const refined = source ? refinedCameras(source) : null;
    const inUse = source !== null && source.given !== null;
    $("calibration-section").hidden = !checked && !inUse;
    $("calibration-summary").textContent = [...(inUse ? [IN_USE] : []), ...(checked ? [checked.summary] : [])].join(
        " ",
    );
    const warnings = checked?.warnings ?? [];
    const items = warnings.map(({ code, camera, message }) =>
        camera === null
            ? warningItem(code, message, null)
            : warningItem(code, `camera ${camera}: ${message}`, () => strip.lookAt(camera)),
    );
    $("calibration-warnings").replaceChildren(...items);
    strip.markChecked(warnings);
    $("use-refined").hidden = !checked?.refined;
    $("use-given").hidden = !inUse;
    $("save-refined").hidden = !refined;
    $("calibration-figures").hidden = !checked;
    ($("calibration-figures").querySelector("tbody") as HTMLElement).replaceChildren(...(checked ? rows(checked) : []));
}

/** The refined cameras that are offered or else used. */
export const refinedCameras = ({ scene, given, checked }: Source) =>
    (checked?.cameras === scene.cameras ? checked.refined : null) ?? (given ? scene.cameras : null);

const digits = (value: number | null) => value?.toFixed(2) ?? "–";

/** One row per camera: what is given, and what is refined. */
function rows({ cameras, reports }: Checked): HTMLElement[] {
    return reports.map(({ given, refined, movedPx }, i) => {
        const row = document.createElement("tr");
        const name = document.createElement("th");
        name.scope = "row";
        name.textContent = name.title = cameras[i].name;
        const change = (of: "contourPx" | "epipolarPx") => `${digits(given[of])} → ${digits(refined[of])}`;
        const cells = [change("contourPx"), change("epipolarPx"), digits(movedPx)].map((text) => {
            const cell = document.createElement("td");
            cell.textContent = text;
            return cell;
        });
        row.append(name, ...cells);
        return row;
    });
}
