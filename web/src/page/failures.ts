// Failures of frames and of their pictures. Each kind is listed once, with the frames and cameras that have it.

import type { Camera, Scene } from "pcmvs";
import type { Failure } from "../workers/protocol";
import { describe, showError } from "./messages";

/** Frames and cameras that are named at most, each. */
const NAMED = 8;

interface Group {
    box: HTMLElement;
    first: string;
    message: string;
    frames: Set<number>;
    cameras: Set<string>;
}

const groups = new Map<string, Group>();

/** Reports a failure, or adds it to those of its kind, whose messages differ in numbers at most. */
export function showFailure(failure: Failure, cameras: Camera[], { frames }: Scene, position: number) {
    const frame = frames[position];
    const key = failure.message.replaceAll(/\d+/g, "0");
    const known = groups.get(key);
    const group =
        known?.box.isConnected === true ? known : start(failure, cameras, frames.length > 1 ? frame : undefined, key);
    group.frames.add(frame.index);
    if (failure.camera !== undefined) group.cameras.add(cameras[failure.camera]?.name ?? String(failure.camera));
    (group.box.querySelector("p") as HTMLElement).textContent = textOf(group);
}

function start(failure: Failure, cameras: Camera[], frame: Scene["frames"][number] | undefined, key: string): Group {
    const first = describe(failure, cameras, frame);
    const group = { box: showError(first), first, message: failure.message, frames: new Set(), cameras: new Set() };
    groups.set(key, group as Group);
    return group as Group;
}

function textOf({ first, message, frames, cameras }: Group): string {
    if (frames.size < 2 && cameras.size < 2) return first;
    const counted = [];
    if (frames.size > 1) counted.push(`${frames.size} frames (${some([...frames].sort((a, b) => a - b))})`);
    if (cameras.size > 0) counted.push(`${cameras.size === 1 ? "camera" : "cameras"} ${some([...cameras].sort())}`);
    // The library's messages end with a remedy for one picture.
    const remedy = cameras.size > 0 && frames.size > 1 ? ". Pictures that are removed are left out" : "";
    return `${[...counted, message].join(": ")}${remedy}`;
}

function some(all: (string | number)[]): string {
    const more = all.length - NAMED;
    return more > 0 ? `${all.slice(0, NAMED).join(", ")} and ${more} more` : all.join(", ");
}
