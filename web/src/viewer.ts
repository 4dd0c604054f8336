// The three-dimensional view: mesh, stage outputs, cameras.

import type { Camera } from "pcmvs";
import {
    AmbientLight,
    type Camera as AnyCamera,
    Box3,
    BufferAttribute,
    BufferGeometry,
    CanvasTexture,
    Color,
    DirectionalLight,
    DoubleSide,
    Group,
    LineBasicMaterial,
    LineSegments,
    type Material,
    Mesh,
    MeshBasicMaterial,
    MeshNormalMaterial,
    MeshStandardMaterial,
    PerspectiveCamera,
    PlaneGeometry,
    Points,
    PointsMaterial,
    PolarGridHelper,
    Raycaster,
    Scene,
    Sphere,
    SRGBColorSpace,
    Texture,
    Vector2,
    Vector3,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { fit, pose, projection, upright } from "./cameras";
import type { StageCloud, StageMesh } from "./protocol";

export const SHADINGS = ["colour", "clay", "normals"] as const;
export type Shading = (typeof SHADINGS)[number];

/** Colours of a cloud's tags: twenty views around the colour circle, every third next to each other. */
const viewColour = (tag: number) =>
    tag === 65535 ? new Color(0.55, 0.55, 0.58) : new Color().setHSL((tag * 0.3819) % 1, 0.72, 0.58, SRGBColorSpace);
/** A camera's picture before it has come. */
const BLANK = new MeshBasicMaterial({ color: 0x8892a0, transparent: true, opacity: 0.25, side: DoubleSide });
const RANK_COLOURS = ["#8d93a1", "#e2a33d", "#4f9cf0", "#3ddc97"].map((c) => new Color(c));

export class Viewer {
    readonly renderer: WebGLRenderer;
    private readonly scene = new Scene();
    /** Turned so that the scene's upward direction is three.js'. */
    private readonly world = new Group();
    private readonly free = new PerspectiveCamera(35, 1, 0.01, 100);
    private readonly through = new PerspectiveCamera();
    private readonly controls: OrbitControls;
    private readonly materials: Record<Shading, Material> = {
        colour: new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }),
        clay: new MeshStandardMaterial({ color: 0xcfc8bd, roughness: 0.85, side: DoubleSide }),
        normals: new MeshNormalMaterial({ side: DoubleSide }),
    };
    private readonly points = new PointsMaterial({ vertexColors: true, sizeAttenuation: false });
    private readonly frustumLines = new LineBasicMaterial({ color: 0x3ddc97, transparent: true, opacity: 0.75 });
    /** The surface, and in its place its edges when these are wanted. */
    private readonly mesh = new Mesh<BufferGeometry, Material>(new BufferGeometry(), this.materials.colour);
    private readonly wires = new LineSegments<BufferGeometry, Material>(new BufferGeometry(), this.materials.colour);
    private wireframe = false;
    private readonly rig = new Group();
    private readonly grid = new PolarGridHelper(1, 12, 4, 96);
    private stage: Mesh | Points | null = null;
    private bounds: Box3 | null = null;
    private thumbnails: (Mesh | undefined)[] = [];
    private cameras: Camera[] = [];
    private looking: number | null = null;
    /** A picture has been asked for; none is made before the shaders are compiled. */
    private wanted = true;
    private waiting: (() => void)[] = [];
    /** A frustum was chosen. */
    onpick: (camera: number) => void = () => {};
    /** The picture's place in the window has changed. */
    onlayout: () => void = () => {};

    constructor(private readonly canvas: HTMLCanvasElement) {
        this.renderer = new WebGLRenderer({
            canvas,
            antialias: true,
            alpha: true,
            powerPreference: "high-performance",
        });
        // Asking for errors waits for the driver's compiler.
        this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.points.size = 2 * this.renderer.getPixelRatio();
        this.mesh.visible = this.wires.visible = false;
        this.through.matrixAutoUpdate = false;
        const key = new DirectionalLight(0xffffff, 2.2);
        key.position.set(1, 2, 1.5);
        this.free.add(key);
        this.scene.add(this.world, this.free, new AmbientLight(0xffffff, 0.9), this.grid);
        this.world.add(this.mesh, this.wires, this.rig, this.through);
        this.grid.visible = this.rig.visible = false;
        for (const material of [this.grid.material].flat())
            Object.assign(material, { transparent: true, opacity: 0.28 });
        this.free.position.set(2.2, 0.9, 2.6);
        this.controls = new OrbitControls(this.free, canvas);
        this.controls.enableDamping = true;
        this.controls.dampingFactor = 0.12;
        this.controls.addEventListener("change", () => this.draw());
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement as HTMLElement);
        this.resize();
        this.listenForPicks();
        void this.compile().then(() => {
            this.wanted = false;
            this.draw();
        });
    }

    /** Has all shaders compiled beside the page's own thread: the first use of one that is not ready would wait for it. */
    private async compile() {
        // The constructor's task is long enough.
        await new Promise((resolve) => setTimeout(resolve));
        const floats = () => new BufferAttribute(new Float32Array(9), 3);
        const geometry = new BufferGeometry()
            .setAttribute("position", floats())
            .setAttribute("normal", floats())
            .setAttribute("color", floats());
        const all = new Group();
        for (const material of Object.values(this.materials)) all.add(new Mesh(geometry, material));
        const plate = new PlaneGeometry();
        const textured = new MeshBasicMaterial({ map: new Texture(), side: DoubleSide });
        all.add(
            new Points(geometry, this.points),
            new LineSegments(plate, this.frustumLines),
            new Mesh(plate, BLANK),
            new Mesh(plate, textured),
            new LineSegments(this.grid.geometry, this.grid.material),
        );
        // Where readiness cannot be asked for, three.js warns of waiting for it.
        if (this.renderer.extensions.has("KHR_parallel_shader_compile"))
            await this.renderer.compileAsync(all, this.free, this.scene);
        else this.renderer.compile(all, this.free, this.scene);
    }

    /** Resolves when the next picture has been drawn. */
    drawn(): Promise<void> {
        return new Promise((resolve) => {
            this.waiting.push(resolve);
            this.draw();
        });
    }

    /** Draws at the next opportunity. */
    draw() {
        if (this.wanted) return;
        this.wanted = true;
        requestAnimationFrame(() => {
            this.wanted = false;
            // Damping goes on until the camera rests; its changes ask for the next picture.
            this.controls.update();
            this.render();
            for (const resolve of this.waiting.splice(0)) resolve();
        });
    }

    /** What is seen now as a PNG. */
    still(): Promise<Blob> {
        this.render();
        return new Promise((resolve, reject) =>
            this.canvas.toBlob(
                (blob) => (blob ? resolve(blob) : reject(new Error("the picture could not be made"))),
                "image/png",
            ),
        );
    }

    setUp(up: number[] | undefined) {
        this.world.quaternion.copy(upright(up));
        this.bounds = null;
        this.draw();
    }

    /** Shows a frame's mesh, whose geometry stays its owner's. */
    show(geometry: BufferGeometry) {
        this.mesh.geometry = geometry;
        this.choose();
        if (!this.bounds) {
            this.world.updateMatrixWorld(true);
            geometry.computeBoundingBox();
            this.bounds = (geometry.boundingBox as Box3).clone().applyMatrix4(this.world.matrixWorld);
            this.frame();
        }
        this.draw();
    }

    /** Nothing to show. */
    clear() {
        this.grid.visible = false;
        this.mesh.geometry = new BufferGeometry();
        this.bounds = null;
        this.showStage(null);
        this.setCameras([]);
    }

    /** Shows a stage's output instead of the mesh; null: the mesh again. */
    showStage(output: StageCloud | StageMesh | null, origin: number[] = [0, 0, 0], ranks = false) {
        if (this.stage) {
            this.world.remove(this.stage);
            this.stage.geometry.dispose();
        }
        this.stage = null;
        if (output) {
            const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(output.positions, 3));
            if (output.kind === "mesh") {
                geometry.setAttribute("normal", new BufferAttribute(output.normals, 3));
                geometry.setIndex(new BufferAttribute(output.triangles, 1));
                this.stage = new Mesh(geometry, this.materials.clay);
            } else {
                geometry.setAttribute("color", new BufferAttribute(tagColours(output.tags, ranks), 3, true));
                this.stage = new Points(geometry, this.points);
            }
            // It is drawn always: no bounds need to be found first.
            this.stage.frustumCulled = false;
            this.stage.position.fromArray(origin);
            this.world.add(this.stage);
        }
        this.choose();
        this.draw();
    }

    setShading(shading: Shading) {
        this.mesh.material = this.wires.material = this.materials[shading];
        this.draw();
    }

    setWireframe(on: boolean) {
        this.wireframe = on;
        this.choose();
        this.draw();
    }

    /** Surface, edges or neither of them. */
    private choose() {
        const there = this.stage === null && this.mesh.geometry.hasAttribute("position");
        this.mesh.visible = there && !this.wireframe;
        this.wires.visible = there && this.wireframe;
        if (this.wires.visible) this.wires.geometry = edges(this.mesh.geometry);
    }

    setCameras(cameras: Camera[]) {
        for (const child of [...this.rig.children]) {
            this.rig.remove(child);
            child.traverse((part) => {
                (part as Mesh).geometry.dispose();
                disposeMaterial(part as Mesh);
            });
        }
        this.cameras = cameras;
        this.thumbnails = [];
        this.lookThrough(null);
        if (cameras.length === 0) return;
        const centres = cameras.map((camera) => new Vector3().setFromMatrixPosition(pose(camera)));
        const radius = new Sphere().setFromPoints(centres).radius;
        const depth = 0.13 * radius;
        for (const [i, camera] of cameras.entries()) {
            const { width, height, K } = camera;
            const corner = (u: number, v: number) =>
                new Vector3(((u - K[0][2]) / K[0][0]) * depth, ((K[1][2] - v) / K[1][1]) * depth, -depth);
            const corners = [
                corner(-0.5, -0.5),
                corner(width - 0.5, -0.5),
                corner(width - 0.5, height - 0.5),
                corner(-0.5, height - 0.5),
            ];
            const eye = new Vector3();
            const lines = corners.flatMap((c, k) => [eye, c, c, corners[(k + 1) % 4]]);
            const frustum = new LineSegments(new BufferGeometry().setFromPoints(lines), this.frustumLines);
            frustum.applyMatrix4(pose(camera));
            frustum.userData.camera = i;
            const size = corners[2].clone().sub(corners[0]);
            const middle = corners[0].clone().add(corners[2]).multiplyScalar(0.5);
            const plate = new Mesh(new PlaneGeometry(Math.abs(size.x), Math.abs(size.y)), BLANK);
            plate.position.copy(middle);
            plate.userData.camera = i;
            frustum.add(plate);
            this.thumbnails[i] = plate;
            this.rig.add(frustum);
        }
        if (!this.bounds) {
            // Nothing is there yet to look at but the cameras and what they look at.
            this.world.updateMatrixWorld(true);
            this.frame(new Box3().setFromPoints(centres).applyMatrix4(this.world.matrixWorld));
        }
        this.draw();
    }

    /** A small picture on a camera's frustum. */
    setThumbnail(camera: number, picture: HTMLCanvasElement) {
        const plate = this.thumbnails[camera];
        if (!plate) return;
        const texture = new CanvasTexture(picture);
        texture.colorSpace = SRGBColorSpace;
        disposeMaterial(plate);
        plate.material = new MeshBasicMaterial({ map: texture, side: DoubleSide });
        this.draw();
    }

    showCameras(on: boolean) {
        this.rig.visible = on;
        this.draw();
    }

    /** Stands in a camera of the rig, or outside again. */
    lookThrough(camera: number | null) {
        this.looking = camera;
        this.controls.enabled = camera === null;
        this.resize();
    }

    /** Place of a camera's picture in the window, in CSS pixels. */
    pictureRectangle(camera: number) {
        const { clientWidth, clientHeight } = this.canvas;
        const { scale, left, top } = fit(this.cameras[camera], clientWidth, clientHeight);
        return { left, top, width: scale * this.cameras[camera].width, height: scale * this.cameras[camera].height };
    }

    /** Turns about the object, radians. */
    orbit(horizontal: number, vertical: number) {
        if (this.looking !== null) return;
        const offset = this.free.position.clone().sub(this.controls.target);
        const radius = offset.length();
        const angle = Math.atan2(offset.x, offset.z) + horizontal;
        const height = Math.min(1.5, Math.max(-1.5, Math.asin(offset.y / radius) + vertical));
        offset
            .set(Math.sin(angle) * Math.cos(height), Math.sin(height), Math.cos(angle) * Math.cos(height))
            .multiplyScalar(radius);
        this.free.position.copy(this.controls.target).add(offset);
        this.controls.update();
        this.draw();
    }

    zoom(factor: number) {
        const offset = this.free.position.clone().sub(this.controls.target);
        this.free.position.copy(this.controls.target).add(offset.multiplyScalar(factor));
        this.controls.update();
        this.draw();
    }

    /** Steps back until the whole object is in the window. */
    frame(box = this.bounds) {
        if (!box) return;
        const sphere = box.getBoundingSphere(new Sphere());
        // From a little beside the first camera, which sees the front as a rule.
        const front =
            this.cameras.length > 0
                ? new Vector3(0, 0, 1)
                      .transformDirection(pose(this.cameras[0]))
                      .transformDirection(this.world.matrixWorld)
                : new Vector3(0.4, 0, 1);
        const direction = front.setY(0).normalize().applyAxisAngle(this.free.up, 0.35).setY(0.2).normalize();
        const narrow = Math.min(1, this.free.aspect);
        const distance = (sphere.radius * 1.12) / Math.sin((this.free.fov / 2) * (Math.PI / 180)) / narrow;
        this.controls.target.copy(sphere.center);
        this.free.position.copy(sphere.center).addScaledVector(direction, distance);
        [this.free.near, this.free.far] = [distance / 100, distance * 20];
        this.controls.minDistance = sphere.radius * 0.2;
        this.controls.maxDistance = distance * 6;
        this.free.updateProjectionMatrix();
        this.grid.position.set(sphere.center.x, box.min.y, sphere.center.z);
        this.grid.scale.setScalar(sphere.radius * 1.1);
        this.grid.visible = box === this.bounds;
        this.controls.update();
        this.draw();
    }

    /** What the graphics card holds for us. */
    get resources() {
        const { geometries, textures } = this.renderer.info.memory;
        return { geometries, textures };
    }

    private render() {
        const camera: AnyCamera = this.looking === null ? this.free : this.through;
        const shown = [this.grid.visible, this.rig.visible];
        if (this.looking !== null) this.grid.visible = this.rig.visible = false;
        this.renderer.render(this.scene, camera);
        [this.grid.visible, this.rig.visible] = shown;
    }

    private resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas.parentElement as HTMLElement;
        if (width === 0 || height === 0) return;
        this.renderer.setSize(width, height, false);
        this.free.aspect = width / height;
        this.free.updateProjectionMatrix();
        if (this.looking !== null) {
            const camera = this.cameras[this.looking];
            const distance = this.controls.target
                .clone()
                .applyMatrix4(this.world.matrixWorld.clone().invert())
                .distanceTo(new Vector3().setFromMatrixPosition(pose(camera)));
            this.through.matrix.copy(pose(camera));
            this.through.projectionMatrix.copy(projection(camera, width, height, distance / 50, distance * 10));
            this.through.projectionMatrixInverse.copy(this.through.projectionMatrix).invert();
        }
        this.onlayout();
        this.draw();
    }

    private listenForPicks() {
        const raycaster = new Raycaster();
        let down = new Vector2();
        this.canvas.addEventListener("pointerdown", (event) => (down = new Vector2(event.clientX, event.clientY)));
        this.canvas.addEventListener("pointerup", (event) => {
            if (
                !this.rig.visible ||
                this.looking !== null ||
                down.distanceTo(new Vector2(event.clientX, event.clientY)) > 4
            )
                return;
            const box = this.canvas.getBoundingClientRect();
            const at = new Vector2(
                ((event.clientX - box.left) / box.width) * 2 - 1,
                1 - ((event.clientY - box.top) / box.height) * 2,
            );
            raycaster.setFromCamera(at, this.free);
            const plates = this.thumbnails.filter((plate) => plate !== undefined);
            const [hit] = raycaster.intersectObjects(plates, false);
            if (hit) this.onpick(hit.object.userData.camera as number);
        });
    }
}

