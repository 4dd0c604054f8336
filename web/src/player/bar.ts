// What the element shows besides the clip: the poster, a message, and the bar with its controls.

const STYLE = `
:host { display: block; position: relative; aspect-ratio: 4 / 3; background: #14181d; color: #f3f6f8; overflow: hidden; font: 14px/1.4 system-ui, sans-serif; }
:host([hidden]), [hidden] { display: none !important; }
canvas, img { position: absolute; inset: 0; width: 100%; height: 100%; }
canvas { touch-action: none; outline-offset: -3px; }
img { object-fit: contain; pointer-events: none; }
p { position: absolute; left: 12px; right: 12px; top: 12px; margin: 0; padding: 8px 12px; border-radius: 6px; background: #5c1f1b; }
div { position: absolute; left: 0; right: 0; bottom: 0; display: flex; align-items: center; gap: 8px; padding: 8px; background: #000a; }
input { flex: 1; min-width: 0; accent-color: #3ddc97; }
button { min-width: 40px; min-height: 32px; border: 1px solid #fff6; border-radius: 5px; background: #222a; color: inherit; font: inherit; cursor: pointer; }
:focus-visible { outline: 3px solid #3ddc97; }
output { font-variant-numeric: tabular-nums; white-space: nowrap; }
`;

const seconds = (time: number) => `${Math.floor(time / 60)}:${String(Math.floor(time % 60)).padStart(2, "0")}`;

export interface Actions {
    toggle(): void;
    seek(time: number): void;
    fullscreen(): void;
    xr(): void;
}

export class Bar {
    readonly canvas = document.createElement("canvas");
    private readonly poster = document.createElement("img");
    private readonly message = document.createElement("p");
    private readonly controls = document.createElement("div");
    private readonly timeline = document.createElement("input");
    private readonly clock = document.createElement("output");
    private readonly play: HTMLButtonElement;
    private readonly xr: HTMLButtonElement;

    constructor(root: ShadowRoot, actions: Actions) {
        // Allowed by a content security policy that forbids inline styles.
        const sheet = new CSSStyleSheet();
        sheet.replaceSync(STYLE);
        root.adoptedStyleSheets = [sheet];
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("role", "application");
        this.canvas.setAttribute(
            "aria-label",
            "A clip in three dimensions. Drag or use the arrows to turn, space to play.",
        );
        this.poster.alt = "";
        this.poster.hidden = this.message.hidden = this.controls.hidden = true;
        this.message.setAttribute("role", "alert");
        this.timeline.type = "range";
        Object.assign(this.timeline, { min: "0", max: "0", step: "any", value: "0" });
        this.timeline.setAttribute("aria-label", "Time");
        this.timeline.addEventListener("input", () => actions.seek(this.timeline.valueAsNumber));
        this.play = button("Play", "▶", () => actions.toggle());
        this.xr = button("Enter XR", "XR", () => actions.xr());
        this.xr.hidden = true;
        const full = button("Full screen", "⛶", () => actions.fullscreen());
        this.controls.append(this.play, this.timeline, this.clock, this.xr, full);
        root.append(this.canvas, this.poster, this.controls, this.message);
    }

    showControls(on: boolean) {
        this.controls.hidden = !on;
    }

    showXr(on: boolean) {
        this.xr.hidden = !on;
    }

    /** Shows a picture until the clip is ready, or with null none. */
    showPoster(url: string | null) {
        this.poster.hidden = url === null;
        if (url === null) this.poster.removeAttribute("src");
        else if (this.poster.src !== url) this.poster.src = url;
    }

    /** Says what went wrong, or with an empty text nothing. */
    say(text: string) {
        this.message.textContent = text;
        this.message.hidden = text === "";
    }

    showTime(time: number, duration: number) {
        this.timeline.max = String(duration);
        this.timeline.value = String(time);
        this.timeline.setAttribute("aria-valuetext", `${seconds(time)} of ${seconds(duration)}`);
        this.clock.textContent = `${seconds(time)} / ${seconds(duration)}`;
    }

    showPlaying(on: boolean) {
        this.play.textContent = on ? "❚❚" : "▶";
        this.play.setAttribute("aria-label", on ? "Pause" : "Play");
    }
}

function button(label: string, text: string, act: () => void): HTMLButtonElement {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", act);
    return made;
}
