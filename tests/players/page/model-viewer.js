// <model-viewer>: only attributes are used. `orientation` turns the clip's upward direction to +y.
import { ModelViewerElement } from "@google/model-viewer";

// Otherwise it reduces its resolution where drawing is slow.
ModelViewerElement.minimumRenderScale = 1;
// It has no decoder of EXT_meshopt_compression without this.
ModelViewerElement.meshoptDecoderLocation = "/node_modules/meshoptimizer/meshopt_decoder.cjs";
const element = document.createElement("model-viewer");

export function open(stage, view) {
    element.style.cssText = `width: ${view.size}px; height: ${view.size}px`;
    const attributes = {
        "camera-target": view.target.map((v) => `${v}m`).join(" "),
        "camera-orbit": `${view.theta}rad ${view.phi}rad ${view.radius}m`,
        "field-of-view": `${view.fov}rad`,
        // Its default limits keep a small model from being shown small.
        "max-camera-orbit": `auto auto ${view.radius}m`,
        "max-field-of-view": `${view.fov}rad`,
        "interaction-prompt": "none",
    };
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    // This replaces its progress bar, which would cover the picture.
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
    // Rolling around z makes x zero, then pitching around x makes z zero.
    const [roll, pitch] = [Math.atan2(x, y), -Math.atan2(z, Math.hypot(x, y))];
    element.orientation = `${roll}rad ${pitch}rad 0rad`;
    element.src = address;
    await loaded;
    element.jumpCameraToGoal();
    for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
}

export async function seek(seconds) {
    element.play();
    element.pause();
    element.currentTime = seconds;
    for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
}
