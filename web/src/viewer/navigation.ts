// The free camera: dragging, keys, and standing back until the whole object is in the window.
import { type Box3, Matrix4, PerspectiveCamera, Sphere, type Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

export class Navigation {
    readonly camera = new PerspectiveCamera(35, 1, 0.01, 100);
    private readonly controls: OrbitControls;
    /** Whether a person has turned the view or zoomed since the object was framed. */
    moved = false;

    constructor(
        canvas: HTMLCanvasElement,
        private readonly onChange: () => void,
    ) {
        this.camera.position.set(2.2, 0.9, 2.6);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.enableDamping = true;
        this.controls.dampingFactor = 0.12;
        this.controls.addEventListener("change", onChange);
        this.controls.addEventListener("start", () => {
            this.moved = true;
        });
    }

    set enabled(on: boolean) {
        this.controls.enabled = on;
    }

    /** Lets go of the canvas. */
    dispose() {
        this.controls.dispose();
    }

    /** The point that the camera turns around. */
    get target(): Vector3 {
        return this.controls.target;
    }

    /** Continues damping. Called before every drawing; a change asks for the next one. */
    update() {
        this.controls.update();
    }

    setAspect(aspect: number) {
        this.camera.aspect = aspect;
        this.camera.updateProjectionMatrix();
    }

    /** Turns around the target, radians. */
    orbit(horizontal: number, vertical: number) {
        if (!this.controls.enabled) return;
        const offset = this.camera.position.clone().sub(this.target);
        const radius = offset.length();
        const angle = Math.atan2(offset.x, offset.z) + horizontal;
        const height = Math.min(1.5, Math.max(-1.5, Math.asin(offset.y / radius) + vertical));
        offset
            .set(Math.sin(angle) * Math.cos(height), Math.sin(height), Math.cos(angle) * Math.cos(height))
            .multiplyScalar(radius);
        this.move(offset);
    }

    /** Multiplies the distance from the target. */
    zoom(factor: number) {
        this.move(this.camera.position.clone().sub(this.target).multiplyScalar(factor));
    }

    /** Looks at another point from elsewhere. */
    place(position: Vector3, target: Vector3) {
        this.target.copy(target);
        this.move(position.clone().sub(target));
    }

    /** Projections of pictures whose narrower side shows what the window's narrower side shows now. */
    lens(): (aspect: number) => Matrix4 {
        const { fov, aspect, near, far } = this.camera;
        const narrow = near * Math.tan((fov / 2) * (Math.PI / 180)) * Math.min(1, aspect);
        return (aspect) => {
            const top = narrow / Math.min(1, aspect);
            return new Matrix4().makePerspective(-top * aspect, top * aspect, top, -top, near, far);
        };
    }

    private move(offset: Vector3) {
        this.moved = true;
        this.camera.position.copy(this.target).add(offset);
        this.controls.update();
        this.onChange();
    }

    /** Looks at a box from its front, from so far away that it is in the window as a whole. */
    frame(box: Box3, front: Vector3): Sphere {
        const sphere = box.getBoundingSphere(new Sphere());
        const direction = front.setY(0).normalize().applyAxisAngle(this.camera.up, 0.35).setY(0.2).normalize();
        const narrow = Math.min(1, this.camera.aspect);
        const distance = (sphere.radius * 1.12) / Math.sin((this.camera.fov / 2) * (Math.PI / 180)) / narrow;
        this.moved = false;
        this.target.copy(sphere.center);
        this.camera.position.copy(sphere.center).addScaledVector(direction, distance);
        [this.camera.near, this.camera.far] = [distance / 100, distance * 20];
        this.controls.minDistance = sphere.radius * 0.2;
        this.controls.maxDistance = distance * 6;
        this.camera.updateProjectionMatrix();
        this.controls.update();
        this.onChange();
        return sphere;
    }
}
