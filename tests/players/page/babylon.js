// Babylon.js: the loader's meshes under a node that turns the clip's upward direction to +y, in a right-handed scene.
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Quaternion, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { MeshoptCompression } from "@babylonjs/core/Meshes/Compression/meshoptCompression.js";
import { TransformNode } from "@babylonjs/core/Meshes/transformNode.js";
import { Scene } from "@babylonjs/core/scene.js";
import "@babylonjs/loaders/glTF/2.0/glTFLoader.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/EXT_meshopt_compression.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_animation_pointer.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_materials_unlit.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_mesh_quantization.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_node_visibility.js";

// Otherwise the decoder comes from Babylon's own host.
MeshoptCompression.Configuration = { decoder: { url: "/node_modules/meshoptimizer/meshopt_decoder.cjs" } };

/** Frames per second in which the loader counts time. */
const LOADER_FPS = 60;

let scene, world, shown;

export function open(stage, view) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = view.size;
    stage.append(canvas);
    // Otherwise linear light becomes sRGB by a power of 1/2.2, which makes dark colours too bright.
    scene = new Scene(new Engine(canvas, true, { alpha: true, useExactSrgbConversions: true }));
    scene.useRightHandedSystem = true;
    scene.clearColor = new Color4(0, 0, 0, 0);
    const { theta, phi, radius } = view;
    const offset = new Vector3(Math.sin(phi) * Math.sin(theta), Math.cos(phi), Math.sin(phi) * Math.cos(theta));
    const target = Vector3.FromArray(view.target);
    const camera = new FreeCamera("camera", target.add(offset.scale(radius)), scene);
    camera.setTarget(target);
    camera.fov = view.fov;
    camera.minZ = 0.1;
    world = new TransformNode("world", scene);
}

export async function show(address, up) {
    const loaded = await LoadAssetContainerAsync(address, scene);
    shown?.dispose();
    shown = loaded;
    world.rotationQuaternion = Quaternion.FromUnitVectorsToRef(
        Vector3.FromArray(up).normalize(),
        Vector3.Up(),
        new Quaternion(),
    );
    for (const root of loaded.rootNodes) root.parent = world;
    loaded.addAllToScene();
    await scene.whenReadyAsync();
    scene.render();
}

export function seek(seconds) {
    for (const group of shown.animationGroups) {
        group.play(true);
        group.pause();
        group.goToFrame(seconds * LOADER_FPS);
    }
    scene.render();
}
