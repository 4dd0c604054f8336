// The view and the strip of cameras, of which there is one each.

import { sidePool } from "../early";
import { Strip } from "../viewer/strip";
import { Viewer } from "../viewer/viewer";
import { $ } from "./dom";

export const viewer = new Viewer($<HTMLCanvasElement>("canvas"));
// The viewer compiles its shaders next, in a task of its own.
await new Promise((resolve) => setTimeout(resolve));
export const strip = new Strip($("strip"), $<HTMLCanvasElement>("photo"), sidePool, viewer);
