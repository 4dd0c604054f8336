// three.js: the loader's scene under a group that turns the clip's upward direction to +y.
import { AnimationMixer, Group, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const scene = new Scene();
const world = new Group();
let renderer, camera, mixer;

/**
 * Starts the player in `stage`, a square of `view.size` pixels, with the camera on a sphere of radius `view.radius` around
 * `view.target`. `theta` turns it from +z to +x, `phi` is its angle from +y, and `fov` is vertical, all in radians.
 */
export function open(stage, view) {
    renderer = new WebGLRenderer({ antialias: true, alpha: true });
    renderer.setSize(view.size, view.size);
    stage.append(renderer.domElement);
    camera = new PerspectiveCamera((view.fov * 180) / Math.PI, 1, 0.1, 100);
    const target = new Vector3(...view.target);
    camera.position.setFromSphericalCoords(view.radius, view.phi, view.theta).add(target);
    camera.lookAt(target);
    scene.add(world);
}

/** Shows the GLB at an address instead of the previous one, and resolves when it has been drawn. `up` is the manifest's. */
export async function show(address, up) {
    const { scene: loaded, animations } = await loader.loadAsync(address);
    mixer = new AnimationMixer(loaded);
    for (const animation of animations) mixer.clipAction(animation).play();
    world.traverse((object) => object.geometry?.dispose());
    world.clear().add(loaded);
    world.quaternion.setFromUnitVectors(new Vector3(...up).normalize(), new Vector3(0, 1, 0));
    renderer.render(scene, camera);
}

/** Draws the GLB at a moment of its animation. */
export function seek(seconds) {
    mixer.setTime(seconds);
    renderer.render(scene, camera);
}
