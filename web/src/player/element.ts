// <pcmvs-player src="…/sequence.json">: a published clip on any page.

import { Box3 } from "three";
import { Bar } from "./bar";
import { type ClipEvent, ClipPlayer } from "./player";
import { Stage } from "./stage";

const ATTRIBUTES = ["src", "autoplay", "loop", "rate", "poster", "controls", "quality"];
const EVENTS: ClipEvent[] = ["loadedmetadata", "ready", "timeupdate", "play", "pause", "ended", "error"];
/** Radians by which a key turns. */
const TURN = 0.15;
const KEYS: Record<string, [number, number]> = {
    ArrowLeft: [-TURN, 0],
    ArrowRight: [TURN, 0],
    ArrowUp: [0, TURN],
    ArrowDown: [0, -TURN],
};

export class PcmvsPlayerElement extends HTMLElement {
    static readonly observedAttributes = ATTRIBUTES;
    /** The clip: its properties are those of the element, and more. */
    readonly player = new ClipPlayer();
    private readonly bar: Bar;
    private stage: Stage | null = null;
    private xrMode: XRSessionMode | null = null;
    /** Why there is no stage. */
    private failure: Error | null = null;

    constructor() {
        super();
        this.bar = new Bar(this.attachShadow({ mode: "open" }), {
            toggle: () => this.toggle(),
            seek: (time) => {
                this.player.currentTime = time;
            },
            fullscreen: () => void (document.fullscreenElement ? document.exitFullscreen() : this.requestFullscreen()),
            xr: () => this.xrMode && this.stage?.enterXr(this.xrMode).catch((error) => this.bar.say(String(error))),
        });
        for (const name of EVENTS) this.player.addEventListener(name, () => this.hear(name));
        this.player.addEventListener("frame", (event) => {
            this.stage?.draw();
            const { detail } = event as CustomEvent;
            this.dispatchEvent(new CustomEvent("frame", { detail }));
        });
        this.bar.canvas.addEventListener("keydown", (event) => this.onKey(event));
    }

    connectedCallback() {
        try {
            this.stage = new Stage(this.bar.canvas, this.player);
        } catch (error) {
            this.failure = error instanceof Error ? error : new Error(String(error));
            this.bar.say(this.failure.message);
            this.dispatchEvent(new Event("error"));
            return;
        }
        void this.stage.xrMode().then((mode) => {
            this.xrMode = mode;
            this.bar.showXr(mode !== null);
        });
        if (this.getAttribute("src")) this.load();
    }

    disconnectedCallback() {
        this.player.close();
        this.stage?.dispose();
        this.stage = null;
    }

    attributeChangedCallback(name: string, _: string | null, value: string | null) {
        const { player } = this;
        if (name === "src") this.load();
        else if (name === "loop") player.loop = value !== null;
        else if (name === "rate") this.setRate(value);
        else if (name === "quality") player.quality = value ?? "";
        else if (name === "controls") this.bar.showControls(value !== null);
        else if (name === "poster") this.showPoster();
        else if (name === "autoplay" && value !== null) player.play();
    }

    play() {
        this.player.play();
    }

    pause() {
        this.player.pause();
    }

    get currentTime(): number {
        return this.player.currentTime;
    }

    set currentTime(time: number) {
        this.player.currentTime = time;
    }

    get duration(): number {
        return this.player.duration;
    }

    get paused(): boolean {
        return this.player.paused;
    }

    get droppedFrames(): number {
        return this.player.droppedFrames;
    }

    get shownFrames(): number {
        return this.player.shownFrames;
    }

    /** What went wrong, in words. */
    get error(): Error | null {
        return this.failure ?? this.player.error;
    }

    /** The window's renderer, for its figures, or null while the element is not in a page. */
    get renderer() {
        return this.stage?.renderer ?? null;
    }

    private load() {
        const src = this.getAttribute("src");
        // Without a stage the element is not in a page yet.
        if (!this.stage) return;
        this.bar.say("");
        this.showPoster();
        if (!src) return this.player.close();
        if (this.hasAttribute("autoplay")) this.player.play();
        void this.player.load(src);
    }

    private setRate(value: string | null) {
        const rate = value === null ? 1 : Number(value);
        try {
            this.player.rate = rate;
        } catch (error) {
            this.bar.say(error instanceof Error ? error.message : String(error));
        }
    }

    private showPoster() {
        const { ready, take } = this.player;
        const own = this.getAttribute("poster");
        const url = own ? new URL(own, document.baseURI).href : (take?.poster ?? null);
        this.bar.showPoster(ready ? null : url);
    }

    private hear(name: ClipEvent) {
        const { player } = this;
        if (name === "loadedmetadata") this.showPoster();
        if (name === "ready") {
            this.showPoster();
            this.stage?.frame(player.bounds ?? new Box3().setFromObject(player.object));
        }
        if (name === "error") this.bar.say(player.error?.message ?? "");
        this.bar.showTime(player.currentTime, player.duration);
        this.bar.showPlaying(!player.paused);
        this.dispatchEvent(new Event(name));
    }

    private toggle() {
        if (this.player.paused) this.player.play();
        else this.player.pause();
    }

    private onKey(event: KeyboardEvent) {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const turn = KEYS[event.key];
        if (event.key === " ") this.toggle();
        else if (turn) this.stage?.orbit(...turn);
        else if (event.key === "+" || event.key === "-") this.stage?.zoom(event.key === "+" ? 0.9 : 1 / 0.9);
        else return;
        event.preventDefault();
    }
}

if (!customElements.get("pcmvs-player")) customElements.define("pcmvs-player", PcmvsPlayerElement);
