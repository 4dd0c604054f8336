// GLBs as other programs compress them with Draco.
import { NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS, KHRDracoMeshCompression } from "@gltf-transform/extensions";
import draco3d from "draco3d";

const io = new NodeIO()
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({ "draco3d.encoder": await draco3d.createEncoderModule() });

/** The same GLB with its mesh compressed. */
export async function withDraco(glb) {
    const document = await io.readBinary(new Uint8Array(glb));
    document.createExtension(KHRDracoMeshCompression).setRequired(true);
    return io.writeBinary(document);
}
