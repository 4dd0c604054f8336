// <model-viewer>: attributes alone. `orientation` is what turns the clip's upward direction to +y.
import { ModelViewerElement } from "@google/model-viewer";

// Or it would show fewer pixels where drawing is slow.
ModelViewerElement.minimumRenderScale = 1;
const element = document.createElement("model-viewer");

export function open(stage, view) {
    element.style.cssText = `width: ${view.size}px; height: ${view.size}px`;
    const attributes = {
        "camera-target": view.target.map((v) => `${v}m`).join(" "),
        "camera-orbit": `${view.theta}rad ${view.phi}rad ${view.radius}m`,
        "field-of-view": `${view.fov}rad`,
        // By itself it lets nobody see a model smaller than it thinks fit.
        "max-camera-orbit": `auto auto ${view.radius}m`,
        "max-field-of-view": `${view.fov}rad`,
        "interaction-prompt": "none",
    };
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    // Without its progress bar, which lies over the picture.
    element.innerHTML = '<div slot="progress-bar"></div>';
    stage.append(element);
}

export async function show(address, [x, y, z]) {
    const loaded = new Promise((done, failed) => {
        element.addEventListener("load", done, { once: true });
        element.addEventListener(
            "error",
            (event) => failed(new Error(event.detail?.sourceError ?? event.detail?.type)),
            { once: true },
        );
    });
    // Roll about z takes x out of it, then pitch about x takes z out of it.
    const [roll, pitch] = [Math.atan2(x, y), -Math.atan2(z, Math.hypot(x, y))];
    element.orientation = `${roll}rad ${pitch}rad 0rad`;
    element.src = address;
    await loaded;
    element.jumpCameraToGoal();
    for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
}
