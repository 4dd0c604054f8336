// A mesh's edges as lines.
import { BufferAttribute, BufferGeometry } from "three";

const EDGES = new WeakMap<BufferGeometry, BufferGeometry>();

/**
 * Lines along all triangle edges of a mesh. They are disposed of together with the mesh.
 *
 * three.js' own wireframe mode keeps its line geometries in a list that only grows.
 */
export function edges(mesh: BufferGeometry): BufferGeometry {
    const known = EDGES.get(mesh);
    if (known) return known;
    const { position, normal, color } = mesh.attributes;
    const corners = mesh.index?.array ?? Uint32Array.from({ length: position.count }, (_, i) => i);
    const index = new Uint32Array(2 * corners.length);
    for (let i = 0, at = 0; i < corners.length; i += 3) {
        for (let k = 0; k < 3; k++) {
            index[at++] = corners[i + k];
            index[at++] = corners[i + ((k + 1) % 3)];
        }
    }
    const lines = new BufferGeometry().setIndex(new BufferAttribute(index, 1));
    for (const [name, attribute] of Object.entries({ position, normal, color })) {
        if (attribute) lines.setAttribute(name, attribute);
    }
    [lines.boundingBox, lines.boundingSphere] = [mesh.boundingBox, mesh.boundingSphere];
    mesh.addEventListener("dispose", () => lines.dispose());
    EDGES.set(mesh, lines);
    return lines;
}
