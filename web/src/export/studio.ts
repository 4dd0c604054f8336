// Draws pictures of any size off screen.

import { PerspectiveCamera, WebGLRenderer } from "three";
import { POINTS } from "../viewer/colours";
import type { SceneCopy, Standpoint } from "../viewer/copy";

/** What is behind the object: nothing, one colour, or the page's gradient. */
export type Background = { kind: "transparent" } | { kind: "colour"; css: string } | { kind: "page" };

export interface PictureSize {
    width: number;
    height: number;
}

/** Only one is made, because materials would keep each of them. It is made anew if its context has been lost. */
let renderer: WebGLRenderer | null = null;

function rendererOf({ width, height }: PictureSize): WebGLRenderer {
    if (renderer?.getContext().isContextLost()) renderer = null;
    renderer ??= new WebGLRenderer({ canvas: document.createElement("canvas"), antialias: true, alpha: true });
    renderer.setSize(width, height, false);
    const { drawingBufferWidth, drawingBufferHeight } = renderer.getContext();
    if (drawingBufferWidth !== width || drawingBufferHeight !== height) {
        const most = `${drawingBufferWidth} × ${drawingBufferHeight}`;
        throw new Error(`a picture of ${width} × ${height} is too large for this graphics card, which draws ${most}`);
    }
    return renderer;
}

/** Frees the memory of the last picture. */
export function release() {
    renderer?.setSize(1, 1, false);
}

/** Makes pictures of one size and background. */
export class Studio {
    private readonly canvas = document.createElement("canvas");
    private readonly context: CanvasRenderingContext2D;
    private readonly behind: string | CanvasGradient | null;
    private readonly camera = new PerspectiveCamera();

    constructor(
        private readonly shown: SceneCopy,
        private readonly size: PictureSize,
        background: Background,
    ) {
        Object.assign(this.canvas, size);
        const context = this.canvas.getContext("2d");
        if (!context) throw new Error(`there is no memory for a picture of ${size.width} × ${size.height}`);
        this.context = context;
        this.behind = background.kind === "page" ? pageGradient(context, size) : null;
        if (background.kind === "colour") this.behind = background.css;
        this.camera.matrixAutoUpdate = false;
        shown.lamp.matrixAutoUpdate = false;
    }

    /** Draws what the scene's copy shows. The next drawing replaces the picture. */
    draw({ pose, lamp, projection }: Standpoint): HTMLCanvasElement {
        const { context, camera, shown } = this;
        const { width, height } = this.size;
        camera.matrix.copy(pose);
        camera.projectionMatrix.copy(projection);
        camera.projectionMatrixInverse.copy(projection).invert();
        shown.lamp.matrix.copy(lamp);
        camera.matrixWorldNeedsUpdate = shown.lamp.matrixWorldNeedsUpdate = true;
        const drawing = rendererOf(this.size);
        // Points have a size in pixels.
        const { size } = POINTS;
        POINTS.size = (size * Math.min(width, height)) / shown.narrow;
        try {
            drawing.render(shown.scene, camera);
        } finally {
            POINTS.size = size;
        }
        if (drawing.getContext().isContextLost()) {
            throw new Error("the graphics card was reset while a picture was drawn: export again");
        }
        context.clearRect(0, 0, width, height);
        if (this.behind !== null) {
            context.fillStyle = this.behind;
            context.fillRect(0, 0, width, height);
        }
        context.drawImage(drawing.domElement, 0, 0);
        return this.canvas;
    }
}

/** The background of #stage in style.css. */
function pageGradient(context: CanvasRenderingContext2D, { width, height }: PictureSize): CanvasGradient {
    const style = getComputedStyle(document.documentElement);
    const [x, y] = [0.5 * width, 0.42 * height];
    const gradient = context.createRadialGradient(x, y, 0, x, y, Math.hypot(x, height - y));
    gradient.addColorStop(0, style.getPropertyValue("--glow").trim());
    gradient.addColorStop(0.68, style.getPropertyValue("--ground").trim());
    return gradient;
}

/** A single picture as PNG. */
export function png(shown: SceneCopy, size: PictureSize, background: Background): Promise<Blob> {
    const canvas = new Studio(shown, size, background).draw(shown.standpoint(size.width, size.height));
    shown.surface.dispose();
    release();
    return new Promise((resolve, reject) =>
        canvas.toBlob(
            (blob) => (blob ? resolve(blob) : reject(new Error("the picture cannot be made: choose a smaller size"))),
            "image/png",
        ),
    );
}
