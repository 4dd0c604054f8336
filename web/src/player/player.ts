// A published clip as an object of a three.js scene.

import { Box3, type BufferGeometry, Group, LinearFilter, Matrix4, Quaternion, type Texture, Vector3 } from "three";
import { readGeometry } from "../clip/glb";
import { Playback } from "../clip/playback";
import { upright } from "../viewer/cameras";
import { Surface } from "../viewer/surface";
import { Stream } from "./stream";
import { ClipError, readTake, type Take } from "./take";

/** Frames that are kept ready to be drawn. */
const READY = 10;

/** What has happened; the names are those of HTML's media elements where these have them. */
export type ClipEvent = "loadedmetadata" | "ready" | "frame" | "timeupdate" | "play" | "pause" | "ended" | "error";

/**
 * Plays a clip. Add `object` to a scene, and call `update` before every drawing.
 *
 * Events: `loadedmetadata` when the manifest is read, `ready` when the first frame is shown, `frame` for every frame that is
 * shown, `timeupdate`, `play`, `pause`, `ended`, and `error` with `error` set.
 */
export class ClipPlayer extends EventTarget {
    /** Turned so that the person stands along +y. */
    readonly object = new Group();
    /** What went wrong, in words. */
    error: Error | null = null;
    take: Take | null = null;
    private readonly surface = new Surface();
    private playback: Playback | null = null;
    private stream: Stream | null = null;
    private opening = new AbortController();
    private order: number[] = [];
    private wanted = { playing: false, loop: false, rate: 1, quality: "" };
    private isReady = false;
    private readonly noteHidden = () => this.playback?.skip();

    constructor() {
        super();
        this.object.add(this.surface.root);
        document.addEventListener("visibilitychange", this.noteHidden);
    }

    /** Opens the manifest at an address instead of what is open. Resolves when the first frame is shown. */
    async load(src: string): Promise<void> {
        this.close();
        const { signal } = this.opening;
        try {
            const take = await readTake(new URL(src, document.baseURI).href, signal);
            if (signal.aborted) return;
            this.open(take);
        } catch (error) {
            if (!signal.aborted) this.fail(error);
            return;
        }
        const first = this.playback?.seek(0);
        this.stream?.need(0, this.loop);
        await first;
        if (signal.aborted || this.playback?.shown === null) return;
        this.isReady = true;
        this.tell("ready");
        if (this.wanted.playing) this.play();
    }

    /** Closes the clip, and frees its memory. */
    close() {
        this.opening.abort();
        this.opening = new AbortController();
        this.playback?.dispose();
        this.stream?.dispose();
        this.surface.clear();
        this.playback = this.stream = this.take = this.error = null;
        this.isReady = false;
    }

    /** Closes the clip for good. */
    dispose() {
        this.close();
        this.object.removeFromParent();
        this.surface.dispose();
        document.removeEventListener("visibilitychange", this.noteHidden);
    }

    /** Shows the frame whose time it is. To be called before every drawing. */
    update() {
        const { playback, stream } = this;
        if (!playback || !stream || !this.isReady) return;
        playback.tick();
        if (playback.playing) stream.need(this.dueFrame, playback.looping);
    }

    play() {
        this.wanted.playing = true;
        if (!this.isReady || !this.playback || this.playback.playing) return;
        this.playback.play(true);
        this.tell("play");
    }

    pause() {
        this.wanted.playing = false;
        if (!this.playback?.playing) return;
        this.playback.play(false);
        this.tell("pause");
    }

    get paused(): boolean {
        return !this.wanted.playing;
    }

    /** Whether a frame is shown. */
    get ready(): boolean {
        return this.isReady;
    }

    /** Seconds from the first frame. */
    get currentTime(): number {
        return this.playback?.time ?? 0;
    }

    set currentTime(time: number) {
        this.playback?.seekTime(time);
        if (this.playback) this.stream?.need(this.playback.position, this.loop);
    }

    get duration(): number {
        return this.playback?.duration ?? 0;
    }

    /** Number of the frame that is shown, from 0, or -1. */
    get frame(): number {
        return this.playback?.shown ?? -1;
    }

    get loop(): boolean {
        return this.wanted.loop;
    }

    set loop(on: boolean) {
        this.wanted.loop = on;
        if (this.playback) this.playback.looping = on;
    }

