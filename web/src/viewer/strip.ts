// The cameras as a strip of pictures with their silhouettes, and one photograph over the view.

import type { Camera } from "pcmvs";
import type { Findings } from "../clip/clip";
import { JobError, type Pool } from "../workers/pool";
import type { Failure, PhotographResult, ViewFiles } from "../workers/protocol";
import type { Pictures } from "./difference";
import type { Viewer } from "./viewer";

/** Widths of small pictures and, at most, of the photograph, pixels. */
const THUMBNAIL = 240;
const PHOTOGRAPH = 4096;

/** Cameras to show and where their pictures come from. */
export interface ShownRig {
    /** Position of the frame whose pictures these are. */
    frame: number;
    cameras: Camera[];
    files: (camera: number) => ViewFiles;
    /** Whether the silhouette is tinted into the photograph. */
    tinted: boolean;
}

/** Of a photograph in the window. */
export type Place = ReturnType<Viewer["pictureRectangle"]>;

export class Strip {
    private rig: ShownRig | null = null;
    /** Changes whenever pictures that are being made are no longer wanted. */
    private generation = 0;
    private photographs = 0;
    private readonly buttons: HTMLButtonElement[] = [];
    /** What the buttons' tooltips say besides warnings. */
    private readonly titles: string[] = [];
    /** What was found in the frame that is shown. */
    private findings: Findings | null = null;
    /** What a check of the calibration found. */
    private checked: Findings["warnings"] = [];
    /** The camera that is looked through. */
    private looking: number | null = null;
    /** Position of the frame that is shown and stands still; null while frames change. */
    private shown: number | null = null;
    /** Which photograph has been made last, and its pictures, which the view needs for the difference. */
    private photographed: (Pictures & { camera: number; frame: number }) | null = null;
    /** The frame has no photograph of the camera that is looked through, or it cannot be read. */
    private missing = false;
    /** The photograph that the view has. */
    private compared: Pictures | null = null;
    private covered = true;
    onlook: (camera: number | null) => void = () => {};
    /** A picture of a frame cannot be made. */
    onproblem: (failure: Failure, frame: number) => void = () => {};
    /** The photograph has another place in the window, in CSS pixels. */
    onplace: (place: Place) => void = () => {};
    /** What there is of the photograph has changed. */
    onphotograph: (found: "shown" | "waiting" | "missing") => void = () => {};

    constructor(
        private readonly root: HTMLElement,
        private readonly photo: HTMLCanvasElement,
        private readonly pool: Pool,
        private readonly viewer: Viewer,
    ) {
        viewer.onlayout = () => this.place();
        viewer.onpick = (camera) => this.look(camera);
    }

    /** Shows other cameras, or none. Their pictures are made once `when` resolves. */
    load(rig: ShownRig | null, when?: Promise<void>) {
        this.look(null);
        this.rig = rig;
        this.root.replaceChildren();
        this.buttons.length = this.titles.length = 0;
        for (const [i, camera] of rig?.cameras.entries() ?? []) this.addButton(i, camera.name);
        this.viewer.setCameras(rig?.cameras ?? []);
        this.findings = null;
        this.drawMarks();
        const generation = ++this.generation;
        void Promise.resolve(when).then(() => {
            if (generation === this.generation) void this.refresh(rig);
        });
    }

    private addButton(camera: number, text: string) {
        const button = document.createElement("button");
        button.type = "button";
        button.title = `Look through ${text}`;
        button.setAttribute("aria-pressed", "false");
        const name = document.createElement("span");
        name.textContent = text;
        button.append(document.createElement("canvas"), name);
        button.addEventListener("click", () => this.look(this.looking === camera ? null : camera));
        this.root.append(button);
        this.buttons.push(button);
        this.titles.push(button.title);
    }

    /** Position of the frame whose pictures are shown. */
    get frame(): number | null {
        return this.rig?.frame ?? null;
    }

    /** Tells which frame is shown, or with null that frames change. A photograph of another one is not shown. */
    setShown(frame: number | null) {
        if (frame === this.shown) return;
        this.shown = frame;
        this.missing &&= frame === this.rig?.frame;
        this.choose();
    }

    /** Whether the photograph is laid over the view. It is not while the difference from it is shown. */
    cover(on: boolean) {
        if (on === this.covered) return;
        this.covered = on;
        this.choose();
    }

    /** Makes all pictures again, for other files or silhouettes. The camera that is looked through comes first. */
    async refresh(rig: ShownRig | null) {
        this.rig = rig;
        const generation = ++this.generation;
        if (!rig) return;
        void this.takePhotograph();
        const order = rig.cameras.map((_, i) => i);
        order.sort((a, b) => Number(b === this.looking) - Number(a === this.looking));
        for (const camera of order) {
            const made = await this.take(camera, THUMBNAIL);
            if (generation !== this.generation) return;
            if (made !== "failed") this.showThumbnail(camera, rig.cameras[camera].name, made);
        }
        this.drawMarks();
    }

    private showThumbnail(camera: number, name: string, made: PhotographResult | "absent") {
        const button = this.buttons[camera];
        const canvas = button.querySelector("canvas") as HTMLCanvasElement;
        if (made === "absent") {
            // Not a problem of the picture: a warning of the frame tells it.
            clear(canvas);
            button.removeAttribute("data-problem");
            this.titles[camera] = `${name}: no picture in this frame`;
            this.viewer.setThumbnail(camera, null);
            return;
        }
        paint(canvas, made, true);
        close(made);
        button.toggleAttribute("data-problem", made.problem !== null);
        this.titles[camera] = made.problem ? `${name}: ${made.problem}` : `Look through ${name}`;
        this.viewer.setThumbnail(camera, canvas);
    }