function tagColours(tags: Uint16Array, ranks: boolean): Uint8Array {
    const colours = new Uint8Array(tags.length * 3);
    const table = new Map<number, number[]>();
    for (let i = 0; i < tags.length; i++) {
        const tag = tags[i];
        let colour = table.get(tag);
        if (!colour) {
            colour = (ranks ? RANK_COLOURS[tag] : viewColour(tag)).toArray().map((v) => Math.round(v * 255));
            table.set(tag, colour);
        }
        colours.set(colour, i * 3);
    }
    return colours;
}

/** Frees a plate's picture; the blank one is everybody's, as are the lines. */
function disposeMaterial(plate: Mesh) {
    const material = plate.material as MeshBasicMaterial;
    if (!material.map) return;
    material.map.dispose();
    material.dispose();
}

const EDGES = new WeakMap<BufferGeometry, BufferGeometry>();

/** A mesh's edges as lines, which go when the mesh does. three.js' own wireframe collects them in a growing list. */
function edges(mesh: BufferGeometry): BufferGeometry {
    let lines = EDGES.get(mesh);
    if (lines) return lines;
    const { position, normal, color } = mesh.attributes;
    const corners = mesh.index?.array ?? Uint32Array.from({ length: position.count }, (_, i) => i);
    const index = new Uint32Array(2 * corners.length);
    for (let i = 0, at = 0; i < corners.length; i += 3) {
        for (let k = 0; k < 3; k++) {
            index[at++] = corners[i + k];
            index[at++] = corners[i + ((k + 1) % 3)];
        }
    }
    lines = new BufferGeometry().setIndex(new BufferAttribute(index, 1));
    for (const [name, attribute] of Object.entries({ position, normal, color }))
        if (attribute) lines.setAttribute(name, attribute);
    [lines.boundingBox, lines.boundingSphere] = [mesh.boundingBox, mesh.boundingSphere];
    const made = lines;
    mesh.addEventListener("dispose", () => made.dispose());
    EDGES.set(mesh, made);
    return made;
}
