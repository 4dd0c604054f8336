// The difference between the mesh and a photograph, as a picture in the place of the mesh.
import {
    type Camera,
    DataTexture,
    HalfFloatType,
    LinearFilter,
    Mesh,
    NoBlending,
    OrthographicCamera,
    PlaneGeometry,
    RGBAFormat,
    Scene,
    ShaderMaterial,
    Texture,
    Vector2,
    Vector4,
    type WebGLRenderer,
    WebGLRenderTarget,
} from "three";

/** A camera's picture without lens distortion, and its silhouette in the alpha channel, if it has one. */
export interface Pictures {
    picture: ImageBitmap;
    silhouette: ImageBitmap | null;
}

/** What is outside of the mesh and of the silhouette, sRGB. */
const NEUTRAL = "vec3(0.38)";
/** Where the silhouette has something and the mesh has nothing, and the opposite. */
const MISSING = "vec3(1.0, 0.62, 0.2)";
const EXCESS = "vec3(0.3, 0.56, 1.0)";

const VERTEX = "void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }";
const FRAGMENT = `
uniform sampler2D drawn, picture, silhouette;
uniform vec2 size;
uniform vec4 rectangle;
uniform float gain;
uniform bool known;
vec3 srgb(vec3 light) {
    return mix(12.92 * light, 1.055 * pow(max(light, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}
void main() {
    vec2 at = gl_FragCoord.xy;
    vec4 mesh = texture2D(drawn, at / size);
    vec2 place = (vec2(at.x, size.y - at.y) - rectangle.xy) / rectangle.zw;
    if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(1.0)))) discard;
    bool made = mesh.a > 0.5;
    bool seen = known ? texture2D(silhouette, place).a > 0.5 : made;
    vec3 colour = ${NEUTRAL};
    if (made && seen) colour = gain * abs(srgb(mesh.rgb / mesh.a) - texture2D(picture, place).rgb);
    else if (made) colour = ${EXCESS};
    else if (seen) colour = ${MISSING};
    gl_FragColor = vec4(min(colour, 1.0), 1.0);
}`;

export class Difference {
    private readonly target = new WebGLRenderTarget(1, 1, { type: HalfFloatType });
    private readonly material = new ShaderMaterial({
        uniforms: {
            drawn: { value: this.target.texture },
            picture: { value: null },
            silhouette: { value: null },
            size: { value: new Vector2() },
            rectangle: { value: new Vector4() },
            gain: { value: 4 },
            known: { value: false },
        },
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        depthTest: false,
        depthWrite: false,
        blending: NoBlending,
    });
    private readonly quad = new Scene();
    private readonly camera = new OrthographicCamera();
    private shown = false;

    constructor() {
        const plane = new Mesh(new PlaneGeometry(2, 2), this.material);
        plane.frustumCulled = false;
        this.quad.add(plane);
    }

    /** The factor by which differences are amplified. */
    set gain(factor: number) {
        this.material.uniforms.gain.value = factor;
    }

    /** Compares with these pictures, or with none. The caller keeps them until others are set. */
    set(pictures: Pictures | null) {
        const { picture, silhouette, known } = this.material.uniforms;
        for (const { value } of [picture, silhouette]) (value as Texture | null)?.dispose();
        picture.value = pictures && textureOf(pictures.picture);
        // Without a silhouette something must be bound all the same.
        silhouette.value = pictures?.silhouette ? textureOf(pictures.silhouette) : blank();
        known.value = pictures?.silhouette != null;
        this.shown = pictures !== null;
    }

    /** Whether there is a picture to compare with. */
    get ready(): boolean {
        return this.shown;
    }

    /** Frees the memory for drawing, which is as large as the window. Drawing takes it again. */
    rest() {
        this.target.dispose();
    }

    /** Draws the difference. `draw` draws the mesh. `rectangle` is the picture's place in the window, in CSS pixels. */
    render(
        renderer: WebGLRenderer,
        camera: Camera,
        scene: Scene,
        rectangle: { left: number; top: number; width: number; height: number },
    ) {
        const ratio = renderer.getPixelRatio();
        const size = renderer.getDrawingBufferSize(this.material.uniforms.size.value);
        this.target.setSize(size.x, size.y);
        const { left, top, width, height } = rectangle;
        this.material.uniforms.rectangle.value.set(left, top, width, height).multiplyScalar(ratio);
        renderer.setRenderTarget(this.target);
        renderer.render(scene, camera);
        renderer.setRenderTarget(null);
        renderer.render(this.quad, this.camera);
    }
}

function textureOf(picture: ImageBitmap): Texture {
    const texture = new Texture(picture);
    // The shader counts rows from the top, and compares the codes of sRGB.
    texture.flipY = false;
    texture.generateMipmaps = false;
    texture.minFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

function blank(): Texture {
    const texture = new DataTexture(new Uint8Array(4), 1, 1, RGBAFormat);
    texture.needsUpdate = true;
    return texture;
}