    /** Marks the cameras by what was found in the frame that is shown: those with warnings, and all silhouettes' overlap. */
    mark(findings: Findings | null) {
        if (findings === this.findings) return;
        this.findings = findings;
        this.drawMarks();
    }

    /** Marks the cameras that a check of the calibration warns of, in all frames. */
    markChecked(warnings: Findings["warnings"]) {
        this.checked = warnings;
        this.drawMarks();
    }

    private drawMarks() {
        const warnings = [...this.checked, ...(this.findings?.warnings ?? [])];
        const warned = new Set<number>();
        for (const [i, { name }] of this.rig?.cameras.entries() ?? []) {
            const messages = warnings.filter(({ camera }) => camera === name).map(({ message }) => message);
            if (messages.length > 0) warned.add(i);
            const button = this.buttons[i];
            button.toggleAttribute("data-warning", messages.length > 0);
            const span = button.querySelector("span") as HTMLElement;
            const [title, label] = [[this.titles[i], ...messages].join("\n"), this.label(i)];
            // During playback most of them stay as they are, and writing costs a new layout.
            if (button.title !== title) button.title = title;
            if (span.textContent !== label) span.textContent = label;
        }
        this.viewer.markCameras(warned);
        this.onlook(this.looking);
    }

    /** A camera's name and its silhouette's overlap with the hull of all silhouettes. */
    label(camera: number): string {
        const name = this.rig?.cameras[camera].name ?? "";
        const found = this.findings?.views.get(name);
        if (found && !found.used) return `${name} · not used`;
        const overlap = found?.silhouetteOverlap;
        return typeof overlap === "number" ? `${name} · ${(100 * overlap).toFixed(1)} %` : name;
    }

    /** Looks through the camera with a name, if it is shown. */
    lookAt(name: string) {
        const camera = this.rig?.cameras.findIndex((camera) => camera.name === name) ?? -1;
        if (camera >= 0) this.look(camera);
    }

    /** Looks through a camera, or with null from outside again. */
    look(camera: number | null) {
        if (camera !== this.looking) this.forget();
        this.missing = false;
        this.looking = camera;
        for (const [i, button] of this.buttons.entries()) button.setAttribute("aria-pressed", String(i === camera));
        this.viewer.lookThrough(camera);
        this.onlook(camera);
        this.choose();
        void this.takePhotograph();
    }

    /** Looks through the next or the previous camera. */
    turn(direction: 1 | -1) {
        const count = this.rig?.cameras.length ?? 0;
        if (count > 0) this.look(this.looking === null ? 0 : (this.looking + direction + count) % count);
    }

    private async takePhotograph() {
        const camera = this.looking;
        const wanted = ++this.photographs;
        if (camera === null || !this.rig) return;
        const { frame, tinted } = this.rig;
        const made = await this.take(camera, PHOTOGRAPH);
        if (made !== "failed" && made !== "absent" && wanted !== this.photographs) close(made);
        if (wanted !== this.photographs) return;
        this.forget();
        this.missing = made === "failed" || made === "absent";
        if (made !== "failed" && made !== "absent") {
            paint(this.photo, made, tinted);
            this.photographed = { camera, frame, ...made };
        }
        this.choose();
    }

    /** Frees the photograph. */
    private forget() {
        if (!this.photographed) return;
        close(this.photographed);
        this.photographed = null;
    }

    /** Shows the photograph if it is that of the camera that is looked through and of the frame that is shown. */
    private choose() {
        const made = this.photographed;
        const shown = made !== null && made.camera === this.looking && made.frame === this.shown;
        this.photo.hidden = !shown || !this.covered;
        const compared = shown ? made : null;
        if (compared !== this.compared) this.viewer.setPhotograph(compared);
        this.compared = compared;
        this.place();
        this.onphotograph(shown ? "shown" : this.missing ? "missing" : "waiting");
    }

    /** A camera's picture, unless it has none in this frame, or none can be made, which is reported. */
    private async take(camera: number, width: number): Promise<PhotographResult | "absent" | "failed"> {
        const rig = this.rig as ShownRig;
        try {
            const { cameras } = rig;
            const view = rig.files(camera);
            // A warning of the frame says that there is none.
            if (!view.image) return "absent";
            return await this.pool.run({ type: "photograph", cameras, camera, view, width });
        } catch (error) {
            if (!(error instanceof JobError)) throw error;
            const { failure } = error;
            if (rig === this.rig) {
                this.buttons[failure.camera ?? camera]?.setAttribute("data-problem", "");
                this.onproblem({ camera, ...failure }, rig.frame);
            }
            return "failed";
        }
    }

    /** Lays the photograph over the place where its camera sees the scene. */
    private place() {
        if (this.looking === null) return;
        const place = this.viewer.pictureRectangle(this.looking);
        for (const [side, pixels] of Object.entries(place)) this.photo.style.setProperty(side, `${pixels}px`);
        this.onplace(place);
    }
}

function clear(canvas: HTMLCanvasElement) {
    canvas.getContext("2d")?.clearRect(0, 0, canvas.width, canvas.height);
}

function paint(canvas: HTMLCanvasElement, made: Pictures, tinted: boolean) {
    [canvas.width, canvas.height] = [made.picture.width, made.picture.height];
    const context = canvas.getContext("2d") as CanvasRenderingContext2D;
    context.drawImage(made.picture, 0, 0);
    if (made.silhouette && tinted) {
        context.globalAlpha = 0.45;
        context.drawImage(made.silhouette, 0, 0);
        context.globalAlpha = 1;
    }
}

function close({ picture, silhouette }: Pictures) {
    picture.close();
    silhouette?.close();
}
