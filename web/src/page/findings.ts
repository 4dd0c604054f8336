// What the library found out about the views of all frames, as a list of warnings.

import type { Clip } from "../clip/clip";
import { $ } from "./dom";
import { strip } from "./view";

/** Lists the warnings of all frames. A click shows the frame and looks through the camera. */
export function listWarnings(clip: Clip) {
    const several = clip.frames.length > 1;
    const items = clip.frames.flatMap(({ index, findings }, position) =>
        (findings?.warnings ?? []).map(({ code, camera, message }) => {
            const where = [...(several ? [`frame ${index}`] : []), ...(camera === null ? [] : [`camera ${camera}`])];
            return warningItem(code, [...where, message].join(": "), () => {
                clip.play(false);
                void clip.show(position);
                if (camera !== null) strip.lookAt(camera);
            });
        }),
    );
    $("warnings-section").hidden = items.length === 0;
    $("warnings-title").textContent = items.length === 1 ? "1 warning" : `${items.length} warnings`;
    $("warnings").replaceChildren(...items);
}

/** A warning in a list. Without anything to show it is only text. */
export function warningItem(code: string, text: string, show: (() => void) | null): HTMLLIElement {
    const part = document.createElement(show ? "button" : "p");
    if (part instanceof HTMLButtonElement) part.type = "button";
    part.dataset.code = code;
    part.textContent = text;
    if (show) part.addEventListener("click", show);
    const item = document.createElement("li");
    item.append(part);
    return item;
}
