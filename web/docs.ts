// The documentation as pages of the site, so that they belong to its version and can be read without a network.

import { readFileSync } from "node:fs";
import { basename, posix } from "node:path";
import { fileURLToPath } from "node:url";
import { Marked, type Tokens } from "marked";
import type { Plugin } from "vite";

/** The documents by their path in the repository, and their names in the site's folder `docs`. */
const PAGES: Record<string, string> = {
    "README.md": "readme.html",
    "docs/scene.md": "scene.html",
    "docs/players.md": "players.html",
    "docs/farm.md": "farm.html",
    "docs/c.md": "c.html",
    "wasm/npm/README.md": "npm.html",
    "BENCHMARKS.md": "benchmarks.html",
    "CHANGELOG.md": "changelog.html",
};
/** Documents run no code. */
const POLICY = "default-src 'none'; style-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'";

const read = (path: string) => readFileSync(fileURLToPath(new URL(`../${path}`, import.meta.url)));

/** The documents and the pictures that are in them. `source` is the address of the repository, if it is published. */
export function docs(source: string | null): Plugin {
    return {
        name: "documentation",
        apply: "build",
        generateBundle() {
            const pictures = new Set<string>();
            for (const [path, name] of Object.entries(PAGES)) {
                this.emitFile({ type: "asset", fileName: `docs/${name}`, source: page(path, source, pictures) });
            }
            for (const path of pictures) {
                this.emitFile({ type: "asset", fileName: `docs/${basename(path)}`, source: read(path) });
            }
            const style = readFileSync(fileURLToPath(new URL("src/docs.css", import.meta.url)));
            this.emitFile({ type: "asset", fileName: "docs/docs.css", source: style });
        },
    };
}

/** A document as a page. Adds the pictures that it shows to `pictures`. */
function page(path: string, source: string | null, pictures: Set<string>): string {
    const text = read(path).toString("utf8");
    const inRepository = (target: string) => posix.join(posix.dirname(path), target);
    /** Where a link leads on the site; null if to nowhere. */
    const address = (href: string): string | null => {
        if (/^(https?:|#)/.test(href)) return href;
        const [target, part] = href.split("#");
        const name = PAGES[inRepository(target)];
        if (name) return part ? `${name}#${part}` : name;
        return source && `${source}/blob/HEAD/${inRepository(target)}`;
    };
    const marked = new Marked({
        renderer: {
            heading({ tokens, depth, text }: Tokens.Heading) {
                const content = this.parser.parseInline(tokens);
                return `<h${depth} id="${slug(text)}">${content}</h${depth}>\n`;
            },
            link({ href, tokens }: Tokens.Link) {
                const content = this.parser.parseInline(tokens);
                const to = address(href);
                return to === null ? content : `<a href="${markup(to)}">${content}</a>`;
            },
            image({ href, text }: Tokens.Image) {
                pictures.add(inRepository(href));
                return `<img src="${basename(href)}" alt="${markup(text)}">`;
            },
            table(token: Tokens.Table) {
                const row = (cells: Tokens.TableCell[], tag: string) =>
                    `<tr>${cells.map((cell) => `<${tag}>${this.parser.parseInline(cell.tokens)}</${tag}>`).join("")}</tr>`;
                const body = token.rows.map((cells) => row(cells, "td")).join("");
                // A wide table scrolls by itself, also by keys.
                return `<div class="table" tabindex="0"><table><thead>${row(token.header, "th")}</thead><tbody>${body}</tbody></table></div>`;
            },
        },
    });
    const title = /^# (.*)$/m.exec(text)?.[1] ?? path;
    return `<!doctype html>
<html lang="en">
<head>
<meta http-equiv="Content-Security-Policy" content="${POLICY}">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark light">
<title>${markup(title.replaceAll("`", ""))}${path === "README.md" ? "" : " · pcmvs"}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="docs.css">
</head>
<body>
<nav aria-label="Documents"><a href="../index.html">The page</a> <a href="readme.html">Manual</a> <a href="scene.html">scene.json</a> <a href="players.html">Players</a></nav>
<main>
${marked.parse(text)}</main>
</body>
</html>
`;
}

/** The name of a heading in links, as hosts of repositories make it. */
const slug = (text: string) =>
    text
        .toLowerCase()
        .replaceAll(/[^\p{L}\p{N} _-]/gu, "")
        .replaceAll(" ", "-");

const markup = (text: string) =>
    text.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
