// The time of a clip in seconds: that of its audio while it sounds, and else that of the computer.

export class Clock {
    private running = false;
    /** The time of the clip at a moment of the computer's clock. */
    private anchor = { time: 0, at: 0 };
    private factor = 1;
    /** Plays with the clip, if there is one. */
    audio: HTMLAudioElement | null = null;

    get time(): number {
        if (this.sounds && this.audio) this.anchor = { time: this.audio.currentTime, at: performance.now() };
        const { time, at } = this.anchor;
        return this.running ? time + ((performance.now() - at) / 1000) * this.factor : time;
    }

    /** Clip seconds per second. */
    get rate(): number {
        return this.factor;
    }

    set rate(rate: number) {
        this.hold();
        this.factor = rate;
        if (this.audio) this.audio.playbackRate = rate;
    }

    /** Plays a sound with the clip, or with null none. */
    hear(url: string | null) {
        this.audio?.pause();
        // Also ends its loading.
        this.audio?.removeAttribute("src");
        this.audio = null;
        if (url === null) return;
        this.audio = new Audio();
        Object.assign(this.audio, { crossOrigin: "anonymous", preload: "auto", src: url });
    }

    start() {
        this.hold();
        this.running = true;
        this.sound();
    }

    stop() {
        this.hold();
        this.running = false;
        this.audio?.pause();
    }

    seek(time: number) {
        this.anchor = { time, at: performance.now() };
        if (!this.audio) return;
        this.audio.currentTime = time;
        if (this.running) this.sound();
    }

    /** Whether the audio gives the time: it is shorter than the clip at times, and starts late. */
    private get sounds(): boolean {
        const { audio } = this;
        return (
            audio !== null && this.running && !audio.paused && !audio.ended && !audio.seeking && audio.readyState > 2
        );
    }

    private hold() {
        this.anchor = { time: this.time, at: performance.now() };
    }

    private sound() {
        const { audio } = this;
        if (!audio || audio.error || this.anchor.time >= audio.duration) return;
        audio.playbackRate = this.factor;
        audio.currentTime = this.anchor.time;
        // Browsers refuse sound before a person has touched the page. The pictures then play without it.
        audio.play().catch(() => {});
    }
}
