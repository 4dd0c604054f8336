// The three-dimensional window of the element: a scene with the clip, a free camera, and WebXR.

import { type Box3, Group, Scene, Vector3, WebGLRenderer } from "three";
import { Flight } from "../viewer/flight";
import { Navigation } from "../viewer/navigation";
import type { ClipPlayer } from "./player";
import { ClipError } from "./take";

/** Where the clip stands in front of a person in XR, metres. */
const XR_DISTANCE = 2;
/** Metres of a scene's unit. Others are taken for metres. */
const METRES: Record<string, number> = { mm: 0.001, cm: 0.01, m: 1 };

export class Stage {
    readonly renderer: WebGLRenderer;
    private readonly flight: Flight;
    private readonly scene = new Scene();
    /** Moved in XR, where the origin is the person's own place. */
    private readonly world = new Group();
    private readonly navigation: Navigation;
    private readonly resized: ResizeObserver;
    private changed = true;
    private box: Box3 | null = null;

    constructor(
        private readonly canvas: HTMLCanvasElement,
        private readonly player: ClipPlayer,
    ) {
        try {
            this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
        } catch {
            throw new ClipError("this browser does not give WebGL 2 to this page: is it switched off?");
        }
        this.flight = new Flight(this.renderer.getContext() as WebGL2RenderingContext);
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.navigation = new Navigation(canvas, () => this.draw());
        this.world.add(player.object);
        this.scene.add(this.world);
        this.resized = new ResizeObserver(() => this.resize());
        this.resized.observe(canvas);
        this.renderer.xr.addEventListener("sessionstart", () => this.placeForXr(true));
        this.renderer.xr.addEventListener("sessionend", () => this.placeForXr(false));
        this.renderer.setAnimationLoop(() => this.step());
    }

    /** Draws with the next animation frame. */
    draw() {
        this.changed = true;
    }

    /** Stands back until a box is in the window as a whole. */
    frame(box: Box3) {
        this.box = box;
        this.navigation.frame(box, new Vector3(0, 0, 1));
        this.draw();
    }

    orbit(horizontal: number, vertical: number) {
        this.navigation.orbit(horizontal, vertical);
    }

    zoom(factor: number) {
        this.navigation.zoom(factor);
    }

    /** The kind of XR session that this device offers. */
    async xrMode(): Promise<XRSessionMode | null> {
        for (const mode of ["immersive-ar", "immersive-vr"] as const) {
            if (await navigator.xr?.isSessionSupported(mode).catch(() => false)) return mode;
        }
        return null;
    }

    /** Enters XR. Must be called while a click is handled. */
    async enterXr(mode: XRSessionMode) {
        const session = await navigator.xr?.requestSession(mode, { requiredFeatures: ["local-floor"] });
        if (!session) return;
        this.renderer.xr.enabled = true;
        this.renderer.xr.setReferenceSpaceType("local-floor");
        await this.renderer.xr.setSession(session);
    }

    dispose() {
        this.renderer.setAnimationLoop(null);
        this.resized.disconnect();
        this.navigation.dispose();
        this.world.remove(this.player.object);
        void this.renderer.xr.getSession()?.end();
        this.renderer.dispose();
    }

    private step() {
        const { isPresenting } = this.renderer.xr;
        // In XR the device asks for drawings when it is ready. Elsewhere frames that cannot be drawn in time are dropped.
        if (!isPresenting && this.flight.full) return;
        this.player.update();
        this.navigation.update();
        if (!this.changed && !isPresenting) return;
        this.changed = false;
        this.renderer.render(this.scene, this.navigation.camera);
        if (!isPresenting) this.flight.sent();
    }

    private resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (width === 0 || height === 0 || this.renderer.xr.isPresenting) return;
        this.renderer.setSize(width, height, false);
        this.navigation.setAspect(width / height);
        if (this.box) this.frame(this.box);
        this.draw();
    }

    private placeForXr(inXr: boolean) {
        this.world.position.set(0, 0, 0);
        this.world.scale.setScalar(1);
        if (inXr && this.box) {
            const metres = METRES[this.player.take?.units ?? "m"] ?? 1;
            const middle = this.box.getCenter(new Vector3());
            this.world.scale.setScalar(metres);
            this.world.position.set(-middle.x, -this.box.min.y, -middle.z).multiplyScalar(metres);
            this.world.position.z -= XR_DISTANCE;
        }
        this.renderer.xr.enabled = inXr;
        this.draw();
    }
}
