// Drawings that the graphics processor has not finished. Without a limit, a browser may queue what a slow one cannot draw in
// time, and then shows views that are long past.

/** One is drawn while the next one is prepared. */
const LIMIT = 2;

export class Flight {
    private fences: WebGLSync[] = [];

    constructor(private readonly gl: WebGL2RenderingContext) {
        // The fences of a lost context are never reached.
        gl.canvas.addEventListener("webglcontextlost", () => {
            this.fences = [];
        });
    }

    /** Whether nothing should be drawn now. Ask again with the next animation frame. */
    get full(): boolean {
        const { gl } = this;
        while (this.fences.length > 0 && gl.getSyncParameter(this.fences[0], gl.SYNC_STATUS) !== gl.UNSIGNALED) {
            gl.deleteSync(this.fences.shift() as WebGLSync);
        }
        return this.fences.length >= LIMIT;
    }

    /** Must be called after every drawing. */
    sent() {
        const { gl } = this;
        const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        if (!fence) return;
        this.fences.push(fence);
        // A fence that stays in the browser's own queue is never reached.
        gl.flush();
    }
}
