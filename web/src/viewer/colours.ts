// Materials and colours of what the view shows.
import {
    Color,
    DoubleSide,
    LineBasicMaterial,
    type Material,
    MeshBasicMaterial,
    MeshNormalMaterial,
    MeshStandardMaterial,
    PointsMaterial,
    SRGBColorSpace,
    Texture,
} from "three";

export const SHADINGS = ["colour", "clay", "normals"] as const;
/** How the surface is shaded. */
export type Shading = (typeof SHADINGS)[number];

export const SURFACE_MATERIALS: Record<Shading, Material> = {
    colour: new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }),
    clay: new MeshStandardMaterial({ color: 0xcfc8bd, roughness: 0.85, side: DoubleSide }),
    normals: new MeshNormalMaterial({ side: DoubleSide }),
};
/** For surfaces that have a texture instead of the colours of their vertices. */
export const textured = () => new MeshBasicMaterial({ map: new Texture(), side: DoubleSide });
export const POINTS = new PointsMaterial({ vertexColors: true, sizeAttenuation: false });
export const FRUSTUM_LINES = new LineBasicMaterial({ color: 0x3ddc97, transparent: true, opacity: 0.75 });
/** Of a camera with a warning. Transparent, because an opaque material needs another shader than that of other cameras. */
export const MARKED_LINES = new LineBasicMaterial({ color: 0xffb454, transparent: true });
/** On a frustum that has no picture, or whose picture has not been read yet. */
export const BLANK = new MeshBasicMaterial({ color: 0x8892a0, transparent: true, opacity: 0.25, side: DoubleSide });

/** Tag of a point that no view detected. */
const NO_VIEW = 65535;
/** Point ranks: implicit, substituted by the hull, detected, frontier. */
const RANK_COLOURS = ["#8d93a1", "#e2a33d", "#4f9cf0", "#3ddc97"].map((c) => new Color(c));

/** Hues a golden angle apart, so that neighbouring views differ clearly. */
function viewColour(view: number): Color {
    if (view === NO_VIEW) return new Color(0.55, 0.55, 0.58);
    return new Color().setHSL((view * 0.3819) % 1, 0.72, 0.58, SRGBColorSpace);
}

/** RGB of each tag, which is a rank or the view that detected the point. */
export function tagColours(tags: Uint16Array, ranks: boolean): Uint8Array {
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
