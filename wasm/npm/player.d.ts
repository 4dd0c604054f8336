import type { Box3, Group } from "three";

/** A published clip as an object of a three.js scene. */
export class ClipPlayer extends EventTarget {
    /** To be added to a scene. It is turned so that the person stands along +y. */
    readonly object: Group;
    /** What went wrong, in words, with the event `error`. */
    readonly error: Error | null;
    /** Whether a frame is shown, with the event `ready`. */
    readonly ready: boolean;
    readonly paused: boolean;
    /** Seconds. */
    readonly duration: number;
    /** Seconds from the first frame. */
    currentTime: number;
    loop: boolean;
    /** Clip seconds per second, at most 16. */
    rate: number;
    /** The name of a quality that is always taken, or an empty one to go by the bandwidth. */
    quality: string;
    /** The quality of what is loaded next. */
    readonly loadedQuality: string;
    /** Number of the frame that is shown, from 0, or -1. */
    readonly frame: number;
    /** Frames that were shown while the clip played. */
    readonly shownFrames: number;
    /** Frames whose time has passed before they could be shown. */
    readonly droppedFrames: number;
    /** The clip's sound, if it has one, to set its volume or to mute it. */
    readonly audio: HTMLAudioElement | null;
    /** The box around all frames, in the frame of `object`'s parent if `object` has not been moved. */
    readonly bounds: Box3 | null;
    /** Opens the manifest at an address instead of what is open. Resolves when the first frame is shown or with the event `error`. */
    load(src: string): Promise<void>;
    play(): void;
    pause(): void;
    /** Shows the frame whose time it is. To be called before every drawing. */
    update(): void;
    /** Closes the clip, and frees its memory. */
    close(): void;
    /** Closes the clip for good. */
    dispose(): void;
}
