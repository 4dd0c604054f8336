// The cameras as a strip of pictures with their silhouettes, and the photograph over the view.
import type { Camera } from "pcmvs";
import { JobError, type Pool } from "./pool";
import type { Failure, PhotographResult, ViewFiles } from "./protocol";
import type { Viewer } from "./viewer";

const THUMBNAIL = 240;
const WHOLE = 4096;

export interface Rig {
    cameras: Camera[];
    files: (camera: number) => ViewFiles;
    /** Tint the silhouette into the photograph. */
    tinted: boolean;
}

export class Strip {
    private rig: Rig | null = null;
    /** Changes whenever pictures under way are no longer wanted. */
    private generation = 0;
    private photographs = 0;
    private readonly buttons: HTMLButtonElement[] = [];
    looking: number | null = null;
    onlook: (camera: number | null) => void = () => {};
    onproblem: (failure: Failure) => void = () => {};

    constructor(
        private readonly root: HTMLElement,
        private readonly photo: HTMLCanvasElement,
        private readonly pool: Pool,
        private readonly viewer: Viewer,
    ) {
        viewer.onlayout = () => this.place();
        viewer.onpick = (camera) => this.look(camera);
    }

    /** Shows other cameras, their pictures as soon as `when` allows; null: none. */
    load(rig: Rig | null, when?: Promise<void>) {
        this.look(null);
        this.rig = rig;
        this.root.replaceChildren();
        this.buttons.length = 0;
        for (const [i, camera] of rig?.cameras.entries() ?? []) {
            const button = document.createElement("button");
            button.type = "button";
            button.title = `Look through ${camera.name}`;
            button.setAttribute("aria-pressed", "false");
            const name = document.createElement("span");
            name.textContent = camera.name;
            button.append(document.createElement("canvas"), name);
            button.addEventListener("click", () => this.look(this.looking === i ? null : i));
            this.root.append(button);
            this.buttons.push(button);
        }
        this.viewer.setCameras(rig?.cameras ?? []);
        const generation = ++this.generation;
        void Promise.resolve(when).then(() => {
            if (generation === this.generation) void this.refresh(rig);
        });
    }

    /** Other files, or another way to silhouettes: the camera looked through first. */
    async refresh(rig: Rig | null) {
        this.rig = rig;
        const generation = ++this.generation;
        if (!rig) return;
        void this.takePhotograph();
        const order = rig.cameras
            .map((_, i) => i)
            .sort((a, b) => Number(b === this.looking) - Number(a === this.looking));
        for (const camera of order) {
            const made = await this.take(camera, THUMBNAIL);
            if (generation !== this.generation) return;
            if (!made) continue;
            const button = this.buttons[camera];
            const canvas = button.querySelector("canvas") as HTMLCanvasElement;
            paint(canvas, made, true);
            button.toggleAttribute("data-problem", made.problem !== null);
            button.title = made.problem
                ? `${rig.cameras[camera].name}: ${made.problem}`
                : `Look through ${rig.cameras[camera].name}`;
            this.viewer.setThumbnail(camera, canvas);
        }
    }

    look(camera: number | null) {
        this.looking = camera;
        for (const [i, button] of this.buttons.entries()) button.setAttribute("aria-pressed", String(i === camera));
        this.photo.hidden = true;
        this.viewer.lookThrough(camera);
        this.onlook(camera);
        void this.takePhotograph();
    }

    /** To a neighbouring camera. */
    turn(direction: 1 | -1) {
        const count = this.rig?.cameras.length ?? 0;
        if (count > 0) this.look(this.looking === null ? 0 : (this.looking + direction + count) % count);
    }

    private async takePhotograph() {
        const camera = this.looking;
        const wanted = ++this.photographs;
        if (camera === null) return;
        const made = await this.take(camera, WHOLE);
        if (wanted !== this.photographs || !made) return;
        paint(this.photo, made, this.rig?.tinted ?? false);
        this.photo.hidden = false;
        this.place();
    }

    private async take(camera: number, width: number): Promise<PhotographResult | null> {
        const rig = this.rig as Rig;
        try {
            return await this.pool.run({
                type: "photograph",
                cameras: rig.cameras,
                camera,
                view: rig.files(camera),
                width,
            });
        } catch (error) {
            if (!(error instanceof JobError)) throw error;
            const { failure } = error;
            if (rig === this.rig) {
                this.buttons[failure.camera ?? camera]?.setAttribute("data-problem", "");
                this.onproblem({ camera, ...failure });
            }
            return null;
        }
    }

    private place() {
        if (this.looking === null) return;
        const { left, top, width, height } = this.viewer.pictureRectangle(this.looking);
        Object.assign(this.photo.style, {
            left: `${left}px`,
            top: `${top}px`,
            width: `${width}px`,
            height: `${height}px`,
        });
    }
}

function paint(canvas: HTMLCanvasElement, made: PhotographResult, tinted: boolean) {
    [canvas.width, canvas.height] = [made.picture.width, made.picture.height];
    const context = canvas.getContext("2d") as CanvasRenderingContext2D;
    context.drawImage(made.picture, 0, 0);
    if (made.silhouette && tinted) {
        context.globalAlpha = 0.45;
        context.drawImage(made.silhouette, 0, 0);
        context.globalAlpha = 1;
    }
    made.picture.close();
    made.silhouette?.close();
}
