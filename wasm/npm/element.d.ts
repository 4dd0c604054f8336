/**
 * `<pcmvs-player src="sequence.json">`, which this module defines. Attributes: `src`, `autoplay`, `loop`, `rate`, `poster`,
 * `controls`, `quality`. Events: `loadedmetadata`, `ready`, `frame`, `timeupdate`, `play`, `pause`, `ended`, `error`.
 */
export class PcmvsPlayerElement extends HTMLElement {
    play(): void;
    pause(): void;
    readonly paused: boolean;
    /** Seconds. */
    readonly duration: number;
    /** Seconds from the first frame. */
    currentTime: number;
    /** Frames that were shown while the clip played. */
    readonly shownFrames: number;
    /** Frames whose time has passed before they could be shown. */
    readonly droppedFrames: number;
    /** What went wrong, in words. */
    readonly error: Error | null;
}

declare global {
    interface HTMLElementTagNameMap {
        "pcmvs-player": PcmvsPlayerElement;
    }
}
