// Compiles shaders in the background, because the first use of one that is not ready blocks the page's own thread.

import {
    BufferAttribute,
    BufferGeometry,
    type Camera,
    Group,
    LineSegments,
    Mesh,
    PlaneGeometry,
    Points,
    type PolarGridHelper,
    type Scene,
    type WebGLRenderer,
} from "three";
import { BLANK, FRUSTUM_LINES, POINTS, SURFACE_MATERIALS, textured } from "./colours";

/** Resolves when all shaders that the view may need are ready. */
export async function compile(renderer: WebGLRenderer, scene: Scene, camera: Camera, grid: PolarGridHelper) {
    // In a task of its own, because the one that makes the view is long enough.
    await new Promise((resolve) => setTimeout(resolve));
    const floats = () => new BufferAttribute(new Float32Array(9), 3);
    const geometry = new BufferGeometry()
        .setAttribute("position", floats())
        .setAttribute("normal", floats())
        .setAttribute("color", floats());
    const all = new Group();
    for (const material of Object.values(SURFACE_MATERIALS)) all.add(new Mesh(geometry, material));
    const plate = new PlaneGeometry();
    all.add(
        new Points(geometry, POINTS),
        new LineSegments(plate, FRUSTUM_LINES),
        new Mesh(plate, BLANK),
        new Mesh(plate, textured()),
        new LineSegments(grid.geometry, grid.material),
    );
    // Without this extension three.js cannot ask for readiness, and compileAsync only warns.
    if (renderer.extensions.has("KHR_parallel_shader_compile")) await renderer.compileAsync(all, camera, scene);
    else renderer.compile(all, camera, scene);
}