    /** Clip seconds per second. */
    get rate(): number {
        return this.wanted.rate;
    }

    set rate(rate: number) {
        if (!(rate > 0 && rate <= 16)) throw new RangeError(`rate is ${rate}: it is above 0 and at most 16`);
        this.wanted.rate = rate;
        if (this.playback) this.playback.clock.rate = rate;
    }

    /** The name of a quality that is always taken, or an empty one to go by the bandwidth. */
    get quality(): string {
        return this.wanted.quality;
    }

    set quality(name: string) {
        this.wanted.quality = name;
        try {
            if (this.stream) this.stream.chosen = this.chosenQuality(this.stream.take);
        } catch (error) {
            this.fail(error);
        }
    }

    /** The clip's sound, if it has one, to set its volume or to mute it. */
    get audio(): HTMLAudioElement | null {
        return this.playback?.clock.audio ?? null;
    }

    /** The quality of what is loaded next. */
    get loadedQuality(): string {
        return this.stream?.quality.name ?? "";
    }

    /** Frames that were shown while the clip played. */
    get shownFrames(): number {
        return this.playback?.counts.shown ?? 0;
    }

    /** Frames whose time has passed before they could be shown. */
    get droppedFrames(): number {
        return this.playback?.counts.dropped ?? 0;
    }

    /** The box around all frames, in the frame of `object`'s parent if `object` has not been moved. */
    get bounds(): Box3 | null {
        const { take } = this;
        if (!take?.bounds) return null;
        const box = new Box3(...(take.bounds.map((corner) => new Vector3(...corner)) as [Vector3, Vector3]));
        const standing = take.rotation ? new Quaternion() : upright(take.up ?? undefined);
        return box.applyMatrix4(new Matrix4().makeRotationFromQuaternion(standing));
    }

    private open(take: Take) {
        this.take = take;
        this.order = take.indices.map((_, i) => i);
        const stream = new Stream(take);
        stream.chosen = this.chosenQuality(take);
        const playback = new Playback(
            take.fps,
            {
                order: () => this.order,
                read: async (position) => withoutMipmaps(await readGeometry(await stream.frame(position))),
                show: (position, geometry, time) => this.show(position, geometry, time),
                changed: () => this.tell("timeupdate"),
                ended: () => {
                    this.wanted.playing = false;
                    this.tell("ended");
                },
                failed: (error) => this.playback === playback && this.fail(error),
            },
            READY,
        );
        playback.looping = this.loop;
        playback.clock.rate = this.rate;
        playback.clock.hear(take.audio);
        [this.stream, this.playback] = [stream, playback];
        this.object.quaternion.copy(take.rotation ? new Quaternion(...take.rotation) : upright(take.up ?? undefined));
        this.tell("loadedmetadata");
    }

    /** The index of the quality that is always taken, or null. */
    private chosenQuality({ qualities }: Take): number | null {
        const { quality } = this.wanted;
        if (quality === "") return null;
        const index = qualities.findIndex(({ name }) => name === quality);
        const names = qualities.map(({ name }) => name).join(", ");
        if (index < 0) throw new ClipError(`there is no quality ${quality} in this clip: it has ${names}`);
        return index;
    }

    private get dueFrame(): number {
        const { take, playback } = this;
        if (!take || !playback) return 0;
        return Math.min(take.indices.length - 1, Math.floor(playback.time * take.fps));
    }

    private show(frame: number, geometry: BufferGeometry, time: number) {
        this.surface.show(geometry);
        this.dispatchEvent(new CustomEvent("frame", { detail: { frame, time } }));
    }

    private fail(error: unknown) {
        this.error = error instanceof Error ? error : new Error(String(error));
        if (!(error instanceof ClipError))
            this.error = new ClipError(`the clip cannot be played: ${this.error.message}`);
        this.playback?.play(false);
        this.wanted.playing = false;
        this.tell("error");
    }

    private tell(name: ClipEvent) {
        this.dispatchEvent(new Event(name));
    }
}

/** A frame is seen for a moment, in about its own size. Making mipmaps takes longer than all else where WebGL is software. */
function withoutMipmaps(geometry: BufferGeometry): BufferGeometry {
    const texture: Texture | null = geometry.userData.texture;
    if (texture) Object.assign(texture, { generateMipmaps: false, minFilter: LinearFilter });
    return geometry;
}
