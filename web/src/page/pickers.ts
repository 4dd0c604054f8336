// Dialogs that ask for a file or a folder to write. Not all browsers have them.

/** The parts of the File System Access API that TypeScript does not know. */
interface Pickers {
    showSaveFilePicker?: (options: object) => Promise<FileSystemFileHandle>;
    showDirectoryPicker?: (options: object) => Promise<FileSystemDirectoryHandle>;
}
const pickers = window as unknown as Pickers;

export const picksFiles = () => pickers.showSaveFilePicker !== undefined;
export const picksFolders = () => pickers.showDirectoryPicker !== undefined;

/** Asks for a file to write; null if the browser has no such dialog. Browsers allow it only right after a click. */
export async function askForFile(suggestedName: string, mime: string): Promise<FileSystemFileHandle | null> {
    const extension = `.${suggestedName.split(".").at(-1)}`;
    const types = [{ accept: { [mime]: [extension] } }];
    return (await pickers.showSaveFilePicker?.({ suggestedName, types, id: "pcmvs-export" })) ?? null;
}

export async function askForFolder(): Promise<FileSystemDirectoryHandle> {
    if (!pickers.showDirectoryPicker) throw new Error("this browser cannot write into folders: save the clip as a zip");
    return pickers.showDirectoryPicker({ mode: "readwrite", id: "pcmvs-export" });
}
