// The three-dimensional view: what is in it, from where it is seen, and when it is drawn.
import type { Camera } from "pcmvs";
import {
    AmbientLight,
    type Camera as AnyCamera,
    Box3,
    type BufferGeometry,
    DirectionalLight,
    Group,
    type Object3D,
    PerspectiveCamera,
    PolarGridHelper,
    Raycaster,
    Scene,
    Vector2,
    Vector3,
    WebGLRenderer,
} from "three";
import type { StageCloud, StageMesh } from "../workers/protocol";
import { cameraToWorld, fit, projection, upright, type Vec3, type Window } from "./cameras";
import { POINTS, type Shading } from "./colours";
import { compile } from "./compile";
import { lookingAt, type OrbitView, type SceneCopy, type Standpoint } from "./copy";
import { Difference, type Pictures } from "./difference";
import { Flight } from "./flight";
import { Frusta } from "./frusta";
import { Navigation } from "./navigation";
import { Surface } from "./surface";

/** No controls cover the picture. */
const FREE = { top: 0, bottom: 0 };
const scaled = ({ top, bottom }: typeof FREE, factor: number) => ({ top: factor * top, bottom: factor * bottom });
/** A pointer that moves less than this many CSS pixels between down and up is a click. */
const CLICK = 4;

export class Viewer {
    private readonly renderer: WebGLRenderer;
    private readonly flight: Flight;
    private readonly scene = new Scene();
    /** Turned so that the scene's upward direction is +y, as in three.js. */
    private readonly world = new Group();
    private readonly navigation: Navigation;
    /** The camera of the rig that is looked through. */
    private readonly through = new PerspectiveCamera();
    private readonly surface = new Surface();
    private readonly frusta = new Frusta();
    private readonly difference = new Difference();
    private differing = false;
    private readonly grid = new PolarGridHelper(1, 12, 4, 96);
    /** What the free camera stands before: a level of a frame's mesh. Null before there is any. */
    private framed: string | null = null;
    private cameras: Camera[] = [];
    private centres: Vector3[] = [];
    private looking: number | null = null;
    /** Parts of the window that controls cover, CSS pixels. */
    private covered = FREE;
    /** A drawing has been asked for. Nothing is drawn before the shaders are compiled. */
    private wanted = true;
    private waiting: (() => void)[] = [];
    /** A frustum was clicked. */
    onpick: (camera: number) => void = () => {};
    /** The graphics processor has been taken away, or has come back. */
    onlost: (lost: boolean) => void = () => {};
    /** The place of a photograph in the window has changed. */
    onlayout: () => void = () => {};

