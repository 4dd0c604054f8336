// The rig's cameras as frusta, each with its picture on the image plane.
import type { Camera } from "pcmvs";
import {
    BufferGeometry,
    CanvasTexture,
    DoubleSide,
    Group,
    LineSegments,
    Mesh,
    MeshBasicMaterial,
    PlaneGeometry,
    type Raycaster,
    Sphere,
    SRGBColorSpace,
    Vector3,
} from "three";
import { cameraToWorld } from "./cameras";
import { BLANK, FRUSTUM_LINES, MARKED_LINES } from "./colours";

/** Depth of a frustum as a share of the rig's radius. */
const DEPTH = 0.13;

export class Frusta {
    readonly root = new Group();
    private plates: Mesh[] = [];

    /** Shows these cameras instead of the previous ones. */
    set(cameras: Camera[], centres: Vector3[]) {
        for (const child of [...this.root.children]) {
            this.root.remove(child);
            child.traverse((part) => {
                (part as Mesh).geometry.dispose();
                disposePicture(part as Mesh);
            });
        }
        const depth = DEPTH * new Sphere().setFromPoints(centres).radius;
        this.plates = cameras.map((camera, i) => this.add(camera, i, depth));
    }

    private add(camera: Camera, index: number, depth: number): Mesh {
        const { width, height, K } = camera;
        const corner = (u: number, v: number) =>
            new Vector3(((u - K[0][2]) / K[0][0]) * depth, ((K[1][2] - v) / K[1][1]) * depth, -depth);
        const corners = [
            corner(-0.5, -0.5),
            corner(width - 0.5, -0.5),
            corner(width - 0.5, height - 0.5),
            corner(-0.5, height - 0.5),
        ];
        const centre = new Vector3();
        const lines = corners.flatMap((c, k) => [centre, c, c, corners[(k + 1) % 4]]);
        const frustum = new LineSegments(new BufferGeometry().setFromPoints(lines), FRUSTUM_LINES);
        frustum.applyMatrix4(cameraToWorld(camera));
        const size = corners[2].clone().sub(corners[0]);
        const plate = new Mesh(new PlaneGeometry(Math.abs(size.x), Math.abs(size.y)), BLANK);
        plate.position.copy(corners[0]).add(corners[2]).multiplyScalar(0.5);
        plate.userData.camera = index;
        frustum.add(plate);
        this.root.add(frustum);
        return plate;
    }

    /** Draws the frusta of some cameras in a colour of their own. */
    mark(marked: Set<number>) {
        for (const [i, frustum] of this.root.children.entries()) {
            (frustum as LineSegments).material = marked.has(i) ? MARKED_LINES : FRUSTUM_LINES;
        }
    }

    /** Puts a small picture on a camera's frustum, or with null none. */
    setPicture(camera: number, picture: HTMLCanvasElement | null) {
        const plate = this.plates[camera];
        if (!plate) return;
        disposePicture(plate);
        if (!picture) {
            plate.material = BLANK;
            return;
        }
        const texture = new CanvasTexture(picture);
        texture.colorSpace = SRGBColorSpace;
        plate.material = new MeshBasicMaterial({ map: texture, side: DoubleSide });
    }

    /** The camera whose picture a ray meets first. */
    hit(ray: Raycaster): number | null {
        const [first] = ray.intersectObjects(this.plates, false);
        return first ? (first.object.userData.camera as number) : null;
    }
}

/** Frees a plate's own picture; the blank material and the lines' material are shared. */
function disposePicture(plate: Mesh) {
    const material = plate.material as MeshBasicMaterial;
    if (!material.map) return;
    material.map.dispose();
    material.dispose();
}
