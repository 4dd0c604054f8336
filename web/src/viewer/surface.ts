// The reconstructed surface, or a stage's output in its place.
import {
    Box3,
    BufferAttribute,
    BufferGeometry,
    Group,
    LineSegments,
    type Material,
    Mesh,
    type MeshBasicMaterial,
    Points,
} from "three";
import { offsetOf } from "../clip/glb";
import type { StageCloud, StageMesh } from "../workers/protocol";
import { POINTS, type Shading, SURFACE_MATERIALS, tagColours, textured } from "./colours";
import { edges } from "./edges";

export class Surface {
    readonly root = new Group();
    private readonly mesh = new Mesh<BufferGeometry, Material>(new BufferGeometry(), SURFACE_MATERIALS.colour);
    /** The mesh's edges, shown instead of it as a wireframe. */
    private readonly wires = new LineSegments<BufferGeometry, Material>(new BufferGeometry(), SURFACE_MATERIALS.colour);
    /** Each surface has its own, because its texture is that of the frame that is shown. */
    private readonly textured: MeshBasicMaterial = textured();
    private shading: Shading = "colour";
    private wireframe = false;
    private stage: Mesh | Points | null = null;

    constructor() {
        this.root.add(this.mesh, this.wires);
        this.choose();
    }

    /** Shows a mesh. The caller keeps the geometry and disposes of it. */
    show(geometry: BufferGeometry) {
        this.mesh.geometry = geometry;
        this.mesh.position.fromArray(offsetOf(geometry));
        this.wires.position.copy(this.mesh.position);
        this.setShading(this.shading);
        this.choose();
    }

    /** The box around the mesh as it stands in the view; null without a mesh. Its vertices decide, and not a turned box. */
    bounds(): Box3 | null {
        if (!this.mesh.geometry.hasAttribute("position")) return null;
        this.mesh.updateWorldMatrix(true, false);
        return new Box3().setFromObject(this.mesh, true);
    }

    clear() {
        this.mesh.geometry = new BufferGeometry();
        this.showStage(null);
    }

    /** Shows a stage's output instead of the mesh, or with null the mesh again. */
    showStage(output: StageCloud | StageMesh | null, origin: number[] = [0, 0, 0], ranks = false) {
        if (this.stage) {
            this.root.remove(this.stage);
            this.stage.geometry.dispose();
        }
        this.stage = null;
        if (output) {
            const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(output.positions, 3));
            if (output.kind === "mesh") {
                geometry.setAttribute("normal", new BufferAttribute(output.normals, 3));
                geometry.setIndex(new BufferAttribute(output.triangles, 1));
                this.stage = new Mesh(geometry, SURFACE_MATERIALS.clay);
            } else {
                geometry.setAttribute("color", new BufferAttribute(tagColours(output.tags, ranks), 3, true));
                this.stage = new Points(geometry, POINTS);
            }
            // Without culling no bounding sphere needs to be computed.
            this.stage.frustumCulled = false;
            this.stage.position.fromArray(origin);
            this.root.add(this.stage);
        }
        this.choose();
    }

    setShading(shading: Shading) {
        this.shading = shading;
        const texture = this.mesh.geometry.userData.texture;
        this.mesh.material = SURFACE_MATERIALS[shading];
        if (texture && shading === "colour") {
            this.textured.map = texture;
            this.mesh.material = this.textured;
        }
        this.wires.material = texture ? SURFACE_MATERIALS.clay : SURFACE_MATERIALS[shading];
    }

    /** Draws the mesh itself in its colours, whatever else is shown. */
    inColours(draw: () => void) {
        const { shading, wireframe, stage } = this;
        this.wireframe = false;
        this.stage = null;
        if (stage) stage.visible = false;
        this.setShading("colour");
        this.choose();
        draw();
        [this.wireframe, this.stage] = [wireframe, stage];
        if (stage) stage.visible = true;
        this.setShading(shading);
        this.choose();
    }

    /** Another surface that shows the same geometries. Whichever disposes of one, the other fills the graphics card again. */
    copy(): Surface {
        const copy = new Surface();
        copy.wireframe = this.wireframe;
        copy.shading = this.shading;
        if (this.mesh.geometry.hasAttribute("position")) copy.show(this.mesh.geometry);
        if (this.stage) {
            copy.stage = this.stage.clone();
            copy.root.add(copy.stage);
        }
        copy.choose();
        return copy;
    }

    /** Frees what is its own. */
    dispose() {
        this.clear();
        this.textured.dispose();
    }

    setWireframe(on: boolean) {
        this.wireframe = on;
        this.choose();
    }

    /** Makes the mesh visible, its edges, or neither of them. */
    private choose() {
        const shown = this.stage === null && this.mesh.geometry.hasAttribute("position");
        this.mesh.visible = shown && !this.wireframe;
        this.wires.visible = shown && this.wireframe;
        if (this.wires.visible) this.wires.geometry = edges(this.mesh.geometry);
    }
}