    constructor(private readonly canvas: HTMLCanvasElement) {
        this.renderer = new WebGLRenderer({
            canvas,
            antialias: true,
            alpha: true,
            powerPreference: "high-performance",
        });
        this.flight = new Flight(this.renderer.getContext() as WebGL2RenderingContext);
        // Asking for shader errors waits for the driver's compiler.
        this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        POINTS.size = 2 * this.renderer.getPixelRatio();
        this.navigation = new Navigation(canvas, () => this.draw());
        this.through.matrixAutoUpdate = false;
        const key = new DirectionalLight(0xffffff, 2.2);
        key.position.set(1, 2, 1.5);
        this.navigation.camera.add(key);
        this.scene.add(this.world, this.navigation.camera, new AmbientLight(0xffffff, 0.9), this.grid);
        this.world.add(this.surface.root, this.frusta.root, this.through);
        this.grid.visible = this.frusta.root.visible = false;
        for (const material of [this.grid.material].flat())
            Object.assign(material, { transparent: true, opacity: 0.28 });
        // three.js makes all its objects again when the context comes back; it listens since before.
        canvas.addEventListener("webglcontextlost", () => this.onlost(true));
        canvas.addEventListener("webglcontextrestored", () => {
            this.onlost(false);
            this.draw();
        });
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement as HTMLElement);
        this.resize();
        this.listenForPicks();
        void compile(this.renderer, this.scene, this.navigation.camera, this.grid).then(() => {
            this.wanted = false;
            this.draw();
        });
    }

    /** Resolves when the next picture has been drawn. */
    drawn(): Promise<void> {
        return new Promise((resolve) => {
            this.waiting.push(resolve);
            this.draw();
        });
    }

    /** Draws with the next animation frame, or with the first one for which the graphics processor is ready. */
    draw() {
        if (this.wanted) return;
        this.wanted = true;
        const step = () => {
            if (this.flight.full) return void requestAnimationFrame(step);
            this.wanted = false;
            this.navigation.update();
            this.render();
            this.flight.sent();
            for (const resolve of this.waiting.splice(0)) resolve();
        };
        requestAnimationFrame(step);
    }

    /** A copy of what is shown. Geometries, textures and materials are the same objects. */
    copy(): SceneCopy {
        const { navigation, cameras, looking } = this;
        // Something may have moved since the last drawing.
        this.scene.updateMatrixWorld(true);
        const scene = this.scene.clone();
        const twin = (copied: Object3D, parent: Object3D, child: Object3D) =>
            copied.children[parent.children.indexOf(child)];
        const world = twin(scene, this.scene, this.world);
        const [grid, frusta] = [twin(scene, this.scene, this.grid), twin(world, this.world, this.frusta.root)];
        if (looking !== null) grid.visible = frusta.visible = false;
        const surface = this.surface.copy();
        world.remove(twin(world, this.world, this.surface.root)).add(surface.root);
        const { through, canvas } = this;
        const target = navigation.target.clone();
        const [pose, outside] = [through, navigation.camera].map(({ matrixWorld }) => matrixWorld.clone());
        const lens = navigation.lens();
        const standAt = (view: OrbitView, width: number, height: number) => {
            const pose = lookingAt(view);
            return { pose, lamp: pose, projection: lens(width / height) };
        };
        const standpoint = (width: number, height: number): Standpoint => {
            if (looking === null) return { pose: outside, lamp: outside, projection: lens(width / height) };
            // A picture of the window's size is what the window shows, between its controls.
            const ofWindow = width === canvas.width && height === canvas.height;
            const covered = ofWindow ? scaled(this.covered, height / canvas.clientHeight) : FREE;
            return { pose, lamp: outside, projection: this.lensOf(cameras[looking], { width, height, covered }) };
        };
        const narrow = Math.min(canvas.width, canvas.height);
        return {
            scene,
            surface,
            lamp: twin(scene, this.scene, navigation.camera),
            grid,
            target,
            standpoint,
            standAt,
            narrow,
        };
    }

    /** The view from outside; null while a camera is looked through. */
    get outside(): OrbitView | null {
        if (this.looking !== null) return null;
        const { camera, target } = this.navigation;
        return { position: camera.position.clone(), target: target.clone() };
    }

    /** Takes a view from outside. */
    set outside(view: OrbitView) {
        this.navigation.place(view.position, view.target);
    }

    /** Width and height of the window's picture, in its pixels. */
    get size(): [number, number] {
        return [this.canvas.width, this.canvas.height];
    }

    /** Sets the scene's upward direction. The next mesh is framed anew. */
    setUp(up: Vec3) {
        this.world.quaternion.copy(upright(up));
        this.framed = null;
        this.draw();
    }

    /** Turns what is shown so that another direction is up, and stands before it again. */
    turn(up: Vec3) {
        this.world.quaternion.copy(upright(up));
        this.frame();
        // The camera that is looked through turns, too.
        this.resize();
    }

    /**
     * Shows a frame's mesh. The caller keeps the geometry and disposes of it. `level` names the frame and how good its mesh is.
     *
     * The first mesh is framed, and so is each better one of the same frame until a person turns the view or zooms.
     */
    show(geometry: BufferGeometry, level: string) {
        this.surface.show(geometry);
        const [frame] = level.split(" ");
        const better = this.framed !== level && this.framed?.split(" ")[0] === frame && !this.navigation.moved;
        if (this.framed === null || better) {
            this.framed = level;
            this.frame();
        }
        this.draw();
    }

    /** Shows no mesh, because the frame has none. */
    hideMesh() {
        this.surface.clear();
        this.draw();
    }

    /** Shows neither a mesh nor the grid. The cameras stay. */
    clear() {
        this.grid.visible = false;
        this.surface.clear();
        this.framed = null;
        this.draw();
    }

    /** Shows a stage's output instead of the mesh, or with null the mesh again. */
    showStage(output: StageCloud | StageMesh | null, origin?: number[], ranks = false) {
        this.surface.showStage(output, origin, ranks);
        this.draw();
    }

    setShading(shading: Shading) {
        this.surface.setShading(shading);
        this.draw();
    }

    setWireframe(on: boolean) {
        this.surface.setWireframe(on);
        this.draw();
    }

    setCameras(cameras: Camera[]) {
        const centres = cameras.map((camera) => new Vector3().setFromMatrixPosition(cameraToWorld(camera)));
        this.frusta.set(cameras, centres);
        this.cameras = cameras;
        this.lookThrough(null);
        this.centres = centres;
        // There is no mesh yet: look at the cameras.
        if (this.framed === null) this.frame();
        this.draw();
    }

    /** Puts a small picture on a camera's frustum, or with null none. */
    setThumbnail(camera: number, picture: HTMLCanvasElement | null) {
        this.frusta.setPicture(camera, picture);
        this.draw();
    }

    /** Marks some cameras, such as those with warnings, and no others. */
    markCameras(marked: Set<number>) {
        this.frusta.mark(marked);
        this.draw();
    }

    showCameras(on: boolean) {
        this.frusta.root.visible = on;
        this.draw();
    }

    /** Looks through a camera of the rig, or with null from outside again. */
    lookThrough(camera: number | null) {
        this.looking = camera;
        this.navigation.enabled = camera === null;
        this.resize();
    }

    /** Sets the photograph of the camera that is looked through, for the difference from it. */
    setPhotograph(pictures: Pictures | null) {
        this.difference.set(pictures);
        this.draw();
    }

    /** Shows the amplified difference from the photograph instead of the mesh, or with null the mesh again. */
    showDifference(gain: number | null) {
        this.differing = gain !== null;
        if (gain === null) this.difference.rest();
        else this.difference.gain = gain;
        this.draw();
    }

    /** Place of a camera's picture in the window, in CSS pixels. */
    pictureRectangle(camera: number) {
        const { clientWidth, clientHeight } = this.canvas;
        const { width, height } = this.cameras[camera];
        const window = { width: clientWidth, height: clientHeight, covered: this.covered };
        const { scale, left, top } = fit(this.cameras[camera], window);
        return { left, top, width: scale * width, height: scale * height };
    }

    /** Leaves a part of the window free at its top and at its bottom when a camera is looked through, CSS pixels. */
    cover(top: number, bottom: number) {
        if (top === this.covered.top && bottom === this.covered.bottom) return;
        this.covered = { top, bottom };
        this.resize();
    }

    /** Turns around the object, radians. */
    orbit(horizontal: number, vertical: number) {
        this.navigation.orbit(horizontal, vertical);
    }

    zoom(factor: number) {
        this.navigation.zoom(factor);
    }

    /** Steps back until the whole mesh that is shown is in the window, or else all cameras. */
    frame() {
        this.world.updateMatrixWorld(true);
        const mesh = this.surface.bounds();
        const box = mesh ?? new Box3().setFromPoints(this.centres).applyMatrix4(this.world.matrixWorld);
        if (box.isEmpty()) return;
        // From near the first camera, which usually sees the front.
        const front = new Vector3(0.4, 0, 1);
        if (this.cameras.length > 0) {
            front
                .set(0, 0, 1)
                .transformDirection(cameraToWorld(this.cameras[0]))
                .transformDirection(this.world.matrixWorld);
        }
        const { center, radius } = this.navigation.frame(box, front);
        this.grid.position.set(center.x, box.min.y, center.z);
        this.grid.scale.setScalar(radius * 1.1);
        this.grid.visible = mesh !== null;
        this.draw();
    }

    private render() {
        const camera: AnyCamera = this.looking === null ? this.navigation.camera : this.through;
        const { grid, frusta } = this;
        const shown = [grid.visible, frusta.root.visible];
        if (this.looking !== null) grid.visible = frusta.root.visible = false;
        if (this.looking !== null && this.differing && this.difference.ready) this.renderDifference(this.looking);
        else this.renderer.render(this.scene, camera);
        [grid.visible, frusta.root.visible] = shown;
    }

    private renderDifference(camera: number) {
        const rectangle = this.pictureRectangle(camera);
        this.surface.inColours(() => this.difference.render(this.renderer, this.through, this.scene, rectangle));
    }

    private resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas.parentElement as HTMLElement;
        if (width === 0 || height === 0) return;
        this.renderer.setSize(width, height, false);
        this.navigation.setAspect(width / height);
        if (this.looking !== null) this.standIn(this.cameras[this.looking], width, height);
        this.onlayout();
        this.draw();
    }

    /** Places the camera that is looked through. */
    private standIn(camera: Camera, width: number, height: number) {
        const lens = this.lensOf(camera, { width, height, covered: this.covered });
        this.through.matrix.copy(cameraToWorld(camera));
        this.through.projectionMatrix.copy(lens);
        this.through.projectionMatrixInverse.copy(this.through.projectionMatrix).invert();
    }

    /** The projection of a camera of the rig, whose picture is fitted into a window. */
    private lensOf(camera: Camera, window: Window) {
        const target = this.navigation.target.clone().applyMatrix4(this.world.matrixWorld.clone().invert());
        const distance = target.distanceTo(new Vector3().setFromMatrixPosition(cameraToWorld(camera)));
        return projection(camera, window, distance / 50, distance * 10);
    }

    private listenForPicks() {
        const raycaster = new Raycaster();
        let down = new Vector2();
        this.canvas.addEventListener("pointerdown", (event) => {
            down = new Vector2(event.clientX, event.clientY);
        });
        this.canvas.addEventListener("pointerup", (event) => {
            const moved = down.distanceTo(new Vector2(event.clientX, event.clientY));
            if (!this.frusta.root.visible || this.looking !== null || moved > CLICK) return;
            const box = this.canvas.getBoundingClientRect();
            const x = ((event.clientX - box.left) / box.width) * 2 - 1;
            const y = 1 - ((event.clientY - box.top) / box.height) * 2;
            raycaster.setFromCamera(new Vector2(x, y), this.navigation.camera);
            const camera = this.frusta.hit(raycaster);
            if (camera !== null) this.onpick(camera);
        });
    }
}
